"""Half vectors spread evenly over the widths that a highlight may have."""

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.grids import Grid
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "half-vector"

Array = NDArray[np.float64]


class HalfVectorSampling:
    """Half vectors spread evenly over the theta_h bins of a grid, whatever the material.

    Every bin, so every width of a highlight, gets the same share. Inside a bin, half vectors
    are uniform in solid angle. Their azimuth is uniform over those for which the light lies above
    the horizon, which is the case where, azimuths being counted from the view direction's,

        cos(phi_h) >= -cot(2 theta_h) cot(theta_o),

    so that no sample is lost; bins beyond theta_h = 45 degrees + theta_o / 2 have none of these.
    """

    def __init__(self, grid: Grid):
        self.grid = grid
        self.edges = grid.theta_h_edges

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        theta_o, limit, count = self.range(at)
        position = u[..., 0] * count
        k = np.minimum(position.astype(int), count - 1)
        upper, lower = self._cosines(k, limit)
        cos_h = upper + (position - k) * (lower - upper)
        phi = (2 * u[..., 1] - 1) * azimuth_limit(np.arccos(cos_h), theta_o)
        half = at.directions(cos_h, phi)
        return 2 * (half @ at.view[:, :, None]) * half - at.view[:, None]

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3).

        That of the half vector over 4 (o . h), Walter et al. 2007, equation 14.
        """
        theta_o, limit, count = self.range(at)
        cos_i, cos_io = np.moveaxis(light @ np.stack([at.normal, at.view], axis=-1), -1, 0)
        above = cos_i > 0
        cos_d = np.sqrt((1 + np.where(above, cos_io, 0)) / 2)
        cos_h = np.where(above, np.minimum((cos_i + np.cos(theta_o)) / (2 * cos_d), 1), 1)
        theta_h = np.arccos(cos_h)
        k = np.minimum(self.grid.theta_h_bin(theta_h), count - 1)
        upper, lower = self._cosines(k, limit)
        # At the rim of the range no azimuth is left; the floor keeps the density finite there.
        azimuths = 2 * np.maximum(azimuth_limit(theta_h, theta_o), 1e-9)
        return np.where(above, 1 / (count * (upper - lower) * azimuths * 4 * cos_d), 0)

    def range(self, at: Shading) -> tuple[Array, Array, NDArray[np.int64]]:
        """theta_o, the largest useful theta_h and the number of bins up to it, each (p, 1)."""
        theta_o = np.arccos(np.clip(at.cos_o, 0, 1))[:, None]
        limit = (np.pi / 2 + theta_o) / 2
        return theta_o, limit, np.searchsorted(self.edges, limit)

    def _cosines(self, k: NDArray[np.int64], limit: Array) -> tuple[Array, Array]:
        """Cosines of the two edges of bins k, cut at the limit."""
        return np.cos(self.edges)[k], np.cos(np.minimum(self.edges[k + 1], limit))


def azimuth_limit(theta_h: Array, theta_o: Array) -> Array:
    """Largest |phi_h| for which the light is above the horizon."""
    sine = np.sin(2 * theta_h) * np.sin(theta_o)
    cosine = -np.cos(2 * theta_h) * np.cos(theta_o)
    return np.arccos(np.clip(cosine / np.maximum(sine, 1e-12), -1, 1))


def make(given: Given) -> HalfVectorSampling:
    """Fill the bins of the grid."""
    return HalfVectorSampling(given.grid)
