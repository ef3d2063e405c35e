"""The fits of Ngan et al. 2005 (`npfm.models.cook_torrance`) that they published."""

import numpy as np

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import ngan
from npfm.fitting.parametric.lobes import Model
from npfm.fitting.solvers.problem import Solver
from npfm.models.cook_torrance import FORM
from npfm.reflectance.table import Table

NAME = "cook-torrance-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness", "f0")
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "kind": "fits",
    "name": "ngan_cooktorrance.fit",
    "holds": {
        "model": "NganCookTorrance",
        "shapes": {"albedo": (3,), "eta": (), "roughness": ()},
    },
}

MODEL = Model(NAME, FORM)
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; see `ngan.published`."""
    albedos = published[DIFFUSE], published["albedo"] / np.pi
    shape = {"roughness": published["roughness"], "f0": published["eta"]}
    return ngan.published(MODEL, table, objective, albedos, shape)
