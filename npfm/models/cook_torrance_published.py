"""The fits of Ngan et al. 2005 (`npfm.models.cook_torrance`) that they published.

They are of MERL's stored values without the scaling of its channels: against the tables, the
published parameters alone are low by a median of 0.03, 0.19 and 0.56 in red, green and blue (as
logarithms), so by log 1.15 and log 1.66 more in green and blue than in red. Here the scaling
is applied.
"""

import numpy as np

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import lobes
from npfm.fitting.solvers.problem import Solver
from npfm.models.cook_torrance import FORM
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.merl import CHANNEL_SCALE
from npfm.reflectance.table import Table

NAME = "cook-torrance-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness", "f0")
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "name": "ngan_cooktorrance.fit",
    "model": "NganCookTorrance",
    "shapes": {"albedo": (3,), "eta": (), "roughness": ()},
}
#: MERL's scaling of the channels, relative to red.
CHANNEL_WEIGHT = CHANNEL_SCALE / CHANNEL_SCALE[0]


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
        "rho_d": published[DIFFUSE] * CHANNEL_WEIGHT / np.pi,
        "rho_s": published["albedo"] * CHANNEL_WEIGHT / np.pi,
        "roughness": published["roughness"],
        "f0": published["eta"],
    }
    arrays = {name: np.atleast_1d(value).astype(np.float32) for name, value in parameters.items()}
    return lobes.published(FORM, table, objective, Fit(NAME, arrays, table.grid))


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
