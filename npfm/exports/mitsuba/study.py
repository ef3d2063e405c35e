"""How noisy paths are through the still life, by what chooses their directions.

As in Lawrence et al. 2004, section 6.3: the light that comes to a point is not known, and the
material alone chooses directions. The mean and the variance of one path are known at every pixel.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from npfm.exports.mitsuba import plugin, still_life
from npfm.exports.mitsuba.samplers import Sampler
from npfm.reflectance.table import Table

Array = NDArray[np.float64]

#: Reflections of a path at most, and paths that are followed at once.
DEPTH, BLOCK = 8, 1 << 18


@dataclass(frozen=True)
class Rendering:
    """A picture by independent paths.

    Parameters
    ----------
    mean, variance : ndarray, shape (h, w, 3)
        Radiance, and the variance of one path.
    paths : int
        A pixel.
    seconds : float
        CPU time of them all, without compilation.
    """

    mean: Array
    variance: Array
    paths: int
    seconds: float


def world(
    tables: Sequence[Table], samplers: Sequence[Sampler], *, lamps_sampled: bool = False
) -> Any:
    """Make the still life of five materials, each with what chooses its directions."""
    made = map(plugin.bsdf, tables, samplers)
    bsdfs = dict(zip(still_life.PARTS, made, strict=True))
    return still_life.world(bsdfs, lamps_sampled=lamps_sampled)


def render(scene: Any, resolution: int, paths: int, seed: int) -> Rendering:
    """Follow paths through each pixel, from points spread evenly over it."""
    path = mi.load_dict({"type": "path", "max_depth": DEPTH + 1, "rr_depth": DEPTH + 2})
    numbers = mi.load_dict({"type": "independent"})
    generator = np.random.default_rng(seed)
    pixels = np.arange(resolution**2)
    each = max(1, min(paths, BLOCK // len(pixels)))
    sums = np.zeros((2, len(pixels), 3))
    began, done = time.process_time(), 0
    while done < paths:
        count = min(each, paths - done)
        repeated = np.tile(pixels, count)
        rays = still_life.rays(repeated, generator.random((len(repeated), 2)), resolution)
        found = _follow(scene, path, numbers, rays, (seed << 16) + done)
        found = np.where(np.isfinite(found), found, 0).reshape(count, len(pixels), 3)
        sums += found.sum(axis=0), (found**2).sum(axis=0)
        done += count
    seconds = time.process_time() - began
    mean, square = sums.reshape(2, resolution, resolution, 3) / done
    variance = np.maximum(square - mean**2, 0) * (done / max(done - 1, 1))
    return Rendering(mean, variance, done, seconds)


def _follow(scene: Any, path: Any, numbers: Any, rays: tuple[Array, Array], seed: int) -> Array:
    """Radiance (n, 3) of paths that begin with rays."""
    if dr.is_jit_v(mi.Float):
        numbers.seed(dr.opaque(mi.UInt32, seed), len(rays[0]))
        origin, direction = (
            mi.Vector3f(np.ascontiguousarray(part.T, dtype=np.float32)) for part in rays
        )
        ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(origin), direction))
        return np.array(path.sample(scene, numbers, ray)[0], dtype=float).T
    numbers.seed(seed)
    found = []
    for origin, direction in zip(*(part.tolist() for part in rays), strict=True):
        ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(*origin), mi.Vector3f(*direction)))
        found.append(list(path.sample(scene, numbers, ray)[0]))
    return np.array(found, dtype=float)
