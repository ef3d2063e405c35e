"""Directions distributed as what a diffuse surface reflects of even light."""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "cosine"

Array = NDArray[np.float64]


class CosineSampling:
    """Directions with a density in proportion to the cosine with the normal."""

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        return at.directions(np.sqrt(1 - u[..., 0]), 2 * np.pi * u[..., 1])

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        return np.maximum(at.cosines(light), 0) / np.pi


def make(given: Given) -> CosineSampling:
    """Follow the cosine: nothing is needed for it."""
    return CosineSampling()
