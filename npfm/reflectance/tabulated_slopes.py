"""An anisotropic distribution of microfacet normals as a table of both directions tells it.

It is tabulated at as many azimuths as the table has, and at elevations half as far apart: for light
and view at neighbouring elevations of one azimuth the half vector is between them. Between these
normals 1 / sqrt(D) is linear in sin^2(theta_h) and in phi_h. Along a meridian that is exact for
GGX, and it keeps what is narrower than the steps of the table from becoming as broad as they are.
Beyond the last elevation, 75 degrees for the UTIA database, D is constant.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.anisotropic_slopes import Normals

Array = NDArray[np.float64]

#: Share of the largest D that stands for 0, which has no 1 / sqrt(D).
NOTHING = 1e-12


def elevations(count: int) -> Array:
    """Elevations of D in radians: k / (count + 1) of 90 degrees, k from 0 on."""
    return np.arange(count) / (count + 1) * np.pi / 2


@lru_cache(maxsize=8)
def _resampling(count: int, normals: Normals, measure: Callable[[Array], Array] = np.sin) -> Array:
    """Matrix (theta_h_bins, count) that is linear in a squared sine or tangent of theta_h."""
    squares, at = measure(elevations(count)) ** 2, measure(normals.theta_h) ** 2
    return np.stack([np.interp(at, squares, row) for row in np.eye(count)]).T


def at_normals(D: Array, normals: Normals) -> Array:
    """D at other elevations of its azimuths.

    Parameters
    ----------
    D : ndarray, shape (elevations, azimuths)
        Not negative and not all zero.
    normals : Normals
        Of as many azimuths.

    Returns
    -------
    ndarray, shape normals.shape
    """
    return (_resampling(len(D), normals) @ _roots(D)) ** -2.0


def as_ggx(D: Array, normals: Normals) -> Array:
    """`at_normals`, but falling on beyond the last elevation as between the last two.

    What is exact for GGX at all elevations: what lies beyond 75 degrees is some percent of its mean
    slope.
    """
    roots, squares = _roots(D), np.sin(elevations(len(D))) ** 2
    onwards = np.maximum(np.sin(normals.theta_h) ** 2 - squares[-1], 0)
    fall = np.maximum(roots[-1] - roots[-2], 0) / (squares[-1] - squares[-2]) if len(D) > 1 else 0.0
    return (_resampling(len(D), normals) @ roots + onwards[:, None] * fall) ** -2.0


def as_beckmann(D: Array, normals: Normals) -> Array:
    """`at_normals`, but with log(D cos^4) linear in tan^2(theta_h), as is exact for Beckmann."""
    theta = elevations(len(D))
    logarithm = np.log(np.maximum(D, NOTHING * D.max())) + 4 * np.log(np.cos(theta))[:, None]
    cosine = np.maximum(np.cos(normals.theta_h), np.cos(theta[-1]))
    return np.exp(_resampling(len(D), normals, np.tan) @ logarithm) / cosine[:, None] ** 4


def _roots(D: Array) -> Array:
    return 1 / np.sqrt(np.maximum(D, NOTHING * D.max()))


def neighbours(h: Array, shape: tuple[int, int]) -> tuple[NDArray[np.int32], Array]:
    """Entries (n, 4) of a D of some shape that normals h (n, 3) are between, and their shares."""
    count, azimuths = shape
    squares = np.sin(elevations(count)) ** 2
    row = np.interp(h[:, 0] ** 2 + h[:, 1] ** 2, squares, np.arange(count))
    column = np.arctan2(h[:, 1], h[:, 0]) / (2 * np.pi) * azimuths
    low, left = np.floor(row), np.floor(column)
    up, right = row - low, column - left
    rows = np.stack([low, np.minimum(low + 1, count - 1)], axis=1).astype(np.int32)
    columns = np.stack([left, left + 1], axis=1).astype(np.int32) % azimuths
    index = rows[:, :, None] * azimuths + columns[:, None]
    share = np.stack([1 - up, up], 1)[:, :, None] * np.stack([1 - right, right], 1)[:, None]
    return index.reshape(-1, 4).astype(np.int32), share.reshape(-1, 4)


def looked_up(D: Array, index: NDArray, share: Array) -> Array:
    """D, shape (n,), at normals that `neighbours` has placed."""
    return (_roots(D).ravel()[index] * share).sum(axis=-1) ** -2.0


def rougher(D: Array, factors: tuple[float, float]) -> Array:
    """D with slopes along x and y stretched by two factors: equation 9 of Dupuy et al. 2015.

    D' cos^4(theta') = D cos^4(theta) / (factor_x factor_y), tabulated at the same normals as D.

    Parameters
    ----------
    D : ndarray, shape (elevations, azimuths)
        Not negative and not all zero.
    factors : tuple of float
        Above 0; 2 is twice as rough.
    """
    count, azimuths = D.shape
    slope, phi = np.tan(elevations(count))[:, None], np.arange(azimuths) / azimuths * 2 * np.pi
    x, y = slope * np.cos(phi) / factors[0], slope * np.sin(phi) / factors[1]
    length = np.sqrt(1 + x**2 + y**2)
    source = (np.stack([x, y, np.ones_like(x)]) / length).reshape(3, -1).T
    before = looked_up(D, *neighbours(source, D.shape)).reshape(D.shape)
    return before * ((1 + slope**2) / length**2) ** 2 / (factors[0] * factors[1])
