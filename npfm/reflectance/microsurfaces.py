"""Distributions of microfacets that have a formula: how many face where, and how large they look.

Cosines are arrays; roughness alpha is a number above 0, or an array that broadcasts. Walter et al.
2007, "Microfacet models for refraction through rough surfaces".
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


def beckmann_area(cosine: Array, alpha: float) -> Array:
    """Projected area of the visible facets of `beckmann`: cosine over G1 of equation 26 there."""
    width = alpha * np.sqrt(np.maximum(1 - cosine**2, TINY))
    a = cosine / width
    # Beyond 30 the tail is 0 in double precision, and its square may be infinite.
    tail = np.exp(-(np.minimum(a, 30.0) ** 2))
    return cosine * (1 - erfc(a) / 2) + width * tail / (2 * np.sqrt(np.pi))


def tangent(cosine: Array) -> Array:
    """Tangent of an angle from its cosine, not quite 0 where that is 1."""
    return np.sqrt(np.maximum(1 / cosine**2 - 1, TINY))
