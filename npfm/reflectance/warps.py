"""Functions on the unit square that are linear between nodes, and between measured directions.

The building blocks of the parameterisation of Dupuy and Jakob 2018, "An adaptive parameterization
for efficient material acquisition and rendering": a density whose cumulative sums map the square
to itself, and values that are told on the square that comes out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True)
class Mix:
    """Slices that queries fall between, and how much each has in the value.

    Parameters
    ----------
    index : ndarray of int, shape (k, n)
        Of the slice.
    share : ndarray, shape (k, n)
        At least 0, with sum 1.
    """

    index: Index
    share: Array

    def of(self, values: Array, *at: Index) -> Array:
        """Values ``values[slice, *at]`` of n queries, mixed: shape (n,)."""
        return (self.share * values[(self.index, *at)]).sum(axis=0)


def between(nodes: Array, places: Array) -> Mix:
    """Neighbours of places among ascending nodes; beyond the ends, the end."""
    if len(nodes) == 1:
        zero = np.zeros((1, len(places)))
        return Mix(zero.astype(np.intp), zero + 1)
    low = np.clip(np.searchsorted(nodes, places, side="right") - 1, 0, len(nodes) - 2)
    share = np.clip((places - nodes[low]) / (nodes[low + 1] - nodes[low]), 0, 1)
    return Mix(np.stack([low, low + 1]), np.stack([1 - share, share]))


def both(first: Mix, second: Mix, count: int) -> Mix:
    """Mix of slices by two parameters, of which the second has `count` nodes."""
    index = first.index[:, None] * count + second.index
    share = first.share[:, None] * second.share
    return Mix(index.reshape(-1, index.shape[-1]), share.reshape(-1, index.shape[-1]))


def patch(places: Array, count: int) -> tuple[Index, Array]:
    """Node before places in [0, 1] among `count` evenly spaced ones, and the way to the next."""
    scaled = np.clip(places, 0, 1) * (count - 1)
    low = np.minimum(scaled.astype(np.intp), count - 2)
    return low, scaled - low


def bilinear(values: Array, mix: Mix, x: Array, y: Array) -> Array:
    """Values (slices, rows, columns) at x and y in [0, 1], linear in all that they depend on."""
    (row, down), (column, right) = patch(y, values.shape[1]), patch(x, values.shape[2])
    upper = (1 - right) * mix.of(values, row, column) + right * mix.of(values, row, column + 1)
    lower = (1 - right) * mix.of(values, row + 1, column) + right * mix.of(
        values, row + 1, column + 1
    )
    return (1 - down) * upper + down * lower


@dataclass(frozen=True)
class Warp:
    """Densities on the unit square, as maps of the square to itself.

    Parameters
    ----------
    density : ndarray, shape (slices, rows, columns)
        Bilinear between nodes; each slice is normalised so that its patches sum to 1.
    along : ndarray, the same shape
        Integrals of each row up to each node.
    down : ndarray, shape (slices, rows)
        Integrals of the rows up to each one.
    """

    density: Array
    along: Array
    down: Array

    @classmethod
    def of(cls, values: Array) -> "Warp":
        """Warp of densities that are not normalised; each slice has some that is above 0."""
        along = _summed(values, axis=2)
        down = _summed(along[:, :, -1], axis=1)
        total = down[:, -1, None]
        return cls(values / total[..., None], along / total[..., None], down / total)

    def inverse(self, mix: Mix, x: Array, y: Array) -> tuple[Array, Array]:
        """Where x and y in [0, 1] come from, or NaN where a whole row has no density.

        Slices are mixed before they are inverted, as Mitsuba 3 does.
        """
        (_, rows, columns) = self.density.shape
        (row, fall), (column, way) = patch(y, rows), patch(x, columns)

        def mixed(values: Array, right: int) -> Array:
            """Values of a column of nodes at the height in question."""
            upper, lower = (mix.of(values, row + k, column + right) for k in (0, 1))
            return (1 - fall) * upper + fall * lower

        first, second = (mixed(self.density, k) for k in (0, 1))
        reached = mixed(self.along, 0) + way * (first + way / 2 * (second - first))
        last = np.full_like(column, columns - 1)
        upper, lower = (mix.of(self.along, row + k, last) for k in (0, 1))
        with np.errstate(invalid="ignore"):
            from_x = reached / ((1 - fall) * upper + fall * lower)
        return from_x, mix.of(self.down, row) + fall * (upper + fall / 2 * (lower - upper))


def _summed(values: Array, axis: int) -> Array:
    """Integrals up to each node by the trapezoidal rule, a step being 1; 0 at the first."""
    pairs = np.swapaxes(values, axis, -1)
    steps = np.cumsum((pairs[..., 1:] + pairs[..., :-1]) / 2, axis=-1)
    whole = np.concatenate([np.zeros((*steps.shape[:-1], 1)), steps], axis=-1)
    return np.swapaxes(whole, axis, -1)


def forward(density: Array, count: int) -> tuple[Array, Array]:
    """Where the nodes of an even grid over the square are taken by a density, unlike `inverse`.

    Parameters
    ----------
    density : ndarray, shape (rows, columns)
        Bilinear between nodes, not normalised, somewhere above 0 in each row.
    count : int
        Nodes of the even grid along x and along y.

    Returns
    -------
    places : ndarray, shape (count, count, 2)
        x and y of the nodes, by y and x of the grid.
    found : ndarray, shape (count, count)
        The density there, of integral 1 over the square.
    """
    even = np.linspace(0, 1, count)
    along = _summed(density, axis=1)
    down = _summed(along[:, -1], axis=0)
    row, fall = _reached(down, along[:, -1], even * down[-1])
    places, found = np.empty((count, count, 2)), np.empty((count, count))
    patches = np.array(density.shape) - 1
    for k, (upper, t) in enumerate(zip(row, fall, strict=True)):
        values = (1 - t) * density[upper] + t * density[upper + 1]
        sums = (1 - t) * along[upper] + t * along[upper + 1]
        column, way = _reached(sums, values, even * sums[-1])
        places[k, :, 0] = (column + way) / patches[1]
        places[k, :, 1] = (upper + t) / patches[0]
        found[k] = (1 - way) * values[column] + way * values[column + 1]
    return places, found * patches.prod() / down[-1]


def _reached(sums: Array, values: Array, wanted: Array) -> tuple[Index, Array]:
    """Where integrals are what is wanted: the node before, and the way to the next."""
    node = np.clip(np.searchsorted(sums, wanted) - 1, 0, len(values) - 2)
    begin, end = values[node], values[node + 1]
    rest = np.maximum(wanted - sums[node], 0)
    # The root of begin t + (end - begin) t^2 / 2 = rest, in a form that end = begin does not break.
    slope = begin + np.sqrt(np.maximum(begin**2 + 2 * (end - begin) * rest, 0))
    way = np.divide(2 * rest, slope, out=np.zeros_like(rest), where=slope > 0)
    return node, np.clip(way, 0, 1)
