"""Under what angles a scene is seen, pixel by pixel."""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.surfaces import look

#: Angle where nothing is seen, in degrees: no surface is seen under a greater one.
NOTHING = 90.0


def view_angles(scene: Scene, resolution: int) -> NDArray[np.float64]:
    """Angles between the shading normals and the viewer.

    Parameters
    ----------
    scene : Scene
    resolution : int
        Pixels along one side of the square picture.

    Returns
    -------
    ndarray, shape (resolution, resolution)
        Degrees, the mean over the camera rays of a pixel that meet an object; `NOTHING` where none
        does.

    Raises
    ------
    NpfmError
        If the mesh of the scene cannot be used.
    """
    anything = Environment(np.ones((1, 2, 3)))
    surface, _, _ = look(CAMERA, place(scene), anything, camera_offsets(scene), resolution)
    cosine = np.einsum("ij,ij->i", surface.normal, surface.view)
    angle = np.degrees(np.arccos(np.clip(cosine, 0.0, 1.0)))
    pixels = resolution**2
    rays = np.bincount(surface.pixel, minlength=pixels)
    total = np.bincount(surface.pixel, angle, minlength=pixels)
    mean = np.where(rays > 0, total / np.maximum(rays, 1), NOTHING)
    return mean.reshape(resolution, resolution)
