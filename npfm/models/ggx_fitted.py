"""GGX with a diffuse part and Schlick's Fresnel factor: what every renderer and game engine has.

rho = rho_d + rho_s (f0 + (1 - f0) (1 - cos(theta_d))^5) D(theta_h; alpha) G / (4 cos cos), D and
Smith's correlated G of GGX (Walter et al. 2007). `alpha` and `f0` are shared by the channels; rho_d
and rho_s are the colours of base and specular reflection. Fitted by the objective of Bagher et al.
2016 from several starts, it tells what the few numbers of such a form cost.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import author_metrics, lobe_fits, lobes
from npfm.fitting.parametric.lobes import Directions, Form, Shape
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import ggx, ggx_area
from npfm.reflectance.table import Table

NAME = "ggx-fitted"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("alpha", "f0")
SOLVER = False
OWN_TABLE = 1e-6


def lobe(shape: Shape, at: Directions) -> NDArray:
    """Values per unit rho_s, in 1/sr."""
    alpha, f0 = shape["alpha"], shape["f0"]
    F = f0 + (1 - f0) * (1 - at.cos_d) ** 5
    area_i, area_o = (ggx_area(cosine, alpha) for cosine in (at.cos_i, at.cos_o))
    shadowed = area_o * at.cos_i + area_i * at.cos_o - at.cos_i * at.cos_o
    return F * ggx(at.cos_h, alpha) / (4 * shadowed)


FORM = Form(
    lobe,
    lambda x: {"alpha": np.exp(x[0]), "f0": np.exp(x[1])},
    bounds=((np.log(1e-3), np.log(1e-3)), (0.0, 0.0)),
    starts={
        f"alpha={alpha:g} f0={f0:g}": (np.log(alpha), np.log(f0))
        for alpha, f0 in ((0.01, 0.5), (0.05, 0.5), (0.2, 0.1), (0.5, 0.1))
    },
    shared=True,
    samples=80_000,
)


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material, on whatever grid."""
    return lobes.parameter_count(FORM)


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model; `solve` and `seed` are not needed. See `lobe_fits.fit`."""
    return lobe_fits.fit(NAME, FORM, author_metrics.compressive, table, objective)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(FORM, fit)


def rougher(fit: Fit, factors: tuple[float, float]) -> Fit:
    """Return the fit with slopes that are so many times as steep, all else as it is.

    Along x and along y, which are the same on the only grid that the model is for.
    """
    alpha = fit.parameters["alpha"] * fit.parameters["alpha"].dtype.type(factors[0])
    return replace(fit, parameters=fit.parameters | {"alpha": alpha}, records=())
