"""Light directions for surface points: those above the horizon, and by what light counts there."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.combination import combine
from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate
from npfm.rendering.sampling.strategy import Strategy
from npfm.rendering.surfaces import Surface

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Directions:
    """Light directions above the horizons of surface points.

    Parameters
    ----------
    point : ndarray of int32, shape (n,)
        The point that each is for, ascending.
    vectors : ndarray, shape (3, n)
        Unit vectors: x, y and z.
    texel : ndarray of int32, shape (n,)
        Texel of the light that each points into.
    weight : ndarray, shape (n,)
        Cosine over samples per steradian.
    """

    point: NDArray[np.int32]
    vectors: Array
    texel: NDArray[np.int32]
    weight: Array

    def __getitem__(self, chosen: NDArray) -> "Directions":
        return Directions(
            self.point[chosen], self.vectors[:, chosen], self.texel[chosen], self.weight[chosen]
        )


class Draw(Protocol):
    """A way of choosing light directions."""

    def __call__(self, surface: Surface, count: NDArray[np.int64]) -> Directions:
        """Directions for p points, `count` (p,) of each strategy."""


@dataclass(frozen=True)
class Combined:
    """Directions of any strategies, combined by the power heuristic.

    Parameters
    ----------
    environment : Environment
    strategies : sequence of Strategy
    power : float
        Of the heuristic.
    rays : int
        Camera rays of a pixel.
    shifts : ndarray, shape (strategies, pixels, 2)
        By which points of the unit square are rotated.
    """

    environment: Environment
    strategies: Sequence[Strategy]
    power: float
    rays: int
    shifts: Array

    def __call__(self, surface: Surface, count: NDArray[np.int64]) -> Directions:
        """Directions for p points, `count` (p,) of each strategy."""
        levels = np.unique(count).tolist()
        parts = [self._arrays(surface, np.flatnonzero(count == n), n) for n in levels]
        drawn = Directions(*(np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)))
        return drawn[np.argsort(drawn.point, kind="stable")] if len(levels) > 1 else drawn

    def _arrays(self, surface: Surface, chosen: NDArray, count: int) -> tuple[NDArray, ...]:
        """Arrays of the directions of those points that have the same number of them."""
        at = surface[chosen]
        u = unit_square(self.rays, count)[at.ray]
        points = [rotate(u, shift[at.pixel][:, None]) for shift in self.shifts]
        light, density = combine(self.strategies, points, at, self.power)
        cosine = at.cosines(light)
        point, sample = np.nonzero((cosine > 0) & (density > 0))
        vectors = light[point, sample]
        weight = cosine[point, sample] / density[point, sample]
        texel = self.environment.texel(vectors).astype(np.int32)
        return chosen[point].astype(np.int32), vectors.T, texel, weight


@cache
def unit_square(rays: int, count: int) -> Array:
    """Points of the unit square for each camera ray of a pixel, shape (rays, count, 2)."""
    points = low_discrepancy(rays * count).reshape(rays, count, 2)
    # In the order of x, so that neighbours in memory search the same part of the light.
    return np.take_along_axis(points, np.argsort(points[..., :1], axis=1), axis=1)
