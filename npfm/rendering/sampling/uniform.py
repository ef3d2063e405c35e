"""Directions spread evenly over the hemisphere."""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "uniform"

Array = NDArray[np.float64]


class UniformSampling:
    """Directions with the same density everywhere above the horizon."""

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        return at.directions(1 - u[..., 0], 2 * np.pi * u[..., 1])

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        return np.where(at.cosines(light) > 0, 1 / (2 * np.pi), 0)


def make(given: Given) -> UniformSampling:
    """Need nothing."""
    return UniformSampling()
