"""Strategies of `npfm.rendering.sampling` as Mitsuba runs them: the same densities, path by path.

A strategy has its numbers from a table or a fit; what is here turns its arrays into buffers, and
samples and evaluates one direction where the strategy does many. Directions are over a surface with
the normal z, away from it.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Protocol

import drjit as dr
import mitsuba as mi
import numpy as np

from npfm.errors import NpfmError, suggest
from npfm.exports.mitsuba.angles import azimuth_between, elevation, mirrored, turned
from npfm.exports.mitsuba.arrays import bin_of, buffer, drawn, take
from npfm.exports.mitsuba.mixtures import BlinnPhong, Factored, Lafortune
from npfm.reflectance.half_difference import HALF_PI
from npfm.rendering.sampling import (
    blinn_phong,
    cosine,
    factored,
    lafortune,
    normal_distribution,
    per_view,
)
from npfm.rendering.sampling.per_view import PerViewSampling
from npfm.rendering.sampling.quantiles import QuantileSampling
from npfm.rendering.sampling.strategy import Strategy


class Sampler(Protocol):
    """A way of choosing a direction of light for a view."""

    def sample(self, view: Any, choice: Any, u: Any) -> Any:
        """Light direction, of a number `choice` and a point `u` of the unit square."""

    def pdf(self, view: Any, light: Any) -> Any:
        """Density in 1/sr; below the horizon it may be 0 though samples fall there."""


class Cosine:
    """`npfm.rendering.sampling.cosine`."""

    def sample(self, view: Any, choice: Any, u: Any) -> Any:
        """Light direction."""
        return mi.warp.square_to_cosine_hemisphere(u)

    def pdf(self, view: Any, light: Any) -> Any:
        """Density in 1/sr."""
        return dr.maximum(light.z, 0) / dr.pi


class Quantiles:
    """`npfm.rendering.sampling.quantiles`, and `normal-distribution`, which chooses its D."""

    def __init__(self, strategy: QuantileSampling):
        surface = strategy.surface
        self.bins = len(surface.D)
        self.squares, self.cumulative = buffer(surface.squares), buffer(strategy.quantiles)
        self.density = buffer(surface.D / (np.pi * strategy.total))

    def sample(self, view: Any, choice: Any, u: Any) -> Any:
        """Light direction."""
        k, part = drawn(self.cumulative, 0, self.bins, u.x)
        lower = take(self.squares, k)
        square = lower + part * (take(self.squares, k + 1) - lower)
        return mirrored(view, square, 2 * dr.pi * u.y)

    def pdf(self, view: Any, light: Any) -> Any:
        """Density in 1/sr."""
        half = view + light
        length = dr.norm(half)
        k = bin_of(dr.sqrt(elevation(half) / HALF_PI), self.bins)
        # The length is 2 cos(theta_d), and half.z is that times cos(theta_h).
        density = take(self.density, k) * half.z / (2 * dr.square(length))
        return dr.select(light.z > 0, density, 0.0)


class PerView:
    """`npfm.rendering.sampling.per_view`."""

    def __init__(self, strategy: PerViewSampling):
        mass = strategy.density * per_view._solid_angle()[:, None]
        self.slices, self.rows, self.columns = mass.shape
        self.density = buffer(strategy.density)
        self.in_rows = buffer(_cumulative(mass.sum(axis=2)))
        self.in_columns = buffer(_cumulative(mass))
        self.edges = buffer(np.cos(np.arange(self.rows + 1) / self.rows * HALF_PI))

    def sample(self, view: Any, choice: Any, u: Any) -> Any:
        """Light direction."""
        k = self._slice(view)
        row, down = drawn(self.in_rows, k * self.rows, self.rows, u.x)
        start = (k * self.rows + row) * self.columns
        column, across = drawn(self.in_columns, start, self.columns, u.y)
        lower = take(self.edges, row)
        z = lower + down * (take(self.edges, row + 1) - lower)
        azimuth = (column + across - 0.5) * (2 * dr.pi / self.columns)
        return turned(view, z, dr.safe_sqrt(1 - dr.square(z)), azimuth)

    def pdf(self, view: Any, light: Any) -> Any:
        """Density in 1/sr."""
        row = bin_of(elevation(light) / HALF_PI, self.rows)
        turn = azimuth_between(view, light) / (2 * dr.pi) + 0.5 / self.columns
        column = bin_of(turn - dr.floor(turn), self.columns)
        index = (self._slice(view) * self.rows + row) * self.columns + column
        return dr.select(light.z > 0, take(self.density, index), 0.0)

    def _slice(self, view: Any) -> Any:
        return bin_of(elevation(view) / HALF_PI, self.slices)


class WithCosine:
    """A sampler of which a share follows the cosine, so that no light is out of its reach."""

    def __init__(self, sampler: Sampler, share: float):
        self.sampler, self.cosine, self.share = sampler, Cosine(), share

    def sample(self, view: Any, choice: Any, u: Any) -> Any:
        """Light direction."""
        rest = (choice - self.share) / max(1 - self.share, 1e-6)
        own = self.sampler.sample(view, dr.clip(rest, 0, 1 - 1e-7), u)
        return dr.select(choice < self.share, self.cosine.sample(view, choice, u), own)

    def pdf(self, view: Any, light: Any) -> Any:
        """Density in 1/sr."""
        own = self.sampler.pdf(view, light)
        return self.share * self.cosine.pdf(view, light) + (1 - self.share) * own


def _cumulative(mass: np.ndarray) -> np.ndarray:
    summed = np.cumsum(mass, axis=-1)
    return summed / summed[..., -1:]


#: What runs each strategy that Mitsuba knows, by its name.
TWINS: Mapping[str, Callable[[Any], Sampler]] = MappingProxyType(
    {
        cosine.NAME: lambda strategy: Cosine(),
        normal_distribution.NAME: Quantiles,
        per_view.NAME: PerView,
        factored.NAME: Factored,
        lafortune.NAME: Lafortune,
        blinn_phong.NAME: BlinnPhong,
    }
)


def check(name: str) -> None:
    """Raise an NpfmError if there is nothing that runs the strategy of that name."""
    if name not in TWINS:
        raise NpfmError(f"no sampler '{name}' in Mitsuba; {suggest(name, TWINS)}")


def twin(name: str, strategy: Strategy, share: float) -> Sampler:
    """Make what runs a strategy in Mitsuba.

    A share of the directions is by the cosine where the strategy itself leaves some light out.
    """
    sampler = TWINS[name](strategy)
    return WithCosine(sampler, share) if share > 0 and isinstance(sampler, Quantiles) else sampler
