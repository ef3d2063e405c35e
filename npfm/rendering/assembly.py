"""Building a transport matrix: camera rays, light directions, and the cells they fall into."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from npfm.errors import NpfmError
from npfm.reflectance.grids import Grid, components
from npfm.reflectance.half_difference import HalfDifference
from npfm.rendering import fused, kernels, row_sums
from npfm.rendering.directions import Combined, Directions, Draw
from npfm.rendering.effects import EFFECTS
from npfm.rendering.geometry import Shape
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.sampling.low_discrepancy import low_discrepancy
from npfm.rendering.sampling.strategy import Strategy
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.surfaces import Surface, look
from npfm.rendering.transport import Transport

#: Samples treated at once: few enough for what is known of them to stay in a processor's cache.
BLOCK = 1 << 15
#: Entries of the matrix that are put together before there are all of them, in 64 MB.
CHUNK = 1 << 22
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
    grid: Grid
    rays: int
    draw: Draw
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
    objects, offsets = place(scene), camera_offsets(scene)
    least = len(offsets) * len(strategies)
    if samples < least:
        raise NpfmError(f"{samples} samples a pixel are too few for this scene; use {least}")
    surface, coverage, backdrop = look(
        CAMERA, objects, environment, offsets, resolution, tangents=grid.anisotropic
    )
    if len(surface) == 0:
        raise NpfmError(f"no ray of {resolution} x {resolution} pixels meets an object; use more")
    number = samples // least * _multiples(surface, environment, grid)
    shifts = np.random.default_rng(seed).random((len(strategies), resolution**2, 2))
    effects = [EFFECTS[name] for name in scene.simulated]
    setup = Setup(
        objects=objects,
        obstacles=[effect.reaches for effect in effects if effect.reaches],
        environment=environment,
        grid=grid,
        rays=len(offsets),
        draw=_drawing(environment, strategies, power, len(offsets), shifts, np.unique(number)),
        counts=Counter() if counts is None else counts,
    )
    parts = tqdm(
        list(_parts(surface, number * len(strategies))), desc="scene", unit="block", disable=None
    )
    rows = (_rows(surface[part], number[part], setup) for part in parts)
    indptr, indices, weights = _joined(rows, resolution**2)
    return Transport(indptr, indices, weights, coverage, backdrop, grid)


def _drawing(
    environment: Environment,
    strategies: Sequence[Strategy],
    power: float,
    rays: int,
    shifts: NDArray[np.float64],
    levels: NDArray[np.int64],
) -> Draw:
    """What draws light directions: a compiled pass, if there is one for the strategies."""
    if fused.serves(environment, strategies, power):
        return fused.Fused(environment, strategies, rays, shifts, levels)
    return Combined(environment, strategies, power, rays, shifts)


def _joined(blocks: Iterable[tuple[NDArray, ...]], pixels: int) -> tuple[NDArray, NDArray, NDArray]:
    """indptr, indices and weights of the matrix whose rows `_rows` gave block by block."""
    indptr = np.zeros(pixels + 1, dtype=np.int64)
    chunks: list[tuple[NDArray, NDArray]] = []
    held: list[tuple[NDArray, NDArray]] = []
    for pixel, entries, columns, weights in blocks:
        indptr[1 + pixel] = entries
        held.append((columns, weights))
        if sum(columns.size for columns, _ in held) > CHUNK:
            chunks.append(_together(held))
            held = []
    chunks.append(_together(held))
    end = sum(columns.size for columns, _ in chunks)
    indices, sums = np.empty(end, np.int32), np.empty((3, end), np.float32)
    while chunks:
        columns, weights = chunks.pop()
        indices[end - columns.size : end], sums[:, end - columns.size : end] = columns, weights
        end -= columns.size
    return np.cumsum(indptr), indices, sums


def _together(parts: Sequence[tuple[NDArray, NDArray]]) -> tuple[NDArray, NDArray]:
    columns, weights = zip(*parts, strict=True)
    return np.concatenate(columns), np.concatenate(weights, axis=1)


def _multiples(surface: Surface, environment: Environment, grid: Grid) -> NDArray[np.int64]:
    """How many times the usual number of samples each surface point gets: powers of two."""
    square = low_discrepancy(HIGHLIGHT_SAMPLES) * [HIGHLIGHT_SHARE, 1.0]
    shown = fused.highlights(surface, square, environment, grid)
    ratio = np.clip(shown / max(shown.mean(), np.finfo(float).tiny), 1, MOST_MULTIPLE)
    return 2 ** np.log2(ratio).astype(int)


def _parts(surface: Surface, counts: NDArray[np.int64]) -> Iterator[slice]:
    """Slices of whole pixels with about `BLOCK` samples each."""
    starts = np.flatnonzero(np.diff(surface.pixel, prepend=-1))
    before = (np.cumsum(counts) - counts)[starts]
    cuts = starts[np.diff(before // BLOCK, prepend=-1) > 0]
    for first, last in zip(cuts, [*cuts[1:], len(surface)], strict=True):
        yield slice(first, last)


def _rows(surface: Surface, counts: NDArray[np.int64], setup: Setup) -> tuple[NDArray, ...]:
    """Rows of the matrix: pixels, their numbers of entries, columns (n,) and weights (3, n)."""
    drawn = setup.draw(surface, counts)
    for reaches in setup.obstacles:
        rays = surface.position[drawn.point], surface.geometric[drawn.point], drawn.vectors.T
        setup.counts["rays"] += len(drawn.point)
        drawn = drawn[reaches(setup.objects, *rays)]
    column, share = _columns(setup.grid, surface, drawn)
    pixels, first = np.unique(surface.pixel, return_index=True)
    ends = np.searchsorted(drawn.point, [*first[1:], len(surface)])
    sums = row_sums.row_sums(
        ends,
        column,
        share,
        drawn.texel,
        drawn.weight / setup.rays,
        setup.environment.texels,
        setup.grid.column_count.bit_length(),
    )
    return pixels, *sums


def _columns(grid: Grid, surface: Surface, drawn: Directions) -> tuple[NDArray, NDArray]:
    """Columns (n, k) of the matrix that light falls into, and shares, (0, 0) if k is 1."""
    axes = grid.axes(surface.normal, surface.view, surface.tangent)
    if type(grid) is HalfDifference:
        normal, view, across = map(np.ascontiguousarray, axes)
        cells = kernels.half_difference_cells(
            drawn.vectors, drawn.point, normal, view, across, np.array(grid.shape)
        )
        return cells[:, None], np.empty((0, 0))
    along = [np.einsum("ij,ji->i", axis[drawn.point], drawn.vectors) for axis in axes]
    index, share = grid.columns(
        np.stack(along, axis=-1), components(surface.view, axes), drawn.point.astype(np.intp)
    )
    if share is None:
        return index[:, None], np.empty((0, 0))
    return index, share
