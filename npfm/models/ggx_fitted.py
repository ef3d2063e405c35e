"""GGX with a diffuse part and Schlick's Fresnel factor: what every renderer and game engine has.

rho = rho_d + rho_s (f0 + (1 - f0) (1 - cos(theta_d))^5) D(theta_h; alpha) G / (4 cos cos), D and
Smith's correlated G of GGX (Walter et al. 2007). `alpha` and `f0` are shared by the channels; rho_d
and rho_s are the colours of base and specular reflection. Fitted by the objective of Bagher et al.
2016 from several starts, it tells what the few numbers of such a form cost.

On tables of both directions alpha_x, alpha_y and rho are in place of alpha: slopes are stretched
and turned.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import author_metrics, lobe_fits, lobes
from npfm.fitting.parametric.lobes import Directions, Form, Shape
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import (
    anisotropic_ggx,
    anisotropic_ggx_area,
    ggx,
    ggx_area,
    roughness,
    scale_matrix,
    turned_axes,
)
from npfm.reflectance.table import Table

NAME = "ggx-fitted"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("alpha", "alpha_x", "alpha_y", "rho", "f0")
SIGNED = ("rho",)
GRIDS = ("half-difference", "directional")
SOLVER = False
OWN_TABLE = 1e-6
ROUGHNESS = ("alpha_x", "alpha_y", "rho")


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


def turned_lobe(shape: Shape, at: Directions) -> NDArray:
    """The same for slopes that are stretched and turned."""
    scale = scale_matrix(*(float(shape[name]) for name in ROUGHNESS))
    half, light, view = at.vectors
    F = shape["f0"] + (1 - shape["f0"]) * (1 - at.cos_d) ** 5
    area_i, area_o = anisotropic_ggx_area(light, scale), anisotropic_ggx_area(view, scale)
    shadowed = area_o * at.cos_i + area_i * at.cos_o - at.cos_i * at.cos_o
    return F * anisotropic_ggx(half, scale) / (4 * shadowed)


def _turned_shape(x: NDArray) -> Shape:
    """The shape of a vector: the logarithm of the scale matrix's root, and that of f0.

    Every vector is a surface, and no turn is another than the rest.
    """
    a, b, c = x[:3]
    logarithms, axes = np.linalg.eigh(np.array([[a, c], [c, b]]))
    found = roughness(axes * np.exp(2 * logarithms) @ axes.T)
    return dict(zip(ROUGHNESS, found, strict=True)) | {"f0": float(np.exp(x[3]))}


def _turned_start(alpha: float, longer: float, degrees: float) -> tuple[float, ...]:
    """Vector of roughness along an axis, and across it."""
    turn = turned_axes(np.deg2rad(degrees))
    matrix = turn * np.log([alpha, longer]) @ turn.T
    return float(matrix[0, 0]), float(matrix[1, 1]), float(matrix[0, 1]), float(np.log(0.3))


#: The long axis is no more than a thousand times the short one: rho is below 1 in float32.
TURNED = Form(
    turned_lobe,
    _turned_shape,
    bounds=((np.log(1e-3), np.log(1e-3), -3.4, np.log(1e-3)), (0.0, 0.0, 3.4, 0.0)),
    starts={
        f"alpha={alpha:g} {longer:g} turned={degrees:g}": _turned_start(alpha, longer, degrees)
        for alpha, longer, degrees in (
            *((0.05, 0.05, 0), (0.2, 0.2, 0), (0.5, 0.5, 0)),
            *((0.1, 0.4, turn) for turn in (0, 45, 90, 135)),
        )
    },
    shared=True,
    samples=20_000,
)


def _form(grid: HalfDifference | Directional) -> Form:
    return TURNED if isinstance(grid, Directional) else FORM


def parameter_count(grid: HalfDifference | Directional) -> int:
    """Number of values stored for a material: 8, or 10 with two axes."""
    return lobes.parameter_count(_form(grid))


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model; `solve` and `seed` are not needed. See `lobe_fits.fit`."""
    return lobe_fits.fit(NAME, _form(table.grid), author_metrics.compressive, table, objective)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    return lobes.tabulate(_form(fit.grid), fit)


def rougher(fit: Fit, factors: tuple[float, float]) -> Fit:
    """Return the fit with slopes that are so many times as steep, all else as it is.

    Along x and along y; on a half-difference grid, the same.
    """
    names = ROUGHNESS[:2] if isinstance(fit.grid, Directional) else ("alpha",)
    changed = {
        name: fit.parameters[name] * fit.parameters[name].dtype.type(factor)
        for name, factor in zip(names, factors, strict=False)
    }
    return replace(fit, parameters=fit.parameters | changed, records=())
