"""Evenly spread points of the unit square."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@cache
def low_discrepancy(count: int) -> Array:
    """First points of the two-dimensional Sobol sequence, shape (count, 2)."""
    # scipy.stats alone takes half a second to import.
    from scipy.stats import qmc

    power = max(count - 1, 0).bit_length()
    return qmc.Sobol(2, scramble=False).random_base2(power)[:count]


def rotate(points: Array, shift: Array) -> Array:
    """Cranley-Patterson rotation: `points` (..., 2) moved by `shift` on the torus."""
    return (points + shift) % 1.0
