"""Materials that change over an object, blended in several ways: pictures, and what each costs.

The transport matrix knows nothing of it: a scene costs what it costs without a texture.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.blended import BLENDS, Palette, in_bases, palette, reading, tabulated
from npfm.evaluation.metrics import psnr_or_gap
from npfm.fitting import registry
from npfm.fitting.basis import library
from npfm.reflectance.table import CHANNELS, Table
from npfm.rendering.products import Products, Reading, compiled, render_products
from npfm.rendering.transport import Transport, columns, pictures
from npfm.storage.files import Kind, marked

Array = NDArray[np.float64]
Picture = NDArray[np.float32]

#: Ways that blend tables: those of the measurements, and those of the fits.
MEASURED, TABLES = "measured", "tables"
#: Part of the pictures that holds the weights instead, and the materials by themselves half way.
WEIGHTS = "weights"
FIRST, SECOND = "first", "second"
#: What the memory of a texture is told for, and bytes of a number in it.
TEXELS, NUMBER = 1024**2, 4
COSTS = (
    "way", "scene", "held_bytes", "unknowns", "texture_bytes", "own_unknowns", "own_bytes",
    "tables", "prepare_seconds", "picture_seconds", "against", "psnr_db",
)  # fmt: skip
HALF_WAY = "pair", "first", "second", "way", "half_degrees", "foot_degrees", "brightness"
#: The second of the tables, known by its columns before the first is written.
HALF_WAY_TABLE = Kind("a table of what is half way", ".csv", marked(",".join(HALF_WAY).encode()))
#: Parts of the height of a highlight at which it is told how far it reaches.
HALF, FOOT = 0.5, 0.01
#: theta_d in degrees of the slice that it is read off, and theta_h up to which there is a rest.
SLICE, REST = 5.0, 60.0


@dataclass(frozen=True)
class Way:
    """A way of blending factors.

    Parameters
    ----------
    palette : Palette
        Factors of the materials.
    blend : callable
        Gives the products of parts of them.
    against : str
        The way that its picture is compared with.
    own, held : int
        Numbers that one material has, and that all of them have together.
    seconds : float
        CPU time of making the palette.
    """

    palette: Palette
    blend: Callable[[Palette, NDArray], Products]
    against: str
    own: int
    held: int
    seconds: float


def ways(paths: Sequence[str]) -> dict[str, Way]:
    """Return the ways of blending the factors of fits, out of their files.

    Raises
    ------
    NpfmError
        As `npfm.evaluation.blended.palette`.
    """
    began = time.process_time()
    free = palette(paths)
    seconds = time.process_time() - began
    own, held = free.value_count, free.value_count * len(paths)
    return {name: Way(free, blend, TABLES, own, held, seconds) for name, blend in BLENDS.items()}


def in_basis(paths: Sequence[str], factors: str, count: int) -> dict[str, Way]:
    """Return the way that blends coefficients of curves that the factors of many materials share.

    Parameters
    ----------
    paths : sequence of str
        Files of the fits.
    factors : str
        File of the factors of many fits, as ``npfm basis gather`` writes it.
    count : int
        Number of curves of each of D, F and G; fewer if there are no more.

    Raises
    ------
    NpfmError
        If a file cannot be read, or the factors are of another model or grid.
    """
    began = time.process_time()
    free, given = palette(paths), library.load(factors)
    if not given.single or given.grid != free.grid:
        raise NpfmError(f"{factors}: of another model or grid than the fits; gather theirs")
    bases = given.bases(count)
    laid = in_bases(free, bases)
    seconds = time.process_time() - began
    curves = sum(basis.count for basis in bases.values())
    own = len(CHANNELS) * (curves + 2)
    held = len(paths) * own + sum(basis.mean.size * (basis.count + 1) for basis in bases.values())
    name = f"basis-{max(basis.count for basis in bases.values())}"
    return {name: Way(laid, Palette.products, next(iter(BLENDS)), own, held, seconds)}


def where_measured(matrix: Transport, measured: Sequence[Table]) -> Transport:
    """Return a matrix that sees no cell which one of some tables has no measurement of."""
    missing = ~np.logical_and.reduce([table.valid for table in measured])
    missing &= matrix.grid.above_horizon
    if not missing.any():
        return matrix
    seen = ~missing.reshape(3, -1)
    weights = [w * channel[matrix.indices] for w, channel in zip(matrix.weights, seen, strict=True)]
    return replace(matrix, weights=np.stack(weights))


def read(table: str, half: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Read the tables of `costs` and `half_way`; errors are those of `tables.read`."""
    text = ("way", "scene", "against")
    numbers = [name for name in COSTS if name not in text]
    return tables.read(table, text, numbers), tables.read(half, HALF_WAY[:4], HALF_WAY[4:])


