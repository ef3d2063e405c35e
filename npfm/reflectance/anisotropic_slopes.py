"""A distribution of microfacet normals tabulated by theta_h and phi_h, and its slopes.

Integrals over the hemisphere are sums: over theta_h by the midpoint rule in sqrt(theta_h), as for
isotropic distributions (`npfm.reflectance.slopes`), over phi_h by equal steps. |o.h| depends on the
azimuths of o and h only by their difference, so that a Fourier transform over the azimuth turns its
integrals into small products of matrices, one a frequency.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.microsurfaces import turned_scale

Array = NDArray[np.float64]

#: Amplitude of fine waves over the azimuth, as a share of the mean, above which a distribution is
#: too narrow for its azimuths: roughness read off it is then off by 1 % or more.
UNRESOLVED = 0.4


@dataclass(frozen=True)
class Normals:
    """Normals at which a distribution is summed up.

    Parameters
    ----------
    theta_h_bins, phi_h_bins : int
        Bins from 0 to pi/2, uniform in sqrt(theta_h), and steps around the normal.
    """

    theta_h_bins: int = 90
    phi_h_bins: int = 90

    @property
    def shape(self) -> tuple[int, int]:
        """Bins of theta_h and of phi_h."""
        return self.theta_h_bins, self.phi_h_bins

    @cached_property
    def theta_h(self) -> Array:
        """Elevations in radians, shape (theta_h_bins,)."""
        return ((np.arange(self.theta_h_bins) + 0.5) / self.theta_h_bins) ** 2 * np.pi / 2

    @cached_property
    def phi_h(self) -> Array:
        """Azimuths in radians, the first 0, shape (phi_h_bins,)."""
        return np.arange(self.phi_h_bins) / self.phi_h_bins * 2 * np.pi

    @cached_property
    def directions(self) -> Array:
        """Unit vectors over a surface with normal z and tangent x, shape `shape` + (3,)."""
        theta, phi = np.broadcast_arrays(self.theta_h[:, None], self.phi_h)
        sine = np.sin(theta)
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)

    @cached_property
    def solid_angle(self) -> Array:
        """What a sum over normals is weighted by, in sr, shape (theta_h_bins,)."""
        root = (np.arange(self.theta_h_bins) + 0.5) / self.theta_h_bins
        width = np.pi * root / self.theta_h_bins
        return np.sin(self.theta_h) * width * 2 * np.pi / self.phi_h_bins


@lru_cache(maxsize=8)
def facing(normals: Normals, elevations: tuple[float, ...], clamped: bool = False) -> Array:
    """Fourier transform over the azimuth of |o.h|, times the solid angles of the normals.

    Parameters
    ----------
    normals : Normals
        h.
    elevations : tuple of float
        theta_o in radians; the azimuths of o are those of h.
    clamped : bool
        Whether it is max(0, o.h) instead.

    Returns
    -------
    ndarray, shape (phi_h_bins // 2 + 1, elevations, theta_h_bins)
        What `projected` takes.
    """
    theta_o, theta_h = np.array(elevations)[:, None, None], normals.theta_h[:, None]
    cosine = np.cos(theta_o) * np.cos(theta_h) + np.sin(theta_o) * np.sin(theta_h) * np.cos(
        normals.phi_h
    )
    kernel = np.maximum(cosine, 0) if clamped else np.abs(cosine)
    # Even in the azimuth: the transform is real.
    waves = np.fft.rfft(kernel, axis=-1).real.transpose(2, 0, 1)
    return np.ascontiguousarray(waves * normals.solid_angle)


def projected(facing: Array, D: Array) -> Array:
    """Integrals of |o.h| D(h) for o at each elevation and azimuth.

    For D as `normalised` and of mean slope 0 it is 2 sigma(o) - cos(theta_o), sigma being the
    projected area of the visible microfacets, cos(theta_o) / G1(o).

    Parameters
    ----------
    facing : ndarray, shape (frequencies, elevations, theta_h_bins)
        As `facing` gives it.
    D : ndarray, shape (theta_h_bins, phi_h_bins)

    Returns
    -------
    ndarray, shape (elevations, phi_h_bins)
    """
    waves = np.fft.rfft(D, axis=1).T[..., None]
    # Two real products cost half of one that first makes the matrices complex.
    product = facing @ waves.real + 1j * (facing @ waves.imag)
    return np.fft.irfft(product[..., 0].T, n=D.shape[1], axis=1)


def normalised(D: Array, normals: Normals) -> Array:
    """D in the scale in which its microfacets cover the surface: equation 4 of Dupuy et al. 2015.

    Parameters
    ----------
    D : ndarray, shape (theta_h_bins, phi_h_bins)
        In any scale, not negative and not all zero.
    """
    return D / area(D, normals)


def area(D: Array, normals: Normals) -> float:
    """Area of the surface that the microfacets of D cover: its integral times cos(theta_h)."""
    return float((normals.solid_angle * np.cos(normals.theta_h) @ D).sum())


def ggx_scale(D: Array, normals: Normals) -> Array:
    """Scale matrix of a GGX distribution, shape (2, 2).

    Dupuy et al. 2015, appendix C, in the frame of the principal axes, so that what is turned about
    the normal has a turned matrix. The mean absolute slope along the long axis is its alpha. The
    other follows from azimuths alone: with E the mean of exp(2 i phi) over the facets,
    (1 - |E|) / (1 + |E|) is the ratio of the axes, and half the angle of E the direction of the
    long one. That is exact for GGX, as is the paper's rho, and what narrow highlights are resolved
    best by.
    """
    D, phi = normalised(D, normals), normals.phi_h
    facets = (normals.solid_angle * np.cos(normals.theta_h)) @ D
    slopes = (normals.solid_angle * np.sin(normals.theta_h)) @ D
    mean = np.sum(facets * np.exp(2j * phi))
    angle, ratio = np.angle(mean) / 2, (1 - np.abs(mean)) / (1 + np.abs(mean))
    alpha = _mean_absolute(slopes, angle)
    return turned_scale((alpha, alpha * ratio), angle)


def _mean_absolute(slopes: Array, angle: float) -> float:
    """Mean of |slope| along an angle, of the sums of slopes (phi_h_bins,) towards each azimuth.

    By the Fourier series of |cos|, whose edge falls between the azimuths:
    coefficients 2 / pi (-1)^k / (1 - 4 k^2) of exp(2 i k phi).
    """
    count = len(slopes)
    k = np.arange(count // 4 + 1)
    waves = np.fft.rfft(slopes)[2 * k] * np.exp(2j * k * angle)
    twice = np.where((k == 0) | (4 * k == count), 1.0, 2.0)
    return float(np.sum(twice * 2 / np.pi * (-1.0) ** k / (1 - 4.0 * k**2) * waves.real))


def beckmann_scale(D: Array, normals: Normals) -> Array:
    """Scale matrix of a Beckmann distribution, shape (2, 2): twice the second moments of slopes.

    Dupuy et al. 2015, appendix C, but with the factor on the other side, as in
    `npfm.reflectance.slopes.beckmann_roughness`.
    """
    weight = normals.solid_angle * np.sin(normals.theta_h) * np.tan(normals.theta_h)
    squares = weight @ normalised(D, normals)
    towards = np.stack([np.cos(normals.phi_h), np.sin(normals.phi_h)])
    return 2 * (towards * squares) @ towards.T


def too_narrow(D: Array, normals: Normals) -> bool:
    """Whether a distribution is narrower than its azimuths can tell.

    Looked at are waves of 16/7 to 8/3 azimuths: what finer ones show depends on how the
    distribution happens to lie between the azimuths.
    """
    slopes = (normals.solid_angle * np.sin(normals.theta_h)) @ D
    waves, count = np.abs(np.fft.rfft(slopes)), normals.phi_h_bins
    fine = 2 * waves[max(count * 3 // 8, 1) : count * 7 // 16 + 1]
    return bool(fine.max(initial=0) > UNRESOLVED * waves[0])
