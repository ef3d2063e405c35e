"""Effects: what a scene asks for by name beyond unshadowed light at the centres of pixels.

A scene pays for no effect that it does not list. Most are steps of building a transport matrix and
change one of the things that a scene without effects is made of: where camera rays pass through a
pixel, or which light reaches a point. Light that bounces is no matrix, for it is not linear in the
BRDF: it is rendered beside the matrix, for one material at a time, and added to its picture.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest
from npfm.rendering.camera import lattice
from npfm.rendering.geometry import OFFSET, Shape

#: Camera rays along either side of a pixel: 16 in all, as in Bagher et al. 2016, section 6.
SUBPIXELS = 4


def subdivide(offsets: NDArray) -> NDArray:
    """Replace each point of a pixel by a lattice around it.

    Parameters
    ----------
    offsets : ndarray, shape (k, 2)
        Where camera rays pass through a pixel, in [0, 1).

    Returns
    -------
    ndarray, shape (SUBPIXELS^2 k, 2)
        For the centre of the pixel, the centres of `SUBPIXELS`^2 equal squares.
    """
    return (lattice(SUBPIXELS)[:, None] + offsets).reshape(-1, 2)


def unshadowed(
    objects: Sequence[Shape], points: NDArray, normals: NDArray, lights: NDArray
) -> NDArray[np.bool_]:
    """Cast shadow rays from surface points towards the light.

    Parameters
    ----------
    objects : sequence of Shape
    points, normals, lights : ndarray, shape (n, 3)
        Surface points, the unit normals of the surface itself, unit directions of the light.

    Returns
    -------
    ndarray of bool, shape (n,)
        Whether no object is in the way.
    """
    origins = points + OFFSET * normals
    free = np.ones(len(points), dtype=bool)
    for shape in objects:
        free[free] = ~shape.occluded(origins[free], lights[free])
    return free


@dataclass(frozen=True)
class Effect:
    """A step of building T, or what is added to pictures.

    Parameters
    ----------
    film : callable, optional
        Maps the points of a pixel that camera rays pass through to those that they pass through
        with the effect, like `subdivide`.
    reaches : callable, optional
        Tells which light reaches which surface point, like `unshadowed`.
    bounces : bool
        Whether it is light that objects reflect onto each other, which T knows nothing of.
    """

    film: Callable[[NDArray], NDArray] | None = None
    reaches: Callable[[Sequence[Shape], NDArray, NDArray, NDArray], NDArray] | None = None
    bounces: bool = False


EFFECTS = {
    "antialiasing": Effect(film=subdivide),
    "visibility": Effect(reaches=unshadowed),
    "interreflection": Effect(bounces=True),
}


def check_effects(names: Sequence[str]) -> None:
    """Raise an NpfmError if a name is not that of an effect, or is listed twice."""
    for name in names:
        if name not in EFFECTS:
            raise NpfmError(f"unknown effect '{name}' in a scene; {suggest(name, EFFECTS)}")
    if len(set(names)) < len(names):
        raise NpfmError(f"a scene lists an effect twice: {', '.join(names)}")
