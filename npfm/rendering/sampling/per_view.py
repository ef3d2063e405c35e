"""Directions distributed as one material reflects, tabulated for every elevation of the view.

As Bagher et al. 2016 have it in their appendix "Rendering Details", from Pharr and Humphreys 2010,
section 14.6, and Matusik et al. 2003 before them: each slice of the BRDF that has one view is
sampled at the texels of a lat-long map of 90 x 360, turned into luminance, summed up and inverted.

The appendix leaves open whether the slices hold the cosine of the light, which belongs to what is
integrated: here they do. It indexes slices by the cosine of the view, so that the first of 90 would
reach from 0 to 8.5 degrees and miss most highlights: here each is a degree wide. And since a slice
has zeros where the BRDF at a view beside it has none, a share of each is that of a white surface.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import LUMINANCE
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "per-view"
NEEDS = ("table",)

Array = NDArray[np.float64]

#: Slices of the view, and rows and columns of the map of each (the appendix has 90 x 360).
SLICES, ROWS, COLUMNS = 90, 90, 360
#: Share of the directions that are spread as a white surface reflects.
WHITE_SHARE = 0.05


class PerViewSampling:
    """Directions distributed as a material reflects even light, texel by texel.

    Azimuths are counted from the view's; the middle of column 0 is there, so that the middle of
    another column is at the mirror direction.

    Raises
    ------
    NpfmError
        If the table is anisotropic: its slices hang on the azimuth of the view as well.
    """

    def __init__(self, table: Table):
        if table.grid.anisotropic:
            raise NpfmError(f"'{NAME}' is for isotropic tables, not for one on {table.grid.name}")
        mass = np.stack([_slice(table, (k + 0.5) / SLICES * np.pi / 2) for k in range(SLICES)])
        self.density = mass / _solid_angle()[:, None]
        self._rows = _cumulative(mass.sum(axis=2))
        self._columns = _cumulative(mass.reshape(-1, COLUMNS))

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        k = np.broadcast_to(_slices(at), u.shape[:2])
        row, down = _invert(self._rows, k, u[..., 0])
        column, across = _invert(self._columns, k * ROWS + row, u[..., 1])
        edges = _edges()
        cosine = edges[row] + down * (edges[row + 1] - edges[row])
        return at.directions(cosine, (column + across - 0.5) * (2 * np.pi / COLUMNS))

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        x, y, z = np.moveaxis(light @ np.swapaxes(at.view_frame, 1, 2), -1, 0)
        row = (np.arccos(np.clip(z, 0, 1)) * (ROWS / (np.pi / 2))).astype(int)
        column = np.floor(np.arctan2(y, x) * (COLUMNS / (2 * np.pi)) + 0.5).astype(int) % COLUMNS
        density = self.density[_slices(at), np.minimum(row, ROWS - 1), column]
        return np.where(z > 0, density, 0)


def _slices(at: Shading) -> NDArray[np.int64]:
    """Slice that the view of each point falls into, shape (p, 1)."""
    theta_o = np.arccos(np.clip(at.cos_o, 0, 1))[:, None]
    return np.minimum((theta_o * (SLICES / (np.pi / 2))).astype(int), SLICES - 1)


def _edges() -> Array:
    """Cosines of the polar angles between rows, from 1 to 0, shape (ROWS + 1,)."""
    return np.cos(np.arange(ROWS + 1) / ROWS * np.pi / 2)


def _solid_angle() -> Array:
    """Solid angle of a texel of each row in steradian, shape (ROWS,)."""
    return -np.diff(_edges()) * (2 * np.pi / COLUMNS)


def _slice(table: Table, theta_o: float) -> Array:
    """Probabilities of the texels for a view at an angle, shape (ROWS, COLUMNS), none of them 0."""
    theta = (np.arange(ROWS)[:, None] + 0.5) / ROWS * np.pi / 2
    phi = np.arange(COLUMNS) / COLUMNS * 2 * np.pi
    sine = np.sin(theta)
    parts = np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), np.cos(theta))
    light = np.stack(parts, axis=-1).reshape(-1, 3)
    view = np.broadcast_to([np.sin(theta_o), 0.0, np.cos(theta_o)], light.shape)
    white = np.broadcast_to((np.cos(theta) * _solid_angle()[:, None]), (ROWS, COLUMNS))
    reflected = (LUMINANCE @ table.lookup(light, view)).reshape(ROWS, COLUMNS) * white
    white = white / white.sum()
    if not reflected.any():
        return white
    return WHITE_SHARE * white + (1 - WHITE_SHARE) * reflected / reflected.sum()


def _cumulative(mass: Array) -> Array:
    """Cumulative distributions (n, m + 1), the k-th from k to k + 1, so that they ascend as one."""
    summed = np.cumsum(mass, axis=1)
    summed /= summed[:, -1:]
    start = np.zeros((len(mass), 1))
    return np.concatenate([start, summed], axis=1) + np.arange(len(mass))[:, None]


def _invert(cumulative: Array, which: NDArray[np.int64], u: Array) -> tuple[NDArray, Array]:
    """Interval of one of the distributions that holds `u`, and the place in it (0 to 1)."""
    width = cumulative.shape[1]
    value = np.minimum(which + u, np.nextafter(which + 1.0, 0))
    found = np.searchsorted(cumulative.ravel(), value.ravel(), side="right").reshape(u.shape) - 1
    low, high = cumulative.ravel()[found], cumulative.ravel()[found + 1]
    return found - which * width, (value - low) / (high - low)


def make(given: Given) -> PerViewSampling:
    """Follow the material."""
    assert given.table is not None, "the registry asks for what NEEDS names"
    return PerViewSampling(given.table)
