"""Microfacets from backscattered light alone: the model of Dupuy et al. 2015, by power iterations.

rho = rho_s D(theta_h) F(theta_d) G / (4 cos(theta_i) cos(theta_o)) with Smith's correlated G of D
(equations 1 to 3 there), which is not stored. D is shared by the channels; F and rho_s, its largest
value for a D that is normalised, are of each. There is no diffuse part.
"""

from dataclasses import replace

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.power_iterations import fits
from npfm.fitting.power_iterations.fits import TABULATED
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance import slopes
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "power-iteration"
COEFFICIENTS = ("rho_s",)
SHARED = ("D",)
SOLVER = False
OBJECTIVE = False  # only F follows it
SETTINGS = {
    "kernel": {
        "consistent": "D for the shadowing that it is rendered with (default)",
        "paper": "D for the paper's equation 11, which it is not rendered with",
    },
    "fresnel": {
        "least-squares": "F that minimises the objective (default)",
        "mean": "F as the mean of ratios, the paper's equation 20",
        "median": "F as their median",
    },
}


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material."""
    return fits.parameter_count(TABULATED, grid)


def fit(
    table: Table,
    objective: Objective,
    solve: Solver,
    seed: int,
    *,
    kernel: str = "consistent",
    fresnel: str = "least-squares",
) -> Fit:
    """Fit the model; `solve` and `seed` are not needed. See `power_iterations.fits.fit`."""
    return fits.fit(NAME, TABULATED, table, objective, kernel, fresnel)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return fits.tabulate(TABULATED, fit)


def rougher(fit: Fit, factor: float) -> Fit:
    """Return the fit with slopes that are so many times as steep, all else as it is."""
    D = slopes.rougher(fit.parameters["D"][0], fit.grid, factor)
    D = (D / D.max()).astype(fit.parameters["D"].dtype)
    return replace(fit, parameters=fit.parameters | {"D": D[None]}, records=())
