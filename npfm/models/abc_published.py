"""The fits of Loew et al. 2012 (`npfm.fitting.parametric.abc`) that they published: metric E2."""

import numpy as np

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import lobes
from npfm.fitting.parametric.abc import FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "abc-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("b", "c", "eta")
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "name": "low_lowmicrofacet_E2.fit",
    "model": "LowMicrofacetFit",
    "shapes": {"A": (3,), "B": (), "C": (), "eta": ()},
}


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; the table is for the record alone.

    Raises
    ------
    NpfmError
        If a channel of the table has no sample that counts.
    """
    parameters = {
        "rho_d": published[DIFFUSE] / np.pi,
        "rho_s": published["A"] / np.pi,
        "b": published["B"],
        "c": published["C"],
        "eta": published["eta"],
    }
    arrays = {name: np.atleast_1d(value).astype(np.float32) for name, value in parameters.items()}
    return lobes.published(FORM, table, objective, Fit(NAME, arrays, table.grid))


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
