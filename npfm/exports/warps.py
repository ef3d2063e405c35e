"""Warps of the unit square by densities that are linear between points of a grid.

As Mitsuba's `Marginal2D` and pbrt's `PiecewiseLinear2D` warp: first the row, by the sums of rows,
then the place in the row, by the row that is linear between its two neighbours.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def warped(density: Array, count: int) -> tuple[Array, Array]:
    """Where the points of an even grid over the unit square are taken by a density.

    Parameters
    ----------
    density : ndarray, shape (h, w)
        At an even grid from edge to edge, y before x, not negative, somewhere positive in each row.
    count : int
        Points of the even grid along x and along y, from edge to edge.

    Returns
    -------
    places : ndarray, shape (count, count, 2)
        x and y of the points, by y and x of the grid.
    found : ndarray, shape (count, count)
        The density there, of integral 1.
    """
    even = np.linspace(0, 1, count)
    inside = _sums(density)
    rows = _sums(inside[:, -1])
    row, down = _inverse(rows, inside[:, -1], even * rows[-1])
    places, found = np.empty((count, count, 2)), np.empty((count, count))
    for k, (upper, t) in enumerate(zip(row, down, strict=True)):
        line = (1 - t) * density[upper] + t * density[upper + 1]
        sums = (1 - t) * inside[upper] + t * inside[upper + 1]
        column, across = _inverse(sums, line, even * sums[-1])
        places[k, :, 0] = (column + across) / (density.shape[1] - 1)
        places[k, :, 1] = (upper + t) / (density.shape[0] - 1)
        found[k] = (1 - across) * line[column] + across * line[column + 1]
    return places, found / rows[-1]


def _sums(values: Array) -> Array:
    """Integrals from 0 to each point of values that are linear between points, along the last axis.

    The interval is from 0 to 1.
    """
    steps = (values[..., 1:] + values[..., :-1]) / (2 * (values.shape[-1] - 1))
    return np.concatenate([np.zeros_like(values[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)


def _inverse(sums: Array, values: Array, wanted: Array) -> tuple[NDArray[np.intp], Array]:
    """Where integrals are what is wanted: the segment, and how far on the way through it."""
    segment = np.clip(np.searchsorted(sums, wanted) - 1, 0, len(values) - 2)
    begin, end = values[segment], values[segment + 1]
    rest = np.maximum(wanted - sums[segment], 0) * (len(values) - 1)
    # The root of begin t + (end - begin) t^2 / 2 = rest, in a form that end = begin does not break.
    slope = begin + np.sqrt(np.maximum(begin**2 + 2 * (end - begin) * rest, 0))
    way = np.divide(2 * rest, slope, out=np.zeros_like(rest), where=slope > 0)
    return segment, np.clip(way, 0, 1)
