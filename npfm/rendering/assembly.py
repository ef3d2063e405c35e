"""Building a transport matrix: camera rays, light directions, and the cells they fall into."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from npfm.errors import NpfmError
from npfm.reflectance.grids import Grid, components
from npfm.rendering.effects import EFFECTS
from npfm.rendering.geometry import Shape
from npfm.rendering.lights.environment import LUMINANCE, Environment
from npfm.rendering.sampling.combination import combine
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate
from npfm.rendering.sampling.strategy import Strategy
from npfm.rendering.scenes import CAMERA, Scene, place
from npfm.rendering.surfaces import Surface, look
from npfm.rendering.transport import Transport

#: Samples of a strategy treated at once, at about a kilobyte of working memory each.
BLOCK = 1 << 17
#: A pixel gets up to this many times the usual number of samples, in proportion to the light that
#: a narrow highlight shows in it. Without that, the few pixels that mirror a lamp make nearly all
#: of the noise in the error of a specular material.
MOST_MULTIPLE = 64
#: That light is judged by this many half vectors a camera ray, of this share of the theta_h bins
#: (of 4 % of the range of theta_h, which is 2 to 4 degrees).
HIGHLIGHT_SAMPLES = 64
HIGHLIGHT_SHARE = 0.2


@dataclass(frozen=True)
class Setup:
    """All that is the same for every pixel while a matrix is built."""

    objects: Sequence[Shape]
    obstacles: Sequence[Callable[[Sequence[Shape], NDArray, NDArray, NDArray], NDArray]]
    environment: Environment
    strategies: Sequence[Strategy]
    power: float
    grid: Grid
    offsets: NDArray[np.float64]
    shifts: NDArray[np.float64]
    counts: Counter[str]


def build(
    scene: Scene,
    environment: Environment,
    grid: Grid,
    resolution: int,
    samples: int,
    seed: int,
    strategies: Sequence[Strategy] = (),
    power: float = 1.0,
    counts: Counter[str] | None = None,
) -> Transport:
    """Build the transport matrix of a scene in a light.

    Parameters
    ----------
    scene : Scene
    environment : Environment
    grid : Grid
        Of the tables to be rendered.
    resolution : int
        Pixels along one side of the square picture.
    samples : int
        Light directions for a pixel, rounded down to be shared evenly by the camera rays of the
        pixel, and by the ways of sampling. Pixels that mirror a bright light get a multiple; the
        average is at most twice this number.
    seed : int
        Of the rotations that make the errors of pixels independent.
    strategies : sequence of Strategy
        Ways of choosing light directions; those of `light` and `half_vector` if none is given.
    power : float
        Of the heuristic that combines them; 1 is the balance heuristic.
    counts : Counter, optional
        What is added to: its `rays` by the number of shadow rays, that is, of pairs of a surface
        point and a light direction that are asked about, whatever the number of objects.

    Raises
    ------
    NpfmError
        If the samples do not suffice for one of each strategy per camera ray, the mesh of the
        scene cannot be used, or the picture is too small to show the objects.
    """
    strategies = strategies or (LightSampling(environment), HalfVectorSampling(grid))
    setup = _prepare(scene, environment, grid, resolution, seed, strategies, power)
    if counts is not None:
        setup = replace(setup, counts=counts)
    least = len(setup.offsets) * len(setup.strategies)
    if samples < least:
        raise NpfmError(f"{samples} samples a pixel are too few for this scene; use {least}")
    surface, coverage, backdrop = look(
        CAMERA, setup.objects, environment, setup.offsets, resolution, tangents=grid.anisotropic
    )
    if len(surface) == 0:
        raise NpfmError(f"no ray of {resolution} x {resolution} pixels meets an object; use more")
    number = samples // least * _multiples(surface, environment, grid)
    parts = tqdm(list(_parts(surface, number)), desc="scene", unit="block", disable=None)
    blocks = (_rows(surface[part], number[part], setup) for part in parts)
    indptr, indices, weights = _joined(blocks, resolution**2)
    return Transport(indptr, indices, weights, coverage, backdrop, grid)


def _joined(blocks: Iterable[tuple[NDArray, ...]], pixels: int) -> tuple[NDArray, NDArray, NDArray]:
    """indptr, indices and weights of the matrix whose rows `_rows` gave block by block."""
    rows, entries, indices, weights = zip(*blocks, strict=True)
    indptr = np.zeros(pixels + 1, dtype=np.int64)
    indptr[1 + np.concatenate(rows)] = np.concatenate(entries)
    return np.cumsum(indptr), np.concatenate(indices), np.concatenate(weights, axis=1)


def camera_offsets(scene: Scene) -> NDArray[np.float64]:
    """Where camera rays pass through a pixel, in [0, 1), shape (rays, 2)."""
    offsets = np.array([[0.5, 0.5]])
    for name in scene.simulated:
        if film := EFFECTS[name].film:
            offsets = film(offsets)
    return offsets


def _prepare(
    scene: Scene,
    environment: Environment,
    grid: Grid,
    resolution: int,
    seed: int,
    strategies: Sequence[Strategy],
    power: float,
) -> Setup:
    effects = [EFFECTS[name] for name in scene.simulated]
    return Setup(
        objects=place(scene),
        obstacles=[effect.reaches for effect in effects if effect.reaches],
        environment=environment,
        strategies=strategies,
        power=power,
        grid=grid,
        offsets=camera_offsets(scene),
        shifts=np.random.default_rng(seed).random((len(strategies), resolution**2, 1, 2)),
        counts=Counter(),
    )


def _multiples(surface: Surface, environment: Environment, grid: Grid) -> NDArray[np.int64]:
    """How many times the usual number of samples each surface point gets: powers of two."""
    strategy = HalfVectorSampling(grid)
    u = low_discrepancy(HIGHLIGHT_SAMPLES) * [HIGHLIGHT_SHARE, 1.0]
    shown = np.empty(len(surface))
    step = BLOCK // HIGHLIGHT_SAMPLES
    for part in (slice(first, first + step) for first in range(0, len(surface), step)):
        points = surface[part]
        light = strategy.sample(np.broadcast_to(u, (len(points), *u.shape)), points)
        shown[part] = (environment.lookup(light) @ LUMINANCE).mean(axis=1)
    ratio = np.clip(shown / max(shown.mean(), np.finfo(float).tiny), 1, MOST_MULTIPLE)
    return 2 ** np.log2(ratio).astype(int)


def _parts(surface: Surface, counts: NDArray[np.int64]) -> Iterator[slice]:
    """Slices of whole pixels with about `BLOCK` samples of a strategy each."""
    starts = np.flatnonzero(np.diff(surface.pixel, prepend=-1))
    before = (np.cumsum(counts) - counts)[starts]
    cuts = starts[np.diff(before // BLOCK, prepend=-1) > 0]
    for first, last in zip(cuts, [*cuts[1:], len(surface)], strict=True):
        yield slice(first, last)


def _rows(surface: Surface, counts: NDArray, setup: Setup) -> tuple[NDArray, ...]:
    """Rows of the matrix: pixels, their numbers of entries, cells (n,) and weights (3, n)."""
    levels = np.unique(counts).tolist()
    parts = [_gather(surface[counts == count], count, setup) for count in levels]
    pixel, cell, weights = (np.concatenate(part, axis=-1) for part in zip(*parts, strict=True))
    key = pixel * setup.grid.column_count + cell
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = np.flatnonzero(np.diff(key, prepend=-1))
    merged = np.add.reduceat(weights[:, order], first, axis=1) if len(first) else weights
    pixel, cell = np.divmod(key[first], setup.grid.column_count)
    return *np.unique(pixel, return_counts=True), cell.astype(np.int32), merged.astype(np.float32)


def _gather(surface: Surface, count: int, setup: Setup) -> tuple[NDArray, NDArray, NDArray]:
    """Light that reaches surface points: pixels (n,), cells (n,) and weights (3, n).

    `count` is the number of samples of each strategy at each point.
    """
    u = _points(len(setup.offsets), count)[surface.ray]
    points = [rotate(u, shift[surface.pixel]) for shift in setup.shifts]
    light, density = combine(setup.strategies, points, surface, setup.power)
    axes = setup.grid.axes(surface.normal, surface.view, surface.tangent)
    along = light @ np.stack(axes, axis=-1)
    at, sample = np.nonzero((along[..., 0] > 0) & (density > 0))
    for reaches in setup.obstacles:
        ends = surface.position[at], surface.geometric[at], light[at, sample]
        free = reaches(setup.objects, *ends)
        setup.counts["rays"] += len(at)
        at, sample = at[free], sample[free]
    along = along[at, sample]
    factor = along[:, 0] / (density[at, sample] * len(setup.offsets))
    weights = setup.environment.lookup(light[at, sample]).T * factor
    index, share = setup.grid.columns(along, components(surface.view, axes), at)
    if share is None:
        return surface.pixel[at], index, weights
    pixel = np.repeat(surface.pixel[at], index.shape[1])
    return pixel, index.ravel(), (weights[..., None] * share).reshape(3, -1)


@cache
def _points(rays: int, count: int) -> NDArray[np.float64]:
    """Points of the unit square for each camera ray of a pixel, shape (rays, count, 2)."""
    points = low_discrepancy(rays * count).reshape(rays, count, 2)
    # In the order of x, so that neighbours in memory search the same part of the light.
    return np.take_along_axis(points, np.argsort(points[..., :1], axis=1), axis=1)
