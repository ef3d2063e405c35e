"""The light that is seen past objects, averaged over what each camera ray stands for."""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.camera import Camera, lattice
from npfm.rendering.lights.environment import BLOCK, Environment

#: Points that the light is averaged over lie at most this part of a texel apart.
SPACING = 0.25


def seen(
    camera: Camera,
    environment: Environment,
    offsets: NDArray,
    resolution: int,
    rays: NDArray[np.integer],
) -> NDArray[np.float64]:
    """Mean light over the squares that camera rays stand for.

    The rays of a pixel share it evenly, each a square around its point. Between the centres of
    texels, which may be larger than pixels, light is interpolated.

    Parameters
    ----------
    camera : Camera
    environment : Environment
    offsets : ndarray, shape (k, 2)
        Where camera rays pass through a pixel, in [0, 1).
    resolution : int
        Pixels along one side of the square picture.
    rays : ndarray of int, shape (n,)
        The rays that are asked about, counted pixel by pixel in the order of `offsets`.

    Returns
    -------
    ndarray, shape (n, 3)
        Linear RGB radiance.
    """
    side = 1 / np.sqrt(len(offsets))
    points = side * lattice(_along(camera, environment, resolution / side))
    light = np.empty((len(rays), 3))
    step = max(1, BLOCK // len(points))
    for first in range(0, len(rays), step):
        pixel, ray = np.divmod(rays[first : first + step], len(offsets))
        direction = camera.directions(pixel, offsets[ray, None] + points, resolution)
        light[first : first + step] = environment.interpolated(direction).mean(axis=1)
    return light


def _along(camera: Camera, environment: Environment, squares: float) -> int:
    """Points along one side of a square, of which there are so many along the film."""
    widest = 2 * np.tan(camera.field / 2) / squares
    texel = np.pi / len(environment.radiance)
    return int(np.ceil(widest / (SPACING * texel)))
