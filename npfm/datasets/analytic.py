"""Reflectance by the formulas that Lawrence et al. 2004 factor, with the constants they print.

The constants are those of their Table 1. Directions are unit vectors (n, 3) above the horizon; the
normal is z, and x is the tangent. Each formula gives 1/sr, of shape (3, n). What the paper leaves
open is said where it is chosen.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from npfm.datasets.anisotropic_formulas import Pairs
from npfm.errors import NpfmError, suggest
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.microsurfaces import beckmann, tangent
from npfm.reflectance.table import INVALID, Table
from npfm.reflectance.table_files import read_table

Array = NDArray[np.float64]

#: Points on the half cylinder that `poulin_fournier` adds up.
CYLINDER_POINTS = 96


def cook_torrance(light: Array, view: Array) -> Array:
    """Rough metal: Cook and Torrance 1982, "A reflectance model for computer graphics".

    d R_d / pi + s F D G / (4 cos_i cos_o), with d = 0.1, s = 0.9, F_0 = R_d and m = 0.2, and D of
    Beckmann. They print pi in place of 4, and D without a pi of its own, four times as much: more
    than a surface receives. F follows from F_0 as theirs does, by the index
    (1 + F_0^(1/2)) / (1 - F_0^(1/2)) of a dielectric.
    """
    R_d = np.array([[0.12], [0.22], [0.48]])
    pairs = Pairs(light, view)
    cos_i, cos_o, cos_h, cos_d = light[:, 2], view[:, 2], pairs.half[:, 2], pairs.cos_d
    index = (1 + np.sqrt(R_d)) / (1 - np.sqrt(R_d))
    g = np.sqrt(index**2 + cos_d**2 - 1)
    F = ((g - cos_d) / (g + cos_d)) ** 2 / 2
    F *= 1 + ((cos_d * (g + cos_d) - 1) / (cos_d * (g - cos_d) + 1)) ** 2
    G = np.minimum(1, 2 * cos_h * np.minimum(cos_i, cos_o) / cos_d)
    D = beckmann(cos_h, 0.2)
    return 0.1 * R_d / np.pi + 0.9 * F * D * G / (4 * cos_i * cos_o)


def ward(light: Array, view: Array, alpha: tuple[float, float] = (0.2, 0.02)) -> Array:
    """Brushed metal: Ward 1992, "Measuring and modeling anisotropic reflection", equation 5a.

    rho_d / pi + rho_s exp(-tan^2(theta_h) (cos^2(phi_h) / alpha_x^2 + sin^2(phi_h) / alpha_y^2))
    / (4 pi alpha_x alpha_y (cos_i cos_o)^(1/2)), with rho_d = 0.1, rho_s = 1.2, and alpha_x = 0.2
    and alpha_y = 0.02 as alpha. Their rho_s is kept though a surface so bright sends out more than
    it receives.
    """
    h = Pairs(light, view).half
    exponent = ((h[:, 0] / alpha[0]) ** 2 + (h[:, 1] / alpha[1]) ** 2) / h[:, 2] ** 2
    area = 4 * np.pi * alpha[0] * alpha[1] * np.sqrt(light[:, 2] * view[:, 2])
    return np.broadcast_to(0.1 / np.pi + 1.2 * np.exp(-exponent) / area, (3, len(light)))


def ward_isotropic(light: Array, view: Array) -> Array:
    """Return the same with a roughness of 0.2 in all directions (equation 4): ours."""
    return ward(light, view, (0.2, 0.2))


def poulin_fournier(light: Array, view: Array) -> Array:
    """Threads side by side: Poulin and Fournier 1990, "A model for anisotropic reflection".

    Cylinders of radius 1 along x at distances d = 2 with the floor at the height of their axes,
    h = 0, so that they touch and hide it. n = 20, R_s = 0.8 and R_d = 0.2 are of Phong's model on
    each, for which Blinn's is taken here, normalised: R_d / pi + R_s (n + 8) / (8 pi) (m.h)^n, m
    being the normal of the cylinder. What one cylinder hides of its neighbour is left out, for
    light and view each. All is added up numerically, where they have sums over intervals.
    """
    angle = (np.arange(CYLINDER_POINTS) + 0.5) / CYLINDER_POINTS * np.pi - np.pi / 2
    h = Pairs(light, view).half
    total = np.zeros(len(light))
    for a in angle:
        m = np.array([0.0, np.sin(a), np.cos(a)])
        own = 0.2 / np.pi + 0.8 * 28 / (8 * np.pi) * np.maximum(h @ m, 0) ** 20
        total += own * _reached(light, m) * _reached(view, m)
    return np.broadcast_to(
        total * (np.pi / CYLINDER_POINTS) / (2 * light[:, 2] * view[:, 2]), (3, len(light))
    )


def _reached(direction: Array, m: Array) -> Array:
    """Cosine with the normal `m` of a cylinder, 0 where its neighbour at y = 2 or -2 is between."""
    y, z = direction[:, 1], direction[:, 2]
    across = np.hypot(y, z)
    # Distance of the neighbour's axis from the ray in the plane across the cylinders.
    away = ((2 - np.sign(y) * m[1]) * z + m[2] * np.abs(y)) / across
    return np.where(away >= 1, np.maximum(direction @ m, 0), 0)


def hapke_lommel(light: Array, view: Array) -> Array:
    """Dust, bright towards the light: Hapke 1963, "A theoretical photometric function".

    r S B / (cos_i + cos_o), Lommel and Seeliger's law with the angle a between light and view in
    S = (sin a + (pi - a) cos a) / pi + f (1 - cos a)^2 and, up to a = pi / 2,
    B = 2 - tan(a) / (2 g) (1 - exp(-g / tan a)) (3 - exp(-g / tan a)), beyond it 1. g = 0.6,
    f = 0.1 and r = 1. Hapke's factor 2 / (3 pi) is taken, so that a surface of r = 1 sends out less
    than it receives; errors that are relative do not depend on it.
    """
    g, f = 0.6, 0.1
    cosine = np.clip(np.einsum("ij,ij->i", light, view), -1, 1)
    a = np.arccos(cosine)
    S = (np.sin(a) + (np.pi - a) * cosine) / np.pi + f * (1 - cosine) ** 2
    slope = np.maximum(tangent(np.maximum(cosine, 1e-9)), 1e-9)
    fall = np.exp(-g / slope)
    B = np.where(cosine > 0, 2 - slope / (2 * g) * (1 - fall) * (3 - fall), 1)
    value = 2 / (3 * np.pi) * S * B / (light[:, 2] + view[:, 2])
    return np.broadcast_to(value, (3, len(light)))


#: All of them, by the names of the command line.
FORMULAS: Mapping[str, Callable[[Array, Array], Array]] = MappingProxyType(
    {
        "cook-torrance": cook_torrance,
        "hapke-lommel": hapke_lommel,
        "poulin-fournier": poulin_fournier,
        "ward": ward,
        "ward-isotropic": ward_isotropic,
    }
)
#: Those that do not change when the surface is turned about its normal.
ISOTROPIC = frozenset({"cook-torrance", "hapke-lommel", "ward-isotropic"})


def brdf(source: str) -> Callable[[Array, Array], Array]:
    """Reflectance by the name of a formula, or by the path of a table.

    Raises
    ------
    NpfmError
        If it is neither.
    """
    return FORMULAS[source] if source in FORMULAS else read_table(source).lookup


def materials() -> list[str]:
    """Names of the formulas that are materials: the isotropic ones, sorted."""
    return sorted(ISOTROPIC)


def tabulated(name: str) -> Table:
    """Values of an isotropic formula at the cells of the MERL grid.

    Raises
    ------
    NpfmError
        If there is no such formula.
    """
    if name not in ISOTROPIC:
        raise NpfmError(f"no isotropic formula '{name}'; {suggest(name, materials())}")
    values = np.full((3, *MERL.shape), INVALID)
    for k, theta_h in enumerate(MERL.theta_h):
        light, view = directions(theta_h, MERL.theta_d[:, None], MERL.phi_d)
        above = MERL.above_horizon[k]
        values[:, k, above] = FORMULAS[name](light[above], view[above])
    return Table(values)
