"""The generalised Blinn-Phong model of Ashikhmin and Shirley 2000, one lobe or several.

`npfm.fitting.parametric.blinn_phong` has the equation, `npfm.fitting.parametric.mixtures` how it is
fitted: to be sampled, as by Lawrence et al. 2004, by one of two criteria.
"""

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import mixtures
from npfm.fitting.parametric.blinn_phong import FORM
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "ashikhmin-shirley"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("n", "F_0")
SOLVER = False
OBJECTIVE = False  # that of the criterion
OWN_TABLE = 1e-4  # a search that stops
SETTINGS = {
    "lobes": "how many (default: 1)",
    "criterion": {
        "kullback-leibler": "divergence of the reflected light (default)",
        "least-squares": "squared differences of the reflected light",
    },
}
LOBES = 1


def parameter_count(grid: HalfDifference, lobes: int = LOBES) -> int:
    """Number of values stored for a material, on whatever grid."""
    return mixtures.parameter_count(FORM, lobes)


def fit(
    table: Table,
    objective: Objective,
    solve: Solver,
    seed: int,
    *,
    lobes: int = LOBES,
    criterion: str = "kullback-leibler",
) -> Fit:
    """Fit the lobes; `solve` and `seed` are not needed, the starts are the same each time.

    `npfm.models` says what every `fit` takes and raises.

    Parameters
    ----------
    lobes : int
        How many.
    criterion : str
        What is minimised: ``kullback-leibler`` or ``least-squares``.
    """
    return mixtures.fit(NAME, FORM, lobes, criterion, table, objective)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return mixtures.tabulate(FORM, fit)
