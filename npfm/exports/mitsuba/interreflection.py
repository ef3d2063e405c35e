"""The effect `interreflection`: light that objects of a scene reflect onto each other.

T @ table is the light that comes from the environment straight to where the camera looks. What is
added here comes there from other points of the objects, and is not linear in the table: paths are
followed by Mitsuba, from the surface points that T is built for.

Paths depend on the seed and on the material that they are sampled by, and not on the one that they
are rendered with. A fit is rendered along the paths of its measurement, so that a perfect one has
no error.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from npfm.exports.mitsuba import plugin, shapes
from npfm.exports.mitsuba.reflectance import Reflectance
from npfm.exports.mitsuba.samplers import Sampler
from npfm.reflectance.table import Table
from npfm.rendering.geometry import OFFSET
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.surfaces import Surface, look

#: Reflections on a path at most, the first that the camera sees included.
DEPTH = 8
#: Paths that are followed at once, compiled.
BLOCK = 1 << 18

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bounced:
    """Light that came over other points of the objects.

    Parameters
    ----------
    radiance : ndarray, shape (h, w, 3)
    error : ndarray, shape (h, w, 3)
        Standard error of the radiance, as of independent paths: an upper bound, for their first
        directions are stratified.
    paths : int
        In all.
    lost : int
        Paths to whose end Mitsuba's float32 had no number; they count as dark.
    """

    radiance: Array
    error: Array
    paths: int
    lost: int


def bounced(
    scene: Scene,
    environment: Environment,
    table: Table,
    sampler: Sampler,
    resolution: int,
    paths: int,
    seed: int,
) -> Bounced:
    """Follow paths of two to `DEPTH` reflections.

    Parameters
    ----------
    scene : Scene
    environment : Environment
    table : Table
        What all objects are made of.
    sampler : Sampler
        What chooses directions, before and after the first reflection.
    resolution : int
        Pixels along one side.
    paths : int
        Of a pixel, rounded up to be the same number for each of its camera rays.
    seed : int
    """
    objects, offsets = place(scene), camera_offsets(scene)
    surface, _, _ = look(CAMERA, objects, environment, offsets, resolution)
    reflectance = Reflectance(table)
    bsdf = plugin.bsdf(table, sampler)
    made = {f"object{k}": shapes.shape(item, bsdf) for k, item in enumerate(objects)}
    world = mi.load_dict({"type": "scene", "light": shapes.light(environment), **made})
    each = -(-paths // len(offsets))
    sums, lost = np.zeros((2, resolution**2, 3)), 0
    for block, chosen in enumerate(_blocks(len(surface), each)):
        points = _starts(surface, chosen, each, len(offsets), seed)
        radiance = _follow(world, reflectance, sampler, points, (seed << 16) + block)
        finite = np.isfinite(radiance).all(axis=1)
        lost += int(np.count_nonzero(~finite))
        radiance[~finite] = 0
        for total, values in zip(sums, (radiance, radiance**2), strict=True):
            for channel in range(3):
                total[:, channel] += np.bincount(
                    surface.pixel[chosen // each], values[:, channel], len(total)
                )
    number = each * len(offsets)
    mean, square = sums / number
    error = np.sqrt(np.maximum(square - mean**2, 0) / number)
    shape = resolution, resolution, 3
    return Bounced(mean.reshape(shape), error.reshape(shape), each * len(surface), lost)


@dataclass(frozen=True)
class Starts:
    """Where paths leave the first surface: their points, frames, views, and random numbers."""

    origin: Array
    frame: Array
    view: Array
    u: Array


def _blocks(points: int, each: int) -> Iterator[NDArray[np.int64]]:
    """Numbers of paths, `each` of a surface point, that are followed at once."""
    numbers = np.arange(points * each)
    yield from np.array_split(numbers, max(1, -(-len(numbers) // BLOCK)))


def _starts(surface: Surface, chosen: NDArray[np.int64], each: int, rays: int, seed: int) -> Starts:
    point, path = np.divmod(chosen, each)
    at = surface[point]
    shifts = np.random.default_rng(seed).random((surface.pixel.max() + 1, 2))
    spread = low_discrepancy(rays * each).reshape(rays, each, 2)
    return Starts(
        origin=at.position + OFFSET * at.geometric,
        frame=at.view_frame,
        view=np.stack([np.sqrt(1 - at.cos_o**2), np.zeros(len(at)), at.cos_o], axis=-1),
        u=rotate(spread[at.ray, path], shifts[at.pixel]),
    )


def _follow(
    world: Any, reflectance: Reflectance, sampler: Sampler, starts: Starts, seed: int
) -> Array:
    """Radiance (n, 3) along paths, of one number each."""
    path = mi.load_dict(
        {"type": "path", "max_depth": DEPTH, "rr_depth": DEPTH + 1, "hide_emitters": True}
    )
    numbers = mi.load_dict({"type": "independent"})

    def radiance(u: Any, *vectors: Any) -> Any:
        origin, x, y, z, view = vectors
        light = sampler.sample(view, numbers.next_1d(), u)
        density = sampler.pdf(view, light)
        usable = (light.z > 0) & (density > 0)
        weight = reflectance.brdf(view, light) * (light.z / dr.select(usable, density, 1.0))
        ray = mi.RayDifferential3f(mi.Ray3f(origin, x * light.x + y * light.y + z * light.z))
        arriving, _, _ = path.sample(world, numbers, ray, None, usable)
        return dr.select(usable, weight * arriving, 0.0)

    x, y, z = np.moveaxis(starts.frame, 1, 0)
    parts = starts.origin, x, y, z, starts.view, starts.u
    if dr.is_jit_v(mi.Float):
        numbers.seed(dr.opaque(mi.UInt32, seed), len(starts.u))
        *vectors, u = (np.ascontiguousarray(part.T, dtype=np.float32) for part in parts)
        found = radiance(mi.Point2f(u), *map(mi.Vector3f, vectors))
        return np.array(found, dtype=float).T
    numbers.seed(seed)
    rows = (
        radiance(mi.Point2f(*u), *(mi.Vector3f(*v) for v in vectors))
        for *vectors, u in zip(*(part.tolist() for part in parts), strict=True)
    )
    return np.array([list(row) for row in rows], dtype=float)
