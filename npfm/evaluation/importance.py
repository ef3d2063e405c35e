"""Ways of choosing light directions compared: one material and light at a time, on a sphere."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.variance import BATCHES, Combined, Integral, interval, repeated, single
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given, Strategy
from npfm.rendering.scenes import CAMERA, Scene, place
from npfm.rendering.surfaces import look

Array = NDArray[np.float64]

KEYS = ("light", "material", "strategy", "recipe", "points")
MEASURED = (*KEYS, "samples", "n_var", "low", "high", "seconds")
COLUMNS = (*MEASURED, "improvement")
#: The paper's strategy, and the recipe of the paper, which others are compared with.
FACTORED, PAPER = "factored", "paper"
#: How the points of samples are spread: by themselves, or as the renderer's.
INDEPENDENT, SOBOL = "independent", "sobol"
#: Points that all ways share are of these strategies, and of the last that is called `FACTORED`.
SHARED = ("light", "half-vector")
PATTERN = re.compile(r"(?P<parts>[^\s^]+)(?:\^(?P<power>[0-9.]+))?")


class Black(NpfmError):
    """Nothing is reflected, and the variance of everything is 0."""


@dataclass(frozen=True)
class Way:
    """A strategy, or several that are combined.

    Parameters
    ----------
    parts : tuple of (str, str)
        Name and recipe of each strategy; the recipe, which says where the arrays that it follows
        come from, is empty for those that follow none.
    power : float
        Of the heuristic that combines them.
    """

    parts: tuple[tuple[str, str], ...]
    power: float = 1.0

    @property
    def names(self) -> tuple[str, ...]:
        """The strategies with their recipes, in words."""
        return tuple(f"{name}/{recipe}" if recipe else name for name, recipe in self.parts)

    @property
    def strategy(self) -> str:
        """The strategies by name, in words."""
        return "+".join(name for name, _ in self.parts)

    @property
    def recipe(self) -> str:
        """Their recipes, and the power of the heuristic if it is not 1, in words."""
        power = [f"power {self.power:g}"] if self.power != 1 else []
        return ", ".join([*(recipe for _, recipe in self.parts if recipe), *power])


def way(text: str) -> Way:
    """Read a way, such as ``light+factored/improved^2``.

    Raises
    ------
    NpfmError
        If it is not written so, or a strategy is not known.
    """
    match = PATTERN.fullmatch(text)
    parts = [part.partition("/") for part in match["parts"].split("+")] if match else []
    try:
        power = float(match["power"] or 1) if match else 0
    except ValueError:
        power = 0
    if not power > 0:
        raise NpfmError(f"'{text}' is no way of sampling; write it as light+half-vector^2")
    registry.modules(name for name, _, _ in parts)
    return Way(tuple((name, recipe) for name, _, recipe in parts), power)


def make(
    ways: Iterable[Way], given: Given, parameters: Mapping[str, Mapping[str, NDArray]]
) -> dict[str, Strategy]:
    """Strategies of the ways, and those that shared points are from, by name and recipe.

    Parameters
    ----------
    ways : iterable of Way
    given : Given
        Light and material.
    parameters : mapping of str to mapping of str to ndarray
        Arrays that strategies follow, by name and recipe of the strategy.
    """
    names = dict.fromkeys([*SHARED, *(name for way in ways for name in way.names)])
    made = {}
    for name in names:
        own = replace(given, parameters=parameters.get(name, {}))
        (made[name],) = registry.make([name.partition("/")[0]], own)
    return made


@dataclass(frozen=True)
class Effort:
    """How well a study looks.

    Parameters
    ----------
    resolution : int
        Pixels along one side of the picture of the sphere.
    points : int
        That all ways share, of each strategy at each pixel.
    samples : sequence of int
        Of stratified estimates, from few to many.
    repetitions : int
        Of these.
    seed : int
    """

    resolution: int
    points: int
    samples: Sequence[int]
    repetitions: int
    seed: int = 1


def measure(
    ways: Sequence[Way],
    table: Table,
    environment: Environment,
    parameters: Mapping[str, Mapping[str, NDArray]],
    effort: Effort,
) -> tuple[pd.DataFrame, dict[str, NDArray[np.float32]]]:
    """Measure the variance of some ways, for a sphere of a material in a light.

    Nothing shadows a sphere, so that it is all of direct lighting.

    Returns
    -------
    table : DataFrame
        Columns strategy, recipe, points, samples, n_var, low, high and seconds of a sample. Rows
        of `INDEPENDENT` points are of one sample, and have the seconds of the largest number.
    images : dict of str to ndarray of float32, shape (h, w, 4)
        By way: n_var by pixel, over the mean square of the picture, of independent points and of
        stratified ones in the largest number; the luminance of the picture; and the coverage.
    """
    offsets = np.array([[0.5, 0.5]])
    surface, coverage, _ = look(
        CAMERA,
        place(Scene(("sphere",))),
        environment,
        offsets,
        effort.resolution,
        tangents=table.grid.anisotropic,
    )
    integral = Integral(surface, environment, table)
    strategies = make(ways, Given(environment, table.grid, table), parameters)
    combined = [Combined(way.names, way.power) for way in ways]
    factored = [name for name in strategies if name.partition("/")[0] == FACTORED]
    shared = [*SHARED, *factored[-1:]]
    count = max(1, effort.points // BATCHES)
    alone, mean = single(combined, strategies, integral, shared, count, effort.seed)
    square = (mean**2).mean()
    if square == 0:
        raise Black("a picture of it in this light is black; there is no variance to compare")
    rows, images = [], {}
    for k, one in enumerate(ways):
        found, last = _stratified(combined[k], strategies, integral, effort, square)
        value, low, high = interval(alone[:, k].mean(axis=1) / square)
        about = one.strategy, one.recipe
        rows.append((*about, INDEPENDENT, 1, value, low, high, found[-1][-1]))
        rows += [(*about, SOBOL, *row) for row in found]
        name = "+".join(one.names) + (f"^{one.power:g}" if one.power != 1 else "")
        parts = alone[:, k].mean(axis=0) / square, last / square, mean
        images[name] = _image(surface.pixel, parts, coverage)
    return pd.DataFrame(rows, columns=MEASURED[2:]), images


def _stratified(
    way: Combined,
    strategies: Mapping[str, Strategy],
    integral: Integral,
    effort: Effort,
    square: float,
) -> tuple[list[tuple], Array]:
    """Rows of stratified estimates (samples, n_var, low, high, seconds); the last by pixel (p,)."""
    rows = []
    for samples in effort.samples:
        if samples < len(way.strategies):
            raise NpfmError(
                f"{samples} samples are too few for {' and '.join(way.strategies)}; "
                f"use {len(way.strategies)}"
            )
        estimates, used, seconds = repeated(
            way, strategies, integral, samples, effort.repetitions, effort.seed
        )
        # Of the repetitions about their mean, and unbiased.
        squares = used * (estimates - estimates.mean(axis=0)) ** 2
        squares *= effort.repetitions / (effort.repetitions - 1)
        rows.append((samples, *interval(squares.mean(axis=1) / square), seconds))
    return rows, squares.mean(axis=0)


def _image(pixel: NDArray, parts: Sequence[Array], coverage: NDArray) -> NDArray[np.float32]:
    image = np.zeros((coverage.size, 4), dtype=np.float32)
    for channel, values in enumerate(parts):
        image[pixel, channel] = values
    image[:, 3] = coverage.ravel()
    return image.reshape(*coverage.shape, 4)


def read(path: str, columns: Sequence[str] = COLUMNS) -> pd.DataFrame:
    """Read a table that is from `measure` or `gather`; errors are those of `tables.read`."""
    return tables.read(path, KEYS, [name for name in columns if name not in KEYS])


def gather(found: Sequence[pd.DataFrame]) -> pd.DataFrame:
    """Put the tables of materials and lights together.

    Parameters
    ----------
    found : sequence of DataFrame
        Columns `MEASURED`.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`. `improvement` is n_var over that of `FACTORED` by the recipe `PAPER` in
        the same light, for the same material, points and samples, missing where there is none.
    """
    table = pd.concat(found, ignore_index=True)
    where = ["light", "material", "points", "samples"]
    ours = table[(table["strategy"] == FACTORED) & (table["recipe"] == PAPER)]
    base = ours.set_index(where)["n_var"].rename("base")
    table = table.join(base, on=where)
    table["improvement"] = table["n_var"] / table["base"]
    return table[list(COLUMNS)].sort_values(["light", "material"], kind="stable")
