"""Directions distributed as the light is."""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "light"

Array = NDArray[np.float64]


class LightSampling:
    """Directions distributed as the luminance of an environment is, whatever the surface."""

    def __init__(self, environment: Environment):
        self.environment = environment

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        return self.environment.sample(u.reshape(-1, 2)).reshape(*u.shape[:2], 3)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        return self.environment.pdf(light)


def make(given: Given) -> LightSampling:
    """Follow the light."""
    return LightSampling(given.environment)
