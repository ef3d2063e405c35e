"""The model of Ward 1992, fitted as Ngan et al. 2005 fit it: by their cosine-weighted metric.

rho = rho_d + rho_s lobe, the lobe and its search in `npfm.fitting.parametric.ngan`; the roughness
is shared by the channels.
"""

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import author_metrics, lobe_fits, lobes
from npfm.fitting.parametric.ngan import WARD as FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "ward"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness",)
SOLVER = False
OBJECTIVE = False
OWN_TABLE = 1e-6


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model; `solve` and `seed` are not needed. See `lobe_fits.fit`."""
    return lobe_fits.fit(NAME, FORM, author_metrics.cosine, table, objective)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
