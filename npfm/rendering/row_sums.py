"""Rows of a transport matrix from what falls into them, compiled.

Entries of a row are sorted by column digit by digit, which takes a few passes over as many
entries as a pixel has, instead of one comparison sort of all that is treated at once.
"""

import numpy as np
from numba import types
from numpy.typing import NDArray

from npfm.compilation import ARITHMETIC, compiled, inner

Array = NDArray[np.float64]
Indices = NDArray[np.int32]
Counts = NDArray[np.int64]

#: Digits that columns are sorted by have at most this many bits.
DIGIT = 11

_f1, _f2 = (types.Array(types.float64, n, "C") for n in (1, 2))
_i1, _i2 = (types.Array(types.int32, n, "C") for n in (1, 2))
_n1, _s2 = types.Array(types.int64, 1, "C"), types.Array(types.float32, 2, "A")


@inner
def _sort(
    keys: Indices, order: Counts, spare_keys: Indices, spare_order: Counts, bits: int
) -> tuple[Indices, Counts]:
    """Sort keys below 2^bits, and their order with them, digit by digit; the sorted pair."""
    digits = -(-bits // DIGIT)
    width = -(-bits // digits)
    counts = np.empty(1 << width, np.int64)
    for digit in range(digits):
        counts[:] = 0
        for key in keys:
            counts[(key >> (digit * width)) & ((1 << width) - 1)] += 1
        total = 0
        for value in range(len(counts)):
            counts[value], total = total, total + counts[value]
        for s in range(len(keys)):
            value = (keys[s] >> (digit * width)) & ((1 << width) - 1)
            spare_keys[counts[value]], spare_order[counts[value]] = keys[s], order[s]
            counts[value] += 1
        keys, order, spare_keys, spare_order = spare_keys, spare_order, keys, order
    return keys, order


@compiled(types.Tuple([_n1, _i1, _s2])(_n1, _i2, _f2, _i1, _f1, _f2, types.int64), **ARITHMETIC)
def row_sums(
    ends: Counts,
    column: Indices,
    share: Array,
    texel: Indices,
    weight: Array,
    radiance: Array,
    bits: int,
) -> tuple[Counts, Indices, NDArray[np.float32]]:
    """Sums of weights by column, for each of several rows of the matrix.

    Parameters
    ----------
    ends : ndarray of int64, shape (rows,)
        Where the directions of each row end; they begin where those of the row before end.
    column : ndarray of int32, shape (n, k)
        Columns that each direction falls into.
    share : ndarray, shape (n, k) or (0, 0)
        Its share in each of them; all of it, if none are given.
    texel : ndarray of int32, shape (n,)
        Texel of the light that it points into.
    weight : ndarray, shape (n,)
        By which the light is multiplied.
    radiance : ndarray, shape (texels, 3)
        Of the light.
    bits : int
        That a column has at most.

    Returns
    -------
    entries : ndarray of int64, shape (rows,)
        Number of columns of each row that have a sum.
    columns : ndarray of int32, shape (m,)
        These, ascending in each row.
    sums : ndarray of float32, shape (3, m)
    """
    taps = column.shape[1]
    found, columns = 0, np.empty(column.size, np.int32)
    sums, entries = np.empty((3, column.size), np.float32), np.zeros(len(ends), np.int64)
    begin = 0
    for row in range(len(ends)):
        keys = column[begin : ends[row]].copy().reshape(-1)
        order = np.arange(begin * taps, ends[row] * taps)
        keys, order = _sort(keys, order, np.empty_like(keys), np.empty_like(order), bits)
        before, red, green, blue = found, 0.0, 0.0, 0.0
        for s in range(len(keys)):
            at = order[s] // taps
            value = weight[at] * (share[at, order[s] % taps] if share.size else 1.0)
            red += value * radiance[texel[at], 0]
            green += value * radiance[texel[at], 1]
            blue += value * radiance[texel[at], 2]
            if s + 1 == len(keys) or keys[s + 1] != keys[s]:
                columns[found] = keys[s]
                sums[0, found], sums[1, found], sums[2, found] = red, green, blue
                found, red, green, blue = found + 1, 0.0, 0.0, 0.0
        entries[row] = found - before
        begin = ends[row]
    return entries, columns[:found], sums[:, :found]