@dataclass(frozen=True)
class Made:
    """A picture, and what it took.

    Parameters
    ----------
    picture : ndarray of float32, shape (h, w, 3)
    against : str
        The way that it is compared with, if any.
    held : int
        Numbers in memory beside the matrix.
    own : int
        Numbers of a material.
    tables : int
        How many tables were made.
    prepare, seconds : float
        CPU time of what the picture is made from, and of the picture.
    """

    picture: Picture
    against: str
    held: int
    own: int
    tables: int
    prepare: float
    seconds: float


def render_all(
    matrix: Transport,
    parts: NDArray,
    measured: Sequence[Table],
    fits: Sequence[str],
    chosen: Mapping[str, Way],
    steps: Sequence[int],
) -> dict[str, Made]:
    """Render a material that changes from pixel to pixel in every way.

    Parameters
    ----------
    matrix : Transport
        Scene and light.
    parts : ndarray, shape (pixels, materials)
        How much of each material there is at each pixel.
    measured : sequence of Table
        Of each material.
    fits : sequence of str
        Files of the fits of each material.
    chosen : mapping of str to Way
        As `ways` gives them.
    steps : sequence of int
        Into how many steps weights are divided where the first of these ways makes a table for each
        mixture, instead of working it out where it is seen.

    Returns
    -------
    dict of str to Made
        Times are without what is compiled or imported once.
    """
    compiled()
    registry.tabulated(fits[0])
    made = {
        MEASURED: _of_tables(matrix, parts, lambda: measured, ""),
        TABLES: _of_tables(
            matrix, parts, lambda: [registry.tabulated(path) for path in fits], MEASURED
        ),
    }
    name, way = next(iter(chosen.items()))
    at = reading(way.palette.grid)
    made |= {name: _of_factors(matrix, parts, at, way) for name, way in chosen.items()}
    stepped = {f"{name}-{n}-steps": _in_steps(matrix, parts, name, way, n) for n in steps}
    return made | stepped


def costs(scene: str, made: Mapping[str, Made], foreground: NDArray, count: int) -> pd.DataFrame:
    """Tell what pictures took.

    Parameters
    ----------
    scene : str
        Its name.
    made : mapping of str to Made
        By way.
    foreground : ndarray of bool, shape (h, w)
        Pixels that are compared.
    count : int
        Of the materials.

    Returns
    -------
    DataFrame
        Columns `COSTS`. `held_bytes` is what has to be in memory beside the matrix, `unknowns` the
        numbers of a texel, and `texture_bytes` both together for `TEXELS` texels; `own_unknowns`
        and `own_bytes` are of texels that each have a material of their own. Seconds are CPU time,
        `tables` how many tables are made, `psnr_db` that of the picture against another way's.
    """
    rows = []
    for way, one in made.items():
        level = np.nan
        if one.against:
            level, _ = psnr_or_gap(one.picture, made[one.against].picture, foreground)
        held, unknowns = NUMBER * one.held, count - 1
        texture, own = held + TEXELS * unknowns * NUMBER, TEXELS * one.own * NUMBER
        memory = held, unknowns, texture, one.own, own, one.tables
        rows.append((way, scene, *memory, one.prepare, one.seconds, one.against, level))
    return pd.DataFrame(rows, columns=COSTS)


def _of_tables(
    matrix: Transport, parts: NDArray, tables_of: Callable[[], Sequence[Table]], against: str
) -> Made:
    began = time.process_time()
    values = columns(tables_of())
    ready = time.process_time()
    count, shape = values.shape[-1], matrix.backdrop.shape
    shown = pictures(matrix, values).reshape(count, -1, 3)
    picture = np.einsum("pm,mpc->pc", parts, shown).reshape(shape).astype(np.float32)
    spent = ready - began, time.process_time() - ready
    return Made(picture, against, values.size, values[..., 0].size, count, *spent)


def _of_factors(matrix: Transport, parts: NDArray, at: Reading, way: Way) -> Made:
    began = time.process_time()
    blend, palette = way.blend, way.palette
    picture = render_products(matrix, at, lambda pixels: blend(palette, parts[pixels]))[..., :3]
    seconds = time.process_time() - began
    return Made(picture, way.against, way.held, way.own, 0, way.seconds, seconds)


def _in_steps(matrix: Transport, parts: NDArray, name: str, way: Way, steps: int) -> Made:
    began = time.process_time()
    picture, count = render_in_steps(matrix, way, parts, steps)
    seconds = time.process_time() - began
    # One table is in memory at a time.
    held = way.held + 3 * matrix.grid.size
    return Made(picture, name, held, way.own, count, way.seconds, seconds)


