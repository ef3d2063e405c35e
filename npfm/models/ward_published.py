"""The fits of Ward 1992 that Ngan et al. 2005 published (`npfm.fitting.parametric.ngan`)."""

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import lobes, ngan
from npfm.fitting.parametric.ngan import WARD as FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "ward-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness",)
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "name": "ngan_ward.fit",
    "model": "NganWard",
    "shapes": {"albedo": (3,), "roughness": ()},
}


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; see `ngan.published`."""
    albedos = published[DIFFUSE], published["albedo"]
    shape = {"roughness": published["roughness"]}
    return ngan.published(NAME, FORM, table, objective, albedos, shape)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
