"""Distant light as a latitude-longitude map: look-up, and sampling by its distribution.

The world is right-handed, y is up, and the camera looks along -z with x to its right. Row 0 of a
map is straight up (+y) and rows are uniform in the polar angle theta from +y. Columns are uniform
in azimuth; the centre of a row looks along -z, and azimuth grows to the right, so that +x lies a
quarter of the width right of the centre. Radiance is constant over a texel, which makes sampling
in proportion to luminance exact.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.pictures import read_exr, write_exr

#: Luminance of linear RGB with the primaries of ITU-R BT.709-6, item 3.2.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: How many directions are evaluated at a time; bounds the memory to tens of MB.
BLOCK = 1 << 17


@dataclass(frozen=True)
class Environment:
    """Radiance that arrives from every direction.

    Parameters
    ----------
    radiance : ndarray, shape (rows, columns, 3)
        Linear RGB radiance of the texels, finite, not negative, not all black.

    Raises
    ------
    ValueError
        If the radiance is of another shape or has values that no light has.
    """

    radiance: NDArray[np.floating]

    def __post_init__(self) -> None:
        shape = self.radiance.shape
        if len(shape) != 3 or shape[2] != 3:
            raise ValueError(f"radiance must be of shape (rows, columns, 3), not {shape}")
        if wrong := np.count_nonzero(~np.isfinite(self.radiance)):
            raise ValueError(f"{wrong} values are NaN or infinite")
        if (least := self.radiance.min()) < 0:
            raise ValueError(f"the smallest value is {least:g}; radiance cannot be negative")
        if not self.radiance.any():
            raise ValueError("every texel is black")

    @cached_property
    def solid_angle(self) -> NDArray[np.float64]:
        """Solid angle of a texel of each row in steradian, shape (rows,)."""
        columns = self.radiance.shape[1]
        return -np.diff(self.heights) * (2 * np.pi / columns)

    @cached_property
    def density(self) -> NDArray[np.float64]:
        """Probability density of `sample` over each texel in 1/sr, shape (rows * columns,)."""
        luminance = self.radiance @ LUMINANCE
        return (luminance / (self.solid_angle @ luminance.sum(axis=1))).ravel()

    @cached_property
    def heights(self) -> NDArray[np.float64]:
        """Cosines of the polar angles between rows, from +1 to -1, shape (rows + 1,)."""
        return _cosines(len(self.radiance))

    @cached_property
    def cumulative(self) -> NDArray[np.float64]:
        """Probability that the sampled texel comes before texel k, shape (texels + 1,)."""
        columns = self.radiance.shape[1]
        cumulative = np.cumsum(self.density * np.repeat(self.solid_angle, columns))
        return np.concatenate([[0.0], cumulative])

    @cached_property
    def texels(self) -> NDArray[np.float64]:
        """Radiance of the texels, row by row, shape (rows * columns, 3)."""
        return np.ascontiguousarray(self.radiance, dtype=float).reshape(-1, 3)

    def texel(self, direction: NDArray) -> NDArray[np.intp]:
        """Flat index of the texel that each unit vector points into.

        Parameters
        ----------
        direction : ndarray, shape (..., 3)
            Unit vectors.

        Returns
        -------
        ndarray of int, shape (...)
            Index into `density`, row by row.
        """
        rows, columns, _ = self.radiance.shape
        row, column = (place.astype(np.intp) for place in self._place(direction))
        # An azimuth of +pi is that of -pi; straight down belongs to the last row.
        column = np.where(column == columns, 0, column)
        return np.minimum(row, rows - 1) * columns + column

    def lookup(self, direction: NDArray) -> NDArray[np.floating]:
        """Radiance from the given directions.

        Parameters
        ----------
        direction : ndarray, shape (..., 3)
            Unit vectors pointing towards the light.

        Returns
        -------
        ndarray, shape (..., 3)
            Linear RGB radiance.
        """
        return self.texels[self.texel(direction)]

    def interpolated(self, direction: NDArray) -> NDArray[np.float64]:
        """Radiance from the given directions, bilinear between the centres of texels.

        For light that is seen, whose texels are larger than pixels; objects are lit by `lookup`.
        Azimuth goes round; beyond the centres of the first and the last row their values stay.

        Parameters
        ----------
        direction : ndarray, shape (..., 3)
            Unit vectors pointing towards the light.

        Returns
        -------
        ndarray, shape (..., 3)
            Linear RGB radiance.
        """
        rows, columns, _ = self.radiance.shape
        # Centres of texels are half a texel from their edges.
        down, right = (place - 0.5 for place in self._place(direction))
        row, column = np.floor(down).astype(np.intp), np.floor(right).astype(np.intp)
        result = np.zeros(np.shape(direction))
        for k, below in enumerate((1 - (down - row), down - row)):
            first = np.clip(row + k, 0, rows - 1) * columns
            for j, share in enumerate((1 - (right - column), right - column)):
                result += (below * share)[..., None] * self.texels[first + (column + j) % columns]
        return result

    def _place(self, direction: NDArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return how many rows down and columns to the right directions are, in texels."""
        rows, columns, _ = self.radiance.shape
        x, y, z = np.moveaxis(np.asarray(direction, dtype=float), -1, 0)
        down = np.arccos(np.clip(y, -1.0, 1.0)) * (rows / np.pi)
        return down, (np.arctan2(x, -z) + np.pi) * (columns / (2 * np.pi))

    def pdf(self, direction: NDArray) -> NDArray[np.float64]:
        """Probability density with which `sample` draws the given directions.

        Parameters
        ----------
        direction : ndarray, shape (..., 3)
            Unit vectors.

        Returns
        -------
        ndarray, shape (...)
            Density over solid angle in 1/sr.
        """
        return self.density[self.texel(direction)]

    def sample(self, u: NDArray) -> NDArray[np.float64]:
        """Directions distributed as luminance times solid angle.

        The first number picks the row and the place in it, the second the column, each by a
        monotone map, so that points that are well spread in the square stay well spread.

        Parameters
        ----------
        u : ndarray, shape (n, 2)
            Points in the unit square; searching is twice as fast where the first number ascends.

        Returns
        -------
        ndarray, shape (n, 3)
            Unit vectors pointing towards the light.
        """
        columns = self.radiance.shape[1]
        cumulative = self.cumulative
        row_starts = np.ascontiguousarray(cumulative[::columns])
        row, down = _invert(row_starts, u[:, 0])
        start = row_starts[row]
        texel, across = _invert(cumulative, start + u[:, 1] * (row_starts[row + 1] - start))
        row, column = np.divmod(texel, columns)
        edges = self.heights
        y = edges[row] + down * (edges[row + 1] - edges[row])
        radius = np.sqrt((1 - y) * (1 + y))
        azimuth = (column + across) * (2 * np.pi / columns) - np.pi
        return np.stack([radius * np.sin(azimuth), y, -radius * np.cos(azimuth)], axis=-1)


