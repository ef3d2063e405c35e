"""Tables read between their cells, for formats that are linear between points."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, map_coordinates

from npfm.reflectance.angles import half_difference
from npfm.reflectance.half_difference import HALF_PI, HalfDifference
from npfm.reflectance.table import Table

Array = NDArray[np.float64]


class Interpolated:
    """A table on a half-difference grid, linear between the centres of its cells.

    Cells without a measurement take the value of the nearest that has one, so that values go on
    below the horizon.

    Parameters
    ----------
    table : Table
        With a measurement in each channel.
    """

    def __init__(self, table: Table[HalfDifference]):
        self.grid = table.grid
        values = np.stack([_filled(channel) for channel in table.values])
        # phi_d comes round: one more cell at either end.
        self.values = np.concatenate([values[..., -1:], values, values[..., :1]], axis=-1)

    def brdf(self, light: Array, view: Array) -> Array:
        """BRDF in 1/sr, shape (3,) + S, of unit vectors of shape S + (3,)."""
        angles = half_difference(light, view)
        h, d, p = self.grid.shape
        at_h = np.sqrt(angles[0] / HALF_PI) * h - 0.5
        places = np.stack([at_h, angles[1] / HALF_PI * d - 0.5, angles[2] / np.pi * p + 0.5])
        return np.stack(
            [map_coordinates(channel, places, order=1, mode="nearest") for channel in self.values]
        )


def _filled(channel: Array) -> Array:
    nearest = distance_transform_edt(channel < 0, return_distances=False, return_indices=True)
    return channel[tuple(nearest)]
