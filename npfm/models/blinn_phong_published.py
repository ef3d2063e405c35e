"""The fits of Blinn 1977 that Ngan et al. 2005 published (`npfm.fitting.parametric.ngan`)."""

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import ngan
from npfm.fitting.parametric.lobes import Model
from npfm.fitting.parametric.ngan import BLINN_PHONG as FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.table import Table

NAME = "blinn-phong-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("n",)
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "kind": "fits",
    "name": "ngan_blinnphong.fit",
    "holds": {
        "model": "NganBlinnPhong",
        "shapes": {"albedo": (3,), "sharpness": ()},
    },
}

MODEL = Model(NAME, FORM)
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; see `ngan.published`."""
    albedos = published[DIFFUSE], published["albedo"]
    shape = {"n": published["sharpness"]}
    return ngan.published(MODEL, table, objective, albedos, shape)
