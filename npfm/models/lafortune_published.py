"""Fits of Lafortune et al. 1997 by Ngan et al. 2005, who published them."""

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import lobes, ngan
from npfm.fitting.parametric.ngan import LAFORTUNE as FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "lafortune-published"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("c_xy", "c_z", "n")
SIGNED = ("c_xy",)
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "name": "ngan_lafortune.fit",
    "model": "NganLafortune",
    "shapes": {"albedo": (3,), "Cxy": (), "Cz": (), "sharpness": ()},
}


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; see `ngan.published`."""
    albedos = published[DIFFUSE], published["albedo"]
    shape = {"c_xy": published["Cxy"], "c_z": published["Cz"], "n": published["sharpness"]}
    return ngan.published(NAME, FORM, table, objective, albedos, shape)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
