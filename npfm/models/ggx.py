"""The GGX distribution that is nearest to that of `power_iteration`, with the F of that fit.

Dupuy et al. 2015, section 5.4 and appendix C: alpha is read off the mean of the slopes, and F
stays as it is. rho = rho_s D(theta_h; alpha) F(theta_d) G / (4 cos(theta_i) cos(theta_o)) with
Smith's correlated G.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.power_iterations import fits
from npfm.fitting.power_iterations.fits import Form, Parameters
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import ggx, ggx_area
from npfm.reflectance.slopes import ELEVATIONS, ggx_roughness
from npfm.reflectance.table import Table

NAME = "ggx"
COEFFICIENTS = ("rho_s",)
SHARED = ("alpha",)
SOLVER = False
OBJECTIVE = False
CONVERTED = True
OWN_TABLE = 1e-5  # alpha comes from sums over the bins
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


def _convert(D: NDArray, grid: HalfDifference) -> Parameters:
    return {"alpha": np.array([ggx_roughness(D, grid)])}


def _surface(p: Parameters, grid: HalfDifference) -> tuple[NDArray, NDArray]:
    alpha = float(p["alpha"][0])
    return ggx(np.cos(grid.theta_h), alpha), ggx_area(np.cos(ELEVATIONS), alpha)


FORM = Form(_convert, _surface)


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material."""
    return fits.parameter_count(FORM, grid)


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
    return fits.fit(NAME, FORM, table, objective, kernel, fresnel)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return fits.tabulate(FORM, fit)


def rougher(fit: Fit, factor: float) -> Fit:
    """Return the fit with slopes that are so many times as steep, all else as it is."""
    alpha = fit.parameters["alpha"] * fit.parameters["alpha"].dtype.type(factor)
    return replace(fit, parameters=fit.parameters | {"alpha": alpha}, records=())
