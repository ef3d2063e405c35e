"""A perspective camera on the z axis."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Camera:
    """A camera that looks along -z with x to the right and y up, through a square film.

    Parameters
    ----------
    distance : float
        Height above the origin along z, in scene units.
    field : float
        Full field of view, in radians.
    """

    distance: float
    field: float

    @property
    def position(self) -> NDArray[np.float64]:
        """Where the rays start, shape (3,)."""
        return np.array([0.0, 0.0, self.distance])

    def directions(self, pixels: NDArray, offsets: NDArray, resolution: int) -> NDArray:
        """Directions of rays through points of pixels.

        Parameters
        ----------
        pixels : ndarray of int, shape (n,)
            Pixel numbers, row by row from the upper left corner.
        offsets : ndarray, shape (k, 2) or (n, k, 2)
            Points inside each pixel, x to the right and y downwards, in [0, 1).
        resolution : int
            Pixels along one side of the film.

        Returns
        -------
        ndarray, shape (n, k, 3)
            Unit vectors away from the camera.
        """
        row, column = np.divmod(pixels, resolution)
        edge = np.tan(self.field / 2)
        x = edge * (2 * (column[:, None] + offsets[..., 0]) / resolution - 1)
        y = edge * (1 - 2 * (row[:, None] + offsets[..., 1]) / resolution)
        direction = np.stack([x, y, -np.ones(x.shape)], axis=-1)
        return direction / np.linalg.norm(direction, axis=-1, keepdims=True)


def lattice(along: int) -> NDArray[np.float64]:
    """Centres of `along`^2 equal squares, row by row, of the unit square around 0: (along^2, 2)."""
    steps = (np.arange(along) - (along - 1) / 2) / along
    return np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
