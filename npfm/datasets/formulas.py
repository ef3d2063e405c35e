"""Published reflectance formulas, out of which `npfm.datasets.synthetic` builds its materials.

Cosines are arrays of shape (n,); reflectances, refractive indices and albedos may be numbers or
arrays of shape (3, 1), one row a colour channel.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import erf

from npfm.reflectance.microsurfaces import beckmann, ggx, tangent

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Angles:
    """Cosines of theta_h, theta_d, theta_i and theta_o of n samples above the horizon.

    They determine an isotropic reciprocal BRDF; the cosine of the angle between light and view
    is 2 cos_d^2 - 1.
    """

    cos_h: Array
    cos_d: Array
    cos_i: Array
    cos_o: Array


def fresnel(cos_d: Array, index: complex | NDArray) -> Array:
    """Unpolarised Fresnel reflectance of a surface in air (Born and Wolf, section 1.5.2)."""
    index = np.asarray(index, dtype=complex)
    refracted = np.sqrt(index**2 - 1 + cos_d**2)
    perpendicular = (cos_d - refracted) / (cos_d + refracted)
    parallel = (index**2 * cos_d - refracted) / (index**2 * cos_d + refracted)
    return (np.abs(perpendicular) ** 2 + np.abs(parallel) ** 2) / 2


def ggx_shadowing(cosine: Array, alpha: float | Array) -> Array:
    """Smith's G1 of `ggx` (Walter et al. 2007, equation 34)."""
    return 2 / (1 + np.sqrt(1 + alpha**2 * tangent(cosine) ** 2))


def beckmann_shadowing(cosine: Array, alpha: float) -> Array:
    """Smith's G1 of `beckmann` (Walter et al. 2007, equation 26)."""
    a = 1 / (alpha * tangent(cosine))
    return 2 / (1 + erf(a) + np.exp(-(a**2)) / (a * np.sqrt(np.pi)))


def ggx_lobe(angles: Angles, alpha: float | Array, reflectance: Array) -> Array:
    """Specular reflection of `ggx` facets in 1/sr."""
    shadowing = ggx_shadowing(angles.cos_i, alpha) * ggx_shadowing(angles.cos_o, alpha)
    return _lobe(angles, reflectance * ggx(angles.cos_h, alpha) * shadowing)


def beckmann_lobe(angles: Angles, alpha: float, reflectance: Array) -> Array:
    """Specular reflection of `beckmann` facets in 1/sr."""
    shadowing = beckmann_shadowing(angles.cos_i, alpha) * beckmann_shadowing(angles.cos_o, alpha)
    return _lobe(angles, reflectance * beckmann(angles.cos_h, alpha) * shadowing)


def _lobe(angles: Angles, factors: Array) -> Array:
    """F D G / (4 cos_i cos_o) (Walter et al. 2007, equation 20)."""
    return factors / (4 * angles.cos_i * angles.cos_o)


def rough_diffuse(angles: Angles, albedo: Array, sigma: float) -> Array:
    """Diffuse facets of slope deviation `sigma` in radians, brightest towards the light.

    Oren and Nayar 1994 in the form of Fujii, "A tiny improvement of Oren-Nayar reflectance model".
    """
    variance = sigma**2
    a = 1 - 0.5 * variance / (variance + 0.33) + 0.17 * albedo * variance / (variance + 0.13)
    b = 0.45 * variance / (variance + 0.09)
    s = 2 * angles.cos_d**2 - 1 - angles.cos_i * angles.cos_o
    t = np.where(s > 0, np.maximum(angles.cos_i, angles.cos_o), 1.0)
    return albedo / np.pi * (a + b * s / t)
