"""Half vectors distributed as the D of a fit: Peng et al. 2017, equations 8 and 9.

The paper has one D that the channels share, times cos(theta_h) and normalised, as the density of
half vectors, and does not say how three lobes go together. Here they are a mixture, in the shares
that bring it nearest to the half vectors that the material reflects even light about.

D knows nothing of a diffuse part: where that is bright, light far from the mirror direction is left
to chance, and a share of directions by `cosine` is the remedy (docs/shared-lobes.md).
"""

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import LUMINANCE
from npfm.rendering.sampling.facets import Facets
from npfm.rendering.sampling.quantiles import QuantileSampling
from npfm.rendering.sampling.strategy import Given

NAME = "normal-distribution"
NEEDS = ("table", "parameters")

Array = NDArray[np.float64]


def mixture(table: Table, D: Array) -> Array:
    """Mix normal distributions so that half vectors fall as a material reflects even light.

    The shares are non-negative and make the sum of squared differences of probabilities, each
    relative to its own standard deviation, the least.

    Parameters
    ----------
    table : Table
        The material.
    D : ndarray, shape (lobes, theta_h)

    Returns
    -------
    ndarray, shape (theta_h,)
    """
    from scipy.optimize import nnls

    reflected = half_vectors(table)
    areas = np.diff(np.sin(table.grid.theta_h_edges) ** 2)
    mass = D * areas
    mass = mass / mass.sum(1, keepdims=True)
    if not reflected.any():
        shares = np.ones(len(D))
    else:
        reflected = reflected / reflected.sum()
        deviation = np.sqrt(np.maximum(reflected, 1e-6 * reflected.max()))
        shares, _ = nnls((mass / deviation).T, reflected / deviation)
    return shares @ (mass / areas)


def half_vectors(table: Table) -> Array:
    """Light that a material reflects, of even light from and to everywhere, by theta_h bin.

    The integral of brdf cos(theta_i) cos(theta_o) over both directions, whose measure is
    4 cos(theta_d) sin(theta_d) sin(theta_h) d(theta_h) d(theta_d) d(phi_d), in luminance and but
    for a constant.
    """
    grid = table.grid
    cos_i, cos_o = grid.cosines
    brdf = np.einsum("c,chdp->hdp", LUMINANCE, np.maximum(table.values, 0))
    energy = np.where(grid.above_horizon, brdf * cos_i * cos_o, 0).sum(2)
    return energy @ np.sin(2 * grid.theta_d) * -np.diff(np.cos(grid.theta_h_edges))


def make(given: Given) -> QuantileSampling:
    """Follow the D of the fit.

    Raises
    ------
    NpfmError
        If the fit has no D over the theta_h bins of its table.
    """
    assert given.table is not None, "the registry asks for what NEEDS names"
    grid, D = given.table.grid, given.parameters.get("D")
    if not isinstance(grid, HalfDifference) or D is None or D.shape[-1] != grid.theta_h_bins:
        raise NpfmError(f"'{NAME}' needs a fit with a D of theta_h; give one of shared-lobes")
    lobes = np.asarray(D, dtype=float).reshape(-1, grid.theta_h_bins)
    squares = np.sin(grid.theta_h_edges) ** 2
    return QuantileSampling(Facets(mixture(given.table, lobes), squares, grid))
