"""Fits of Lafortune et al. 1997 by Ngan et al. 2005, who published them."""

import numpy as np

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import ngan
from npfm.fitting.parametric.lafortune import FORM
from npfm.fitting.parametric.lobes import Model
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.table import Table

NAME = "lafortune-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("n", "C_xy", "C_z")
SIGNED = ("C_xy",)
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "kind": "fits",
    "name": "ngan_lafortune.fit",
    "holds": {
        "model": "NganLafortune",
        "shapes": {"albedo": (3,), "Cxy": (), "Cz": (), "sharpness": ()},
    },
}

MODEL = Model(NAME, FORM)
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; see `ngan.published`.

    Their lobe is (n + 2) / (2 pi) times that of `npfm.fitting.parametric.lafortune`, whose
    coefficients are shares of the largest.
    """
    C_xy, C_z, n = (published[name] for name in ("Cxy", "Cz", "sharpness"))
    largest = np.maximum(np.abs(C_xy), np.abs(C_z))
    albedos = published[DIFFUSE], published["albedo"] * (n + 2) / (2 * np.pi)
    shape = {"n": n, "C_xy": C_xy / largest, "C_z": C_z / largest}
    return ngan.published(MODEL, table, objective, albedos, shape)