def render_in_steps(matrix: Transport, way: Way, parts: NDArray, steps: int) -> tuple[Picture, int]:
    """Render with a table for each mixture, of weights in whole steps; and how many tables it took.

    Each table is multiplied with the rows of its own pixels alone.
    """
    seen = np.flatnonzero(np.diff(matrix.indptr))
    mixtures, which = np.unique(whole_steps(parts[seen], steps), axis=0, return_inverse=True)
    picture = matrix.backdrop.reshape(-1, 3).copy()
    matrices = matrix.matrices
    for number, mixture in enumerate(mixtures):
        (table,) = tabulated(way.blend(way.palette, mixture[None] / steps), way.palette.grid)
        values = table.grid.column_values(table.values).astype(np.float32)
        pixels = seen[which == number]
        for channel, (rows, column) in enumerate(zip(matrices, values, strict=True)):
            picture[pixels, channel] += rows[pixels] @ column
    return picture.reshape(matrix.backdrop.shape), len(mixtures)


def whole_steps(parts: NDArray, steps: int) -> NDArray[np.int64]:
    """Nearest whole numbers of steps, by largest remainders: each row adds up to `steps`."""
    exact = parts * steps
    whole = np.floor(exact).astype(int)
    left = np.rint(exact.sum(axis=1)).astype(int) - whole.sum(axis=1)
    rank = np.argsort(np.argsort(whole - exact, axis=1, kind="stable"), axis=1, kind="stable")
    return whole + (rank < left[:, None])


def half_way(
    names: Sequence[str], matrix: Transport, fitted: Sequence[Table], chosen: Mapping[str, Way]
) -> tuple[pd.DataFrame, dict[str, Picture]]:
    """Render the mixture half way between each material and the next, in every way.

    Parameters
    ----------
    names : sequence of str
        Of the materials.
    matrix : Transport
    fitted : sequence of Table
        Tables of the fits.
    chosen : mapping of str to Way
        As `ways` gives them.

    Returns
    -------
    table : DataFrame
        Columns `HALF_WAY`: `pair` is the number of the first material. The ways `FIRST` and
        `SECOND` are the materials alone; others are `TABLES` and those that are chosen. Of each
        there is theta_h in degrees at which the highlight has fallen to half and to a hundredth of
        its height (`reach`), and the mean radiance of the object, as a share of the mean of the two
        materials'; NaN where both are black.
    pictures : dict of str to ndarray of float32, shape (h, w, 3)
        By number of the pair and way, as in ``0/tables``.
    """
    rows, shown = [], {}
    for number, (a, b) in enumerate(pairwise(range(len(names)))):
        parts = np.zeros((1, len(names)))
        parts[0, [a, b]] = 0.5
        made = {FIRST: fitted[a], SECOND: fitted[b], TABLES: _mean(fitted[a], fitted[b])}
        for name, way in chosen.items():
            (made[name],) = tabulated(way.blend(way.palette, parts), way.palette.grid)
        seen = pictures(matrix, columns(list(made.values())))
        light = seen[:, matrix.foreground].mean(axis=(1, 2))
        ends = light[:2].mean()
        brightness = light / ends if ends > 0 else np.full(len(light), np.nan)
        for (name, table), picture, level in zip(made.items(), seen, brightness, strict=True):
            reached = (reach(table, part) for part in (HALF, FOOT))
            rows.append((number, names[a], names[b], name, *reached, level))
            shown[f"{number}/{name}"] = picture
    return pd.DataFrame(rows, columns=HALF_WAY), shown


def _mean(a: Table, b: Table) -> Table:
    return replace(a, values=(a.values + b.values) / 2)


def reach(table: Table, part: float) -> float:
    """Angle theta_h in degrees at which a highlight has fallen to a part of its height.

    It is read off the mean of the channels at theta_d = `SLICE` and phi_d = 90 degrees. The height
    is above the smallest value up to theta_h = `REST`.
    """
    grid = table.grid
    d = np.abs(np.degrees(grid.theta_d) - SLICE).argmin()
    degrees = np.degrees(grid.theta_h)
    inside = degrees <= REST
    profile = table.values.mean(axis=0)[inside, d, grid.phi_d_bins // 2]
    top = profile.argmax()
    height = (profile - profile.min()) / (np.ptp(profile) or 1.0)
    below = np.flatnonzero(height[top:] <= part) + top
    if not below.size:
        return float(REST)
    first = below[0]
    if first == top:
        return float(degrees[top])
    pair = [first, first - 1]
    return float(np.interp(part, height[pair], degrees[pair]))
