"""The model of Loew et al. 2012, fitted by the objective of the 2016 paper.

The form is that of `npfm.fitting.parametric.abc`.
Bagher et al. 2016, section 5: "Loew (our metric)", which they minimise by the Ceres solver.
"""

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import author_metrics, lobe_fits, lobes
from npfm.fitting.parametric.abc import FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "abc-ours"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("b", "c", "eta")
SOLVER = False
OWN_TABLE = 1e-6


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model; `solve` and `seed` are not needed. See `lobe_fits.fit`."""
    return lobe_fits.fit(NAME, FORM, author_metrics.compressive, table, objective)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)
