"""Tables of reflectance, looked up by Mitsuba."""

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from npfm.errors import NpfmError
from npfm.exports.mitsuba.angles import elevation
from npfm.exports.mitsuba.arrays import bin_of, buffer, take
from npfm.reflectance.half_difference import HALF_PI, HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import LUMINANCE


class Reflectance:
    """A table that is read cell by cell, without interpolation, as T is built.

    Parameters
    ----------
    table : Table
        BRDF in 1/sr; negative entries reflect nothing.

    Raises
    ------
    NpfmError
        If the table is on a grid that has no half and difference angles.
    """

    def __init__(self, table: Table):
        grid = table.grid
        if not isinstance(grid, HalfDifference):
            raise NpfmError(f"Mitsuba renders tables on half-difference grids, not on {grid.name}")
        values = np.maximum(table.values, 0).reshape(3, -1)
        channels = LUMINANCE[None] @ values if mi.is_monochromatic else values
        self.shape = grid.shape
        self.channels = [buffer(channel) for channel in channels]

    def brdf(self, view: Any, light: Any) -> Any:
        """BRDF in 1/sr of directions above the horizon, over a surface with the normal z."""
        cell = self._cell(view, light)
        return mi.Color3f(*(take(channel, cell) for channel in self.channels))

    def _cell(self, view: Any, light: Any) -> Any:
        """Cell that holds a pair of directions, in a form that float32 is enough for.

        Angles whose cosines are nearly 1 come from their sines, unlike in `HalfDifference.cells`.
        """
        half, difference = view + light, light - view
        length = dr.norm(half)
        theta_h = elevation(half)
        theta_d = dr.atan2(dr.norm(difference), length)
        volume = view.x * light.y - view.y * light.x
        phi_d = dr.atan2(2 * volume, -length * difference.z)
        phi_d = dr.select(phi_d < 0, phi_d + dr.pi, phi_d)
        h, d, p = self.shape
        row = bin_of(dr.sqrt(theta_h / HALF_PI), h) * d + bin_of(theta_d / HALF_PI, d)
        return row * p + bin_of(phi_d / dr.pi, p)
