"""The fits of Ward 1992 that Ngan et al. 2005 published (`npfm.fitting.parametric.ngan`)."""

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import ngan
from npfm.fitting.parametric.lobes import Model
from npfm.fitting.parametric.ngan import WARD as FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.table import Table

NAME = "ward-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness",)
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "kind": "fits",
    "name": "ngan_ward.fit",
    "holds": {
        "model": "NganWard",
        "shapes": {"albedo": (3,), "roughness": ()},
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
    shape = {"roughness": published["roughness"]}
    return ngan.published(MODEL, table, objective, albedos, shape)
