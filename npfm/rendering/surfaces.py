"""What the camera sees: surface points, how far objects cover pixels, and the light past them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.backdrop import seen
from npfm.rendering.camera import Camera
from npfm.rendering.geometry import Shape, nearest
from npfm.rendering.lights.environment import Environment
from npfm.rendering.shading import Shading

#: Smallest cosine between view and shading normal. Normals that lean farther away from the
#: viewer, as smooth normals do at silhouettes, are bent back to it (88.9 degrees).
GRAZING = 0.02


@dataclass(frozen=True, kw_only=True)
class Surface(Shading):
    """Points where camera rays meet objects, in the order of their pixels.

    Parameters
    ----------
    pixel, ray : ndarray of int, shape (p,)
        Number of the pixel, and of the camera ray among those of the pixel.
    position, geometric : ndarray, shape (p, 3)
        The point, and the unit normal of the object there. It has a positive cosine with the view,
        as the normal for shading has.
    """

    pixel: NDArray[np.int64]
    ray: NDArray[np.int64]
    position: NDArray[np.float64]
    geometric: NDArray[np.floating]


def look(
    camera: Camera,
    objects: Sequence[Shape],
    environment: Environment,
    offsets: NDArray,
    resolution: int,
    *,
    tangents: bool = False,
) -> tuple[Surface, NDArray[np.float32], NDArray[np.float32]]:
    """Trace the camera rays of a picture.

    Parameters
    ----------
    camera : Camera
    objects : sequence of Shape
    environment : Environment
    offsets : ndarray, shape (k, 2)
        Where camera rays pass through a pixel, in [0, 1).
    resolution : int
        Pixels along one side of the square picture.
    tangents : bool
        Whether the points need tangents.

    Returns
    -------
    surface : Surface
    coverage : ndarray of float32, shape (resolution, resolution)
        Share of the camera rays of a pixel that meet an object.
    backdrop : ndarray of float32, shape (resolution, resolution, 3)
        Mean radiance where the other rays pass, times their share.
    """
    rays = len(offsets)
    direction = camera.directions(np.arange(resolution**2), offsets, resolution).reshape(-1, 3)
    origins = np.broadcast_to(camera.position, direction.shape)
    hits = nearest(objects, origins, direction, along=tangents)
    hit = np.isfinite(hits.distance)
    light = np.zeros(direction.shape)
    light[~hit] = seen(camera, environment, offsets, resolution, np.flatnonzero(~hit))
    pixel, ray = np.divmod(np.flatnonzero(hit), rays)
    view = -direction[hit]
    position = camera.position - hits.distance[hit, None] * view
    shading = towards(hits.shading[hit], view, GRAZING)
    surface = Surface(
        normal=shading,
        view=view,
        tangent=None if hits.along is None else across(hits.along[hit], shading),
        pixel=pixel,
        ray=ray,
        position=position,
        geometric=hits.geometric[hit],
    )
    coverage = hit.reshape(resolution, resolution, rays).mean(axis=2)
    backdrop = light.reshape(resolution, resolution, rays, 3).mean(axis=2)
    return surface, coverage.astype(np.float32), backdrop.astype(np.float32)


def towards(normal: NDArray, view: NDArray, least: float) -> NDArray:
    """Turn unit normals that face away from the viewer, as little as gives a cosine `least`.

    Parameters
    ----------
    normal, view : ndarray, shape (n, 3)
    least : float
        Cosine between normal and view that is enough.

    Returns
    -------
    ndarray, shape (n, 3)
        Unit normals in the planes of the given ones and the views.
    """
    cosine = np.einsum("ij,ij->i", normal, view)[:, None]
    across = normal - cosine * view
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), np.finfo(float).tiny)
    bent = least * view + np.sqrt(1 - least**2) * across
    return np.where(cosine >= least, normal, bent)


def across(along: NDArray, normal: NDArray) -> NDArray:
    """Unit tangents that lie as near to given directions as they can.

    Of upward ones they are the meridians of a sphere. No field of tangents is continuous all over a
    closed surface without a hole: here they meet where a direction is that of the normal.

    Parameters
    ----------
    along : ndarray, shape (n, 3)
        Directions, not 0.
    normal : ndarray, shape (n, 3)
        Unit normals.

    Returns
    -------
    ndarray, shape (n, 3)
        Unit vectors across the normals, in the planes of the normals and the directions; where
        there is no such plane, in that of the normal and -z, or of the normal and x.
    """
    tangent = np.zeros(normal.shape)
    for direction in (np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0]), along):
        flat = direction - (direction * normal).sum(axis=1, keepdims=True) * normal
        length = np.linalg.norm(flat, axis=1, keepdims=True)
        usable = length > 1e-7
        tangent = np.where(usable, flat / np.where(usable, length, 1.0), tangent)
    return tangent
