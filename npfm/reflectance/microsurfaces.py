"""Distributions of microfacets that have a formula: how many face where, and how large they look.

Cosines are arrays; roughness alpha is a number above 0, or an array that broadcasts. Walter et al.
2007, "Microfacet models for refraction through rough surfaces".

Anisotropic ones are those whose slopes are stretched and turned: theirs are unit vectors (..., 3)
over a surface with normal z and tangent x, and the scale matrix of appendix C of Dupuy et al. 2015,
[[alpha_x^2, rho alpha_x alpha_y], [rho alpha_x alpha_y, alpha_y^2]].
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import erfc

Array = NDArray[np.float64]

#: Square of a sine or tangent that stands for 0.
TINY = 1e-16


def ggx(cos_h: Array, alpha: float | Array) -> Array:
    """GGX distribution of normals in 1/sr (Walter et al. 2007, equation 33)."""
    return alpha**2 / (np.pi * (1 + cos_h**2 * (alpha**2 - 1)) ** 2)


def ggx_area(cosine: Array, alpha: float | Array) -> Array:
    """Projected area of the visible facets of `ggx`: cosine over G1 of equation 34 there."""
    return (cosine + np.sqrt(cosine**2 + alpha**2 * (1 - cosine**2))) / 2


def beckmann(cos_h: Array, alpha: float) -> Array:
    """Beckmann distribution of normals in 1/sr (Walter et al. 2007, equation 25)."""
    return np.exp(-((tangent(cos_h) / alpha) ** 2)) / (np.pi * alpha**2 * cos_h**4)


def beckmann_area(cosine: Array, alpha: float | Array) -> Array:
    """Projected area of the visible facets of `beckmann`: cosine over G1 of equation 26 there."""
    width = alpha * np.sqrt(np.maximum(1 - cosine**2, TINY))
    a = cosine / width
    # Beyond 30 the tail is 0 in double precision, and its square may be infinite.
    tail = np.exp(-(np.minimum(a, 30.0) ** 2))
    return cosine * (1 - erfc(a) / 2) + width * tail / (2 * np.sqrt(np.pi))


def tangent(cosine: Array) -> Array:
    """Tangent of an angle from its cosine, not quite 0 where that is 1."""
    return np.sqrt(np.maximum(1 / cosine**2 - 1, TINY))


def turned_scale(alpha: tuple[float, float], turn: float) -> Array:
    """Scale matrix, shape (2, 2), of roughness along axes turned from x and y, in radians."""
    axes = turned_axes(turn)
    return axes * np.array(alpha) ** 2 @ axes.T


def turned_axes(turn: float) -> Array:
    """Columns x and y, shape (2, 2), turned by an angle in radians."""
    return np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])


def scale_matrix(alpha_x: float, alpha_y: float, rho: float) -> Array:
    """Scale matrix, shape (2, 2), of roughness along x and y and their correlation.

    Raises
    ------
    ValueError
        If there is no such surface: a roughness that is not above 0, a correlation of 1.
    """
    if not (alpha_x > 0 and alpha_y > 0 and abs(rho) < 1):
        raise ValueError(f"no surface has alpha {alpha_x:g}, {alpha_y:g} and rho {rho:g}")
    mixed = rho * alpha_x * alpha_y
    return np.array([[alpha_x**2, mixed], [mixed, alpha_y**2]])


def roughness(scale: Array) -> tuple[float, float, float]:
    """alpha_x, alpha_y and rho of a scale matrix."""
    alpha_x, alpha_y = np.sqrt(scale[0, 0]), np.sqrt(scale[1, 1])
    return float(alpha_x), float(alpha_y), float(scale[0, 1] / (alpha_x * alpha_y))


def anisotropic_ggx(h: Array, scale: Array) -> Array:
    """GGX distribution of normals h in 1/sr: P_X of appendix C of Dupuy et al. 2015."""
    spread = h[..., 2] ** 2 + _form(h, np.linalg.inv(scale))
    return 1 / (np.pi * np.sqrt(np.linalg.det(scale)) * spread**2)


def anisotropic_ggx_area(o: Array, scale: Array) -> Array:
    """Projected area of the visible facets of `anisotropic_ggx` for views o."""
    return (o[..., 2] + np.sqrt(o[..., 2] ** 2 + _form(o, scale))) / 2


def anisotropic_beckmann(h: Array, scale: Array) -> Array:
    """Beckmann distribution of normals h in 1/sr: P_G of appendix C of Dupuy et al. 2015."""
    squared = np.maximum(h[..., 2] ** 2, TINY)
    steep = _form(h, np.linalg.inv(scale)) / squared
    # Not 0 / 0 at grazing angles.
    return np.exp(-steep - 2 * np.log(squared)) / (np.pi * np.sqrt(np.linalg.det(scale)))


def anisotropic_beckmann_area(o: Array, scale: Array) -> Array:
    """Projected area of the visible facets of `anisotropic_beckmann` for views o."""
    sine = np.maximum(1 - o[..., 2] ** 2, TINY)
    alpha = np.sqrt(np.maximum(_form(o, scale), TINY * scale.max()) / sine)
    return beckmann_area(o[..., 2], alpha)


def _form(vectors: Array, matrix: NDArray) -> Array:
    """Quadratic form of the parts of vectors (..., 3) along the surface."""
    along: Array = vectors[..., :2]
    return np.asarray(np.einsum("...i,ij,...j", along, matrix, along), dtype=float)
