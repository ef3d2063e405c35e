"""Reflectance as a table on a grid."""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.grids import Grid, local_cells
from npfm.reflectance.half_difference import MERL

CHANNELS = ("red", "green", "blue")
#: What stands in a cell that was not measured; any negative value means the same.
INVALID = -1.0


G = TypeVar("G", bound=Grid)


@dataclass(frozen=True)
class Table(Generic[G]):
    """A BRDF in 1/sr on a grid; negative where there is no measurement.

    Parameters
    ----------
    values : ndarray, shape (3,) + grid.shape
        BRDF in 1/sr for red, green and blue.
    grid : Grid
        The grid whose cell centres the values belong to.
    """

    values: NDArray[np.float64]
    grid: G = MERL  # type: ignore[assignment]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Where there is a measurement, shape (3,) + grid.shape."""
        return self.values >= 0

    def lookup(self, light: NDArray, view: NDArray) -> NDArray[np.float64]:
        """BRDF in 1/sr for pairs of directions over a surface with normal z and tangent x.

        Parameters
        ----------
        light, view : ndarray, shape (n, 3)
            Unit vectors above the horizon.

        Returns
        -------
        ndarray, shape (3, n)
            Where there is no measurement, 0.
        """
        index, share = local_cells(self.grid, light, view)
        values = np.maximum(self.values.reshape(3, -1)[:, index], 0)
        return values if share is None else np.maximum((values * share).sum(axis=-1), 0)

    def where_measured(self, measured: "Table") -> "Table":
        """Return it with `INVALID` in all cells where another table has no measurement.

        Raises
        ------
        NpfmError
            If they are on different grids.
        """
        if measured.grid != self.grid:
            raise NpfmError(
                f"a fit on the grid {self.grid.name}, and a measurement on {measured.grid.name}; "
                "give the table that the fit was made from"
            )
        return Table(np.where(measured.valid, self.values, INVALID), self.grid)
