"""The Smith shadowing factor of a tabulated normal distribution, as linear algebra.

G1(o) = cos(theta_o) N / S(o), with N the integral of D(h) cos(theta_h) over the hemisphere
(equation 19 of Bagher et al. 2016) and S(o) that of max(0, o.h) D(h): the projected area of the
microsurface over that of its visible side. Both are linear in D.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.slopes import facing

#: Gauss-Legendre points in each interval between the nodes of D.
QUADRATURE_POINTS = 8


@lru_cache(maxsize=4)
def _quadrature(grid: HalfDifference) -> tuple[NDArray, NDArray]:
    """Points theta_h (q,) and the matrix (q, bins) that turns D into D(theta_h) sin dtheta_h.

    D is linear between the bin centres and constant outside them (section 4.3).
    """
    nodes = grid.theta_h
    edges = np.concatenate([[0.0], nodes, [np.pi / 2]])
    x, w = np.polynomial.legendre.leggauss(QUADRATURE_POINTS)
    half = np.diff(edges)[:, None] / 2
    theta = (edges[:-1, None] + half * (1 + x)).ravel()
    weight = (half * w).ravel() * np.sin(theta)
    hats = np.array([np.interp(theta, nodes, row) for row in np.eye(nodes.size)]).T
    return theta, hats * weight[:, None]


@lru_cache(maxsize=4)
def normalisation_vector(grid: HalfDifference) -> NDArray[np.float64]:
    """Vector n, shape (theta_h_bins,), with n @ D the integral of D cos(theta_h) (equation 19)."""
    theta, hats = _quadrature(grid)
    return 2 * np.pi * np.cos(theta) @ hats


def diffuseness(normal_distribution: NDArray, grid: HalfDifference) -> NDArray[np.float64]:
    """Equation 19 of a normal distribution with maximum 1: small for mirrors, large for chalk.

    Parameters
    ----------
    normal_distribution : ndarray, shape (..., theta_h_bins)
        D at the bin centres, scaled to maximum 1.

    Returns
    -------
    ndarray, shape (...)
        Integral of D cos(theta_h) over the hemisphere, at most pi.
    """
    return normal_distribution @ normalisation_vector(grid)


@lru_cache(maxsize=4)
def shadowing_matrix(grid: HalfDifference, elevations: tuple[float, ...]) -> NDArray[np.float64]:
    """Matrix A, shape (elevations, theta_h_bins), with A @ D = S / cos(theta_o).

    Parameters
    ----------
    grid : HalfDifference
        Where D is tabulated.
    elevations : tuple of float
        theta_o in radians, below pi / 2.
    """
    theta, hats = _quadrature(grid)
    theta_o = np.array(elevations)[:, None]
    return (facing(theta_o, theta) / np.cos(theta_o)) @ hats


def masking_shadowing(
    normal_distribution: NDArray, grid: HalfDifference, elevations: NDArray
) -> NDArray[np.float64]:
    """Smith's G1 of a tabulated normal distribution.

    Parameters
    ----------
    normal_distribution : ndarray, shape (theta_h_bins,)
        D at the bin centres, in any scale, non-negative and not all zero.
    grid : HalfDifference
        Where D is tabulated.
    elevations : ndarray
        theta_o in radians, below pi / 2.

    Returns
    -------
    ndarray, shape of elevations
        In (0, 1].
    """
    matrix = shadowing_matrix(grid, tuple(np.asarray(elevations).tolist()))
    projected = normalisation_vector(grid) @ normal_distribution
    return projected / (matrix @ normal_distribution)


def log_derivative(
    normal_distribution: NDArray, grid: HalfDifference, elevations: NDArray
) -> NDArray[np.float64]:
    """Derivative of log G1 with respect to log D, for G1 scaled to maximum 1.

    Returns
    -------
    ndarray, shape (elevations, theta_h_bins)
    """
    D = np.asarray(normal_distribution, dtype=float)
    matrix = shadowing_matrix(grid, tuple(np.asarray(elevations).tolist()))
    visible = matrix @ D
    share = matrix * D / visible[:, None]
    return share[np.argmin(visible)] - share
