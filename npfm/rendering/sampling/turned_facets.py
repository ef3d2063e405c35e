"""A distribution of microfacets that is turned about the normal, by cells of theta_h and phi_h.

The counterpart of `facets` for fits of tables of both directions: half vectors are drawn by two
tables of quantiles, of the azimuth and of theta_h at each azimuth (Dupuy et al. 2015, appendix A,
which has slopes along x and y), and are uniform in projected solid angle inside a cell.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.directional import Directional
from npfm.reflectance.tabulated_slopes import looked_up, neighbours
from npfm.rendering.sampling.facets import drawn, half_angles
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

#: Bins of theta_h, uniform in its square root: the width of highlights, at those of the azimuth.
THETA_H_BINS = 32

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TurnedFacets:
    """Facets by cells of phi_h and theta_h.

    Parameters
    ----------
    D : ndarray, shape (azimuths, bins)
        Distribution of normals, in any scale; above 0.
    squares : ndarray, shape (bins + 1,)
        Squared sines of the edges of the bins of theta_h, from 0 to 1.
    """

    D: Array
    squares: Array

    @property
    def solid_angles(self) -> Array:
        """Projected solid angles of the cells of each bin of theta_h, shape (bins,)."""
        return np.diff(self.squares) * np.pi / len(self.D)

    @property
    def middles(self) -> Array:
        """Normals at the middles of the cells over a surface with normal z: (azimuths, bins, 3)."""
        square = (self.squares[1:] + self.squares[:-1]) / 2
        phi = np.arange(len(self.D))[:, None] / len(self.D) * 2 * np.pi
        sine, cosine = np.sqrt(square), np.sqrt(1 - square)
        return np.stack(
            np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), cosine), axis=-1
        )

    def normals(self, cumulative: Array, u: Array) -> Array:
        """Normals (p, m, 3) over a surface with normal z of points `u` (p, m, 2), by quantiles.

        Parameters
        ----------
        cumulative : ndarray, shape (p, azimuths * bins)
            Shares of the cells, added up cell by cell to 1.
        u : ndarray, shape (p, m, 2)
            Points of the unit square.
        """
        azimuths, bins = self.D.shape
        column, across = drawn(cumulative[:, bins - 1 :: bins], u[..., 0])
        ends = np.concatenate([np.zeros((len(cumulative), 1)), cumulative[:, bins - 1 :: bins]], 1)
        lower = np.take_along_axis(ends, column, axis=1)
        upper = np.take_along_axis(ends, column + 1, axis=1)
        cell, along = drawn(cumulative, lower + u[..., 1] * (upper - lower))
        row = np.clip(cell - column * bins, 0, bins - 1)
        square = self.squares[row] + along * (self.squares[row + 1] - self.squares[row])
        phi = (column - 0.5 + across) / azimuths * 2 * np.pi
        sine = np.sqrt(square)
        cosine = np.sqrt(np.maximum(1 - square, 0))
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)

    def cells(self, half: Array) -> NDArray[np.intp]:
        """Cells, as indices into a flattened D, that half vectors (..., 3) fall into."""
        azimuths, bins = self.D.shape
        place = np.arctan2(half[..., 1], half[..., 0]) / (2 * np.pi) * azimuths
        column = np.floor(place + 0.5).astype(np.intp) % azimuths
        square = np.clip(half[..., 0] ** 2 + half[..., 1] ** 2, 0, 1)
        row = np.clip(np.searchsorted(self.squares, square, side="right") - 1, 0, bins - 1)
        return column * bins + row


def turned_facets(given: Given) -> TurnedFacets:
    """Facets of a fit of a table of both directions.

    Raises
    ------
    NpfmError
        If the fit has no factor D that is tabulated so.
    """
    D, grid = given.parameters.get("D"), given.grid
    assert isinstance(grid, Directional)
    if D is None or D.shape != (1, 2 * grid.theta_i_count - 1, grid.phi_i_count):
        raise NpfmError(
            "the fit has no factor D of theta_h and phi_h to take directions from; give one of "
            "power-iteration"
        )
    edges = (np.arange(THETA_H_BINS + 1) / THETA_H_BINS) ** 2 * np.pi / 2
    squares = np.sin(edges) ** 2
    shape = grid.phi_i_count, THETA_H_BINS
    middles = TurnedFacets(np.ones(shape), squares).middles.reshape(-1, 3)
    found = D[0].astype(float)
    found = looked_up(found, *neighbours(middles, found.shape))
    return TurnedFacets(found.reshape(shape), squares)


def frames(at: Shading) -> Array:
    """Rows x, y, z of frames with z the normal and x the tangent, (p, 3, 3)."""
    if at.tangent is None:
        raise ValueError("facets that are turned are turned from a tangent")
    return np.stack([at.tangent, np.cross(at.normal, at.tangent), at.normal], axis=1)


def local_half(light: Array, at: Shading) -> tuple[NDArray[np.bool_], Array, Array]:
    """What is above the horizon, half vectors (p, m, 3) along the frames, and cosines of theta_d.

    Below the horizon they are the normal and 1.
    """
    above, _, cos_d = half_angles(light, at)
    half = (light + at.view[:, None]) @ frames(at).transpose(0, 2, 1)
    half = half / (2 * cos_d)[..., None]
    return above, np.where(above[..., None], half, [0.0, 0.0, 1.0]), cos_d
