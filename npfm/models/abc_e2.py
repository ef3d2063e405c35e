"""The model of Loew et al. 2012, fitted by their logarithmic metric E2.

The form is that of `npfm.fitting.parametric.abc`.
"""

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import author_metrics, lobe_fits, lobes
from npfm.fitting.parametric.abc import FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "abc-e2"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("b", "c", "eta")
SOLVER = False
OBJECTIVE = False
SCALE_FREE = False  # the logarithm is of 1 + the BRDF in 1/sr


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model; `solve` and `seed` are not needed. See `lobe_fits.fit`."""
    return lobe_fits.fit(NAME, FORM, author_metrics.logarithmic, table, objective)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
