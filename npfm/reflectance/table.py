"""Reflectance as a table on a grid."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.half_difference import MERL, Grid

CHANNELS = ("red", "green", "blue")
#: What stands in a cell that was not measured; any negative value means the same.
INVALID = -1.0


@dataclass(frozen=True)
class Table:
    """A BRDF in 1/sr on a grid; negative where there is no measurement.

    Parameters
    ----------
    values : ndarray, shape (3,) + grid.shape
        BRDF in 1/sr for red, green and blue.
    grid : Grid
        The grid whose cell centres the values belong to.
    """

    values: NDArray[np.float64]
    grid: Grid = MERL

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Where there is a measurement, shape (3,) + grid.shape."""
        return self.values >= 0
