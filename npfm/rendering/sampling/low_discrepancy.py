"""Evenly spread points of the unit square."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@cache
def low_discrepancy(count: int) -> Array:
    """First points of the two-dimensional Sobol sequence, shape (count, 2).

    In the order of Gray codes (Antonov and Saleev 1979), with the direction numbers of Joe and Kuo
    2008: the points of `scipy.stats.qmc.Sobol`, which takes half a second to import.
    """
    bits = max(count - 1, 1).bit_length()
    place = np.arange(count)
    gray = place ^ (place >> 1)
    points, odd = np.zeros((count, 2), dtype=np.int64), 1
    for k in range(bits):
        on = (gray >> k) & 1
        points[:, 0] ^= on << (bits - 1 - k)
        points[:, 1] ^= on * (odd << (bits - 1 - k))
        odd ^= odd << 1  # of the polynomial x + 1
    return points / 2.0**bits


def rotate(points: Array, shift: Array) -> Array:
    """Cranley-Patterson rotation: `points` (..., 2) moved by `shift` on the torus."""
    return (points + shift) % 1.0
