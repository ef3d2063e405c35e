"""The fits of Loew et al. 2012 (`npfm.fitting.parametric.abc`) that they published: metric E2."""

import numpy as np

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric.abc import FORM
from npfm.fitting.parametric.lobes import Model
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.table import Table

NAME = "abc-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("b", "c", "eta")
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "kind": "fits",
    "name": "low_lowmicrofacet_E2.fit",
    "holds": {
        "model": "LowMicrofacetFit",
        "shapes": {"A": (3,), "B": (), "C": (), "eta": ()},
    },
}

MODEL = Model(NAME, FORM)
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count


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
    return MODEL.published(table, objective, parameters)