def _invert(cumulative: NDArray, value: NDArray) -> tuple[NDArray[np.intp], NDArray]:
    """Interval of a cumulative distribution that holds `value`, and the place in it (0 to 1)."""
    # Below the total, so that the interval found always has a width.
    value = np.minimum(value, np.nextafter(cumulative[-1], 0.0))
    interval = np.searchsorted(cumulative, value, side="right") - 1
    low = cumulative[interval]
    return interval, (value - low) / (cumulative[interval + 1] - low)


def _cosines(rows: int) -> NDArray[np.float64]:
    """Cosines of the polar angles between rows, from +1 to -1, shape (rows + 1,)."""
    # sin(pi/2 - theta) is exactly 1, 0 and -1 at the poles and the horizon.
    return np.sin(np.pi / 2 - np.arange(rows + 1) * (np.pi / rows))


def turned(environment: Environment, degrees: float) -> Environment:
    """Turn a light about the vertical: what stood before the camera moves to its right.

    Parameters
    ----------
    environment : Environment
    degrees : float
        Clockwise as seen from above, the way in which azimuth grows.

    Returns
    -------
    Environment
        The same light if a turn is whole texels; otherwise each texel is the mean of what it
        covers of two, so that no row gains or loses radiance.
    """
    texels = degrees / 360 * environment.radiance.shape[1]
    whole = math.floor(texels)
    moved = np.roll(environment.radiance, whole, axis=1)
    share = texels - whole
    return Environment((1 - share) * moved + share * np.roll(moved, 1, axis=1))


def tabulate(
    radiance: Callable[[NDArray], NDArray], height: int, subsamples: int
) -> NDArray[np.float64]:
    """Average a function of direction over the texels of a map.

    Parameters
    ----------
    radiance : callable
        Maps unit vectors of shape (n, 3) to linear RGB radiance of shape (n, 3).
    height : int
        Rows of the map; it has twice as many columns.
    subsamples : int
        Each texel is the mean over subsamples x subsamples directions, weighted by solid angle.

    Returns
    -------
    ndarray, shape (height, 2 * height, 3)
        Mean radiance of each texel.
    """
    fine_rows, fine_columns = height * subsamples, 2 * height * subsamples
    weight = -np.diff(_cosines(fine_rows)).reshape(height, subsamples)
    weight /= subsamples * weight.sum(axis=1, keepdims=True)
    azimuth = (np.arange(fine_columns) + 0.5) * (2 * np.pi / fine_columns) - np.pi
    step = max(1, BLOCK // (fine_columns * subsamples))
    result = np.empty((height, 2 * height, 3))
    for first in range(0, height, step):
        block = slice(first, min(first + step, height))
        theta = (np.arange(block.start * subsamples, block.stop * subsamples) + 0.5) * (
            np.pi / fine_rows
        )
        fine = radiance(_directions(theta, azimuth))
        fine = fine.reshape(-1, subsamples, 2 * height, subsamples, 3)
        result[block] = np.einsum("rsctk,rs->rck", fine, weight[block])
    return result


def _directions(theta: NDArray, azimuth: NDArray) -> NDArray[np.float64]:
    """Unit vectors of all pairs of a polar angle and an azimuth, row by row, shape (n, 3)."""
    direction = np.empty((len(theta), len(azimuth), 3))
    direction[..., 0] = np.outer(np.sin(theta), np.sin(azimuth))
    direction[..., 1] = np.cos(theta)[:, None]
    direction[..., 2] = np.outer(np.sin(theta), -np.cos(azimuth))
    return direction.reshape(-1, 3)


def read(path: str | Path) -> Environment:
    """Read a latitude-longitude map from an OpenEXR file.

    Raises
    ------
    NpfmError
        If the file is not an RGB OpenEXR file or its values are not those of a light.
    """
    pixels = read_exr(path)
    if pixels.shape[1] != 2 * pixels.shape[0]:
        rows, columns = pixels.shape[:2]
        raise NpfmError(
            f"{path}: {columns} x {rows} pixels; a lat-long map is twice as wide as high"
        )
    try:
        return Environment(pixels[..., :3].astype(np.float64))
    except ValueError as error:
        raise NpfmError(f"{path}: {error}; repair the light or give another") from None


def write(path: str | Path, environment: Environment) -> None:
    """Write a latitude-longitude map as an OpenEXR file with float32 channels."""
    write_exr(path, environment.radiance)
