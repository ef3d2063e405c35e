"""A distribution of microfacets that is constant in each bin of theta_h, as tables are read."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.grids import Grid
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Facets:
    """Facets by bins of theta_h.

    Parameters
    ----------
    D : ndarray, shape (bins,)
        Distribution of normals, in any scale; not negative and not all zero.
    squares : ndarray, shape (bins + 1,)
        Squared sines of the edges of the bins, from 0 to 1: their differences, times pi, are the
        projected solid angles of the bins.
    grid : Grid
        Whose bins they are.
    """

    D: Array
    squares: Array
    grid: Grid

    @property
    def areas(self) -> Array:
        """Projected area of the facets of each bin, over pi."""
        return self.D * np.diff(self.squares)

    def cosines(self, k: NDArray[np.int64], part: Array) -> Array:
        """Cosines of theta_h at a part, in [0, 1], of the projected solid angle of bins k."""
        lower = self.squares[k]
        return np.sqrt(np.maximum(1 - lower - part * (self.squares[k + 1] - lower), 0))

    def bins(self, cos_h: Array) -> NDArray[np.integer]:
        """Bins that half vectors at these cosines fall into."""
        return self.grid.theta_h_bin(np.arccos(np.clip(cos_h, 0, 1)))


def facets(given: Given) -> Facets:
    """Facets of a fit: its factor D, in the mean over the channels.

    Raises
    ------
    NpfmError
        If the fit has no factor D, or one for each of several lobes.
    """
    if "D" not in given.parameters:
        raise NpfmError("the fit has no factor D to take directions from; give one that has")
    D = np.asarray(given.parameters["D"], dtype=float).mean(axis=0)
    if D.ndim > 1:
        raise NpfmError("the fit has a D for each of its lobes; choose 'normal-distribution'")
    return Facets(D, np.sin(given.grid.theta_h_edges) ** 2, given.grid)


def drawn(cumulative: Array, u: Array) -> tuple[NDArray[np.int64], Array]:
    """Bins (p, m) with the shares (p, bins) that add up to `cumulative`, by quantiles.

    Returns
    -------
    k : ndarray of int, shape (p, m)
    part : ndarray, shape (p, m)
        How far each of `u` is on the way through its bin's share: uniform in [0, 1] again.
    """
    rows = zip(cumulative, u, strict=True)
    k = np.stack([np.searchsorted(row, x, side="right") for row, x in rows])
    k = np.minimum(k, cumulative.shape[1] - 1)
    upper = np.take_along_axis(cumulative, k, axis=1)
    lower = np.where(k > 0, np.take_along_axis(cumulative, np.maximum(k - 1, 0), axis=1), 0.0)
    return k, np.clip((u - lower) / np.maximum(upper - lower, np.finfo(float).tiny), 0, 1)


def reflected(half: Array, at: Shading) -> Array:
    """Light directions (p, m, 3) that half vectors (p, m, 3) mirror to the view."""
    return 2 * (half @ at.view[:, :, None]) * half - at.view[:, None]


def half_angles(light: Array, at: Shading) -> tuple[NDArray[np.bool_], Array, Array]:
    """Which light directions are above the horizon, and cosines of theta_h and theta_d, (p, m).

    Both are 1 below the horizon.
    """
    cos_i, cos_io = np.moveaxis(light @ np.stack([at.normal, at.view], axis=-1), -1, 0)
    above = cos_i > 0
    cos_d = np.where(above, np.sqrt(np.maximum(1 + cos_io, 0) / 2), 1)
    cos_h = np.where(above, np.minimum((cos_i + at.cos_o[:, None]) / (2 * cos_d), 1), 1)
    return above, cos_h, cos_d
