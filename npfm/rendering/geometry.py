"""Objects that rays can meet: an analytic sphere and a triangle mesh.

Both answer the same two questions, `nearest` and `occluded`. Lengths are in scene units.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]

#: How far above the surface shadow rays start. It steps over the rounding of Embree's float32 (5e-7
#: at the distance of a camera) and over the cracks between the layers of a scan, and is a
#: twentieth of a pixel in a picture of 128 pixels.
OFFSET = 1e-3


class Hits(NamedTuple):
    """Where rays meet a surface.

    Attributes
    ----------
    distance : ndarray, shape (n,)
        Length along the ray; infinite where there is no hit, and then the normals mean nothing.
    geometric : ndarray, shape (n, 3)
        Unit normal of the surface itself, on the side that the ray comes from.
    shading : ndarray, shape (n, 3)
        Unit normal of the smooth surface that a mesh stands for, on the same side of its face;
        at silhouettes it may all the same face away from the ray.
    along : ndarray, shape (n, 3), or None
        Direction that a brushing or a thread runs in, not quite across the normals; None if it was
        not asked for.
    """

    distance: Array
    geometric: Array
    shading: Array
    along: Array | None = None


class Shape(Protocol):
    """What an object of a scene can do."""

    def nearest(self, origins: Array, directions: Array, *, along: bool = False) -> Hits:
        """First hits of rays; `origins` and unit `directions` of shape (n, 3)."""

    def occluded(self, origins: Array, directions: Array) -> NDArray[np.bool_]:
        """Whether rays hit the object at all, shape (n,)."""


@dataclass(frozen=True)
class Sphere:
    """A sphere that is met from outside.

    Parameters
    ----------
    centre : tuple of float
    radius : float
    """

    centre: tuple[float, float, float]
    radius: float

    def _quadratic(self, origins: Array, directions: Array) -> tuple[Array, Array]:
        """Distance to the point nearest to the centre, and the squared half chord there."""
        to_centre = np.asarray(self.centre) - origins
        along = np.einsum("ij,ij->i", to_centre, directions)
        return along, self.radius**2 + along**2 - np.einsum("ij,ij->i", to_centre, to_centre)

    def nearest(self, origins: Array, directions: Array, *, along: bool = False) -> Hits:
        """First hits of rays that start outside; `origins`, unit `directions` (n, 3)."""
        length, half_chord2 = self._quadratic(origins, directions)
        hit = (half_chord2 > 0) & (length > 0)
        distance = np.where(hit, length - np.sqrt(np.maximum(half_chord2, 0)), np.inf)
        points = origins + np.where(hit, distance, 0)[:, None] * directions
        normal = (points - self.centre) / self.radius
        return Hits(distance, normal, normal, _upwards(normal) if along else None)

    def occluded(self, origins: Array, directions: Array) -> NDArray[np.bool_]:
        """Whether rays that start outside hit the sphere, shape (n,)."""
        along, half_chord2 = self._quadratic(origins, directions)
        return (half_chord2 > 0) & (along > 0)


@dataclass(frozen=True)
class Mesh:
    """Triangles with smooth normals. Rays are traced by Embree, imported with the first ray.

    Parameters
    ----------
    vertices : ndarray, shape (v, 3)
    faces : ndarray of int, shape (f, 3)
        Indices of vertices, counter-clockwise from outside.
    normals : ndarray, shape (v, 3)
        Unit normals at the vertices.
    threads : ndarray, shape (v, 3), or None
        Directions at the vertices that a brushing or a thread runs in; None for upwards, as far as
        the surface goes.
    """

    vertices: Array
    faces: NDArray[np.integer]
    normals: Array
    threads: Array | None = None

    @cached_property
    def _embree(self) -> Any:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        scene = EmbreeScene(robust=True)
        TriangleMesh(scene, self.vertices.astype(np.float32), self.faces.astype(np.int32))
        return scene

    def nearest(self, origins: Array, directions: Array, *, along: bool = False) -> Hits:
        """First hits of rays; `origins` and unit `directions` of shape (n, 3)."""
        found = self._embree.run(*_single(origins, directions), output=True)
        hit = found["primID"] >= 0
        corners = self.faces[np.where(hit, found["primID"], 0)]
        a, b, c = (self.vertices[corners[:, k]] for k in range(3))
        # Scans have holes through which the inside is seen, and triangles the wrong way round.
        geometric = _along(_unit(np.cross(b - a, c - a)), -directions)
        u, v = (found[name][:, None].astype(float) for name in "uv")
        at_a, at_b, at_c = (self.normals[corners[:, k]] for k in range(3))
        smooth = (1 - u - v) * at_a + u * at_b + v * at_c
        # Where faces lie back to back, the normals at their vertices cancel.
        cancelled = np.linalg.norm(smooth, axis=1, keepdims=True) < 1e-6
        shading = _along(_unit(np.where(cancelled, geometric, smooth)), geometric)
        distance = np.where(hit, found["tfar"], np.inf)
        if not along:
            return Hits(distance, geometric, shading)
        if self.threads is None:
            return Hits(distance, geometric, shading, _upwards(shading))
        at_a, at_b, at_c = (self.threads[corners[:, k]] for k in range(3))
        return Hits(distance, geometric, shading, (1 - u - v) * at_a + u * at_b + v * at_c)

    def occluded(self, origins: Array, directions: Array) -> NDArray[np.bool_]:
        """Whether rays hit the mesh at all, shape (n,)."""
        return self._embree.run(*_single(origins, directions), query="OCCLUDED") >= 0


def nearest(
    objects: Sequence[Shape], origins: Array, directions: Array, *, along: bool = False
) -> Hits:
    """First hits of rays with any of the objects; `origins`, unit `directions` (n, 3)."""
    hits = objects[0].nearest(origins, directions, along=along)
    for shape in objects[1:]:
        other = shape.nearest(origins, directions, along=along)
        closer = other.distance < hits.distance
        field = None
        if hits.along is not None and other.along is not None:
            field = np.where(closer[:, None], other.along, hits.along)
        hits = Hits(
            np.where(closer, other.distance, hits.distance),
            np.where(closer[:, None], other.geometric, hits.geometric),
            np.where(closer[:, None], other.shading, hits.shading),
            field,
        )
    return hits


def _single(origins: Array, directions: Array) -> tuple[Array, Array]:
    return (
        np.ascontiguousarray(origins, dtype=np.float32),
        np.ascontiguousarray(directions, dtype=np.float32),
    )


def _unit(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.maximum(length, np.finfo(float).tiny)


def _upwards(normals: Array) -> Array:
    """The y axis at each of the normals, for shapes that have no threads of their own."""
    return np.broadcast_to([0.0, 1.0, 0.0], normals.shape)


def _along(vectors: Array, directions: Array) -> Array:
    """Vectors, reversed where they point against the directions."""
    against = np.einsum("ij,ij->i", vectors, directions) < 0
    return np.where(against[:, None], -vectors, vectors)
