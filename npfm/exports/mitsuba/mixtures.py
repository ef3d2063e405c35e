"""Strategies that choose a distribution first, with that of the cosine among them, for Mitsuba.

As in `npfm.exports.mitsuba.samplers`, each has the numbers of its strategy and draws one direction.
"""

from abc import ABC, abstractmethod
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from npfm.errors import NpfmError
from npfm.exports.mitsuba.angles import azimuth_between, elevation, mirrored, turned
from npfm.exports.mitsuba.arrays import bin_of, buffer, drawn, take
from npfm.reflectance.half_difference import HALF_PI
from npfm.rendering.sampling.blinn_phong import BlinnPhongSampling
from npfm.rendering.sampling.factored import LEAST_AZIMUTH, FactoredSampling
from npfm.rendering.sampling.lafortune import LEAST_HEIGHT, LafortuneSampling
from npfm.rendering.sampling.shares import LEAST_COSINE


class Mixture(ABC):
    """Distributions, and the cosine's as the last, which are chosen by what they reflect.

    Parameters
    ----------
    diffuse : float
        What the Lambertian part reflects.
    """

    def __init__(self, diffuse: float):
        # Not NumPy's, whose double precision would spread to all that it meets.
        self.diffuse = float(diffuse)

    def sample(self, view: Any, choice: Any, u: Any) -> Any:
        """Light direction: the first number of `u` chooses the distribution as well."""
        shares = self._shares(view)
        term, part, before = mi.UInt32(len(shares) - 1), mi.Float(u.x), mi.Float(0)
        for k, share in enumerate(shares):
            inside = (u.x >= before) & (u.x < before + share)
            term = dr.select(inside, mi.UInt32(k), term)
            part = dr.select(inside, (u.x - before) / dr.maximum(share, 1e-30), part)
            before = before + share
        last = term == len(shares) - 1
        own = dr.select(last, mi.UInt32(0), term)
        part = dr.clip(part, 0, 1)
        cosine = turned(view, dr.safe_sqrt(1 - part), dr.sqrt(part), 2 * dr.pi * u.y)
        return dr.select(last, cosine, self._draw(view, own, part, u.y))

    def pdf(self, view: Any, light: Any) -> Any:
        """Density in 1/sr."""
        *shares, cosine = self._shares(view)
        total = cosine * light.z / dr.pi
        for share, density in zip(shares, self._densities(view, light), strict=True):
            total = total + share * density
        return dr.select(light.z > 0, total, 0.0)

    def _shares(self, view: Any) -> list[Any]:
        """Probabilities of the distributions, as `npfm.rendering.sampling.shares` has them."""
        energy = self._energies(view)
        rest = sum(energy)
        some = rest > 0
        cosine = dr.select(some, self.diffuse / dr.select(some, rest + self.diffuse, 1.0), 1.0)
        cosine = dr.maximum(cosine, LEAST_COSINE)
        each = [e / dr.select(some, rest, 1.0) * (1 - cosine) for e in energy]
        return [*each, cosine]

    @abstractmethod
    def _energies(self, view: Any) -> list[Any]:
        """What each distribution reflects of even light."""

    @abstractmethod
    def _draw(self, view: Any, term: Any, part: Any, v: Any) -> Any:
        """Light direction of one of the distributions, of two uniform numbers."""

    @abstractmethod
    def _densities(self, view: Any, light: Any) -> list[Any]:
        """Density of each distribution in 1/sr."""


class Lafortune(Mixture):
    """`npfm.rendering.sampling.lafortune`."""

    def __init__(self, strategy: LafortuneSampling):
        super().__init__(strategy.diffuse)
        self.lobes = [
            tuple(map(float, lobe))
            for lobe in zip(strategy.rho_s, strategy.n, strategy.C_xy, strategy.C_z, strict=True)
        ]
        self.exponents = buffer(1 / (strategy.n + 1))

    def _axes(self, view: Any) -> list[tuple[Any, Any]]:
        """Axis of each lobe, and the largest base that it has."""
        found = []
        for _, _, across, up in self.lobes:
            axis = mi.Vector3f(across * view.x, across * view.y, up * view.z)
            length = dr.norm(axis)
            some = length > 0
            axis = dr.select(some, axis / dr.select(some, length, 1.0), mi.Vector3f(0, 0, 1))
            found.append((axis, length))
        return found

    def _energies(self, view: Any) -> list[Any]:
        return [
            2 * dr.pi * rho * length**n * dr.maximum(axis.z, LEAST_HEIGHT) / (n + 1)
            for (rho, n, _, _), (axis, length) in zip(self.lobes, self._axes(view), strict=True)
        ]

    def _draw(self, view: Any, term: Any, part: Any, v: Any) -> Any:
        axes = [axis for axis, _ in self._axes(view)]
        axis = axes[0]
        for k, other in enumerate(axes[1:], 1):
            axis = dr.select(term == k, other, axis)
        z = part ** take(self.exponents, term)
        level = dr.safe_sqrt(1 - dr.square(z))
        sine, cosine = dr.sincos(2 * dr.pi * v)
        return mi.Frame3f(axis).to_world(mi.Vector3f(level * cosine, level * sine, z))

    def _densities(self, view: Any, light: Any) -> list[Any]:
        return [
            (n + 1) / (2 * dr.pi) * dr.clip(dr.dot(light, axis), 0, 1) ** n
            for (_, n, _, _), (axis, _) in zip(self.lobes, self._axes(view), strict=True)
        ]


class BlinnPhong(Mixture):
    """`npfm.rendering.sampling.blinn_phong`."""

    def __init__(self, strategy: BlinnPhongSampling):
        super().__init__(strategy.diffuse)
        lobes = zip(strategy.rho_s, strategy.n, strategy.F_0, strict=True)
        self.lobes = [tuple(map(float, lobe)) for lobe in lobes]
        self.exponents = buffer(1 / (strategy.n + 1))

    def _energies(self, view: Any) -> list[Any]:
        grazing = (1 - view.z) ** 5
        return [
            8 * dr.pi * rho * (F_0 + (1 - F_0) * grazing) / (n + 1) for rho, n, F_0 in self.lobes
        ]

    def _draw(self, view: Any, term: Any, part: Any, v: Any) -> Any:
        z = part ** take(self.exponents, term)
        return mirrored(view, 1 - dr.square(z), 2 * dr.pi * v)

    def _densities(self, view: Any, light: Any) -> list[Any]:
        half = view + light
        length = dr.norm(half)
        z = dr.clip(half.z / length, 0, 1)
        return [(n + 1) / (4 * dr.pi * length) * z**n for _, n, _ in self.lobes]


class Factored(Mixture):
    """`npfm.rendering.sampling.factored`, of factors whose azimuths are counted from the view's.

    Heights are kept as 1 - cos(theta), which float32 resolves where half vectors are near the
    normal.

    Raises
    ------
    NpfmError
        If the factors have azimuths of the view.
    """

    def __init__(self, strategy: FactoredSampling):
        super().__init__(strategy.diffuse)
        self.angles = strategy.angles
        if not self.angles.relative:
            raise NpfmError("factors with azimuths of the view do not run in Mitsuba; take one")
        self.count, (self.views, _, self.n, self.m) = len(strategy.terms), self.angles.shape
        self.terms = buffer(strategy.terms)
        self.depths = buffer(2 * np.sin(self.angles.edges / 2) ** 2)
        self.U, self.V = (buffer(table[:, 1:]) for table in strategy.cumulative)
        self.in_angle, self.in_azimuth = (buffer(table) for table in strategy.density)

    def _bin(self, theta: Any) -> Any:
        share = theta / HALF_PI
        return bin_of(dr.sqrt(share) if self.angles.jacobian else share, self.n)

    def _reach(self, view: Any, term: Any) -> Any:
        """How much of the angles of a term counts."""
        if not self.angles.jacobian:
            return mi.Float(1)
        limit = (HALF_PI + elevation(view)) / 2
        k = self._bin(limit)
        low, high = take(self.depths, k), take(self.depths, k + 1)
        place = (2 * dr.square(dr.sin(limit / 2)) - low) / (high - low)
        return _between(self.U, term * self.n, k, dr.clip(place, 0, 1))

    def _window(self, view: Any, theta: Any, term: Any) -> tuple[Any, Any]:
        """Where the azimuths that count begin in a cumulative distribution, and their share."""
        if not self.angles.jacobian:
            limit = mi.Float(dr.pi)
        else:
            sine, cosine = dr.sincos(2 * theta)
            level = dr.sqrt(dr.square(view.x) + dr.square(view.y))
            ratio = -cosine * view.z / dr.maximum(sine * level, 1e-12)
            limit = dr.maximum(dr.acos(dr.clip(ratio, -1, 1)), LEAST_AZIMUTH)
        turn = limit / (2 * dr.pi)
        low = self._turned(term, 1 - turn) - 1
        return low, self._turned(term, turn) - low

    def _turned(self, term: Any, turn: Any) -> Any:
        place = turn * self.m
        b = bin_of(turn, self.m)
        return _between(self.V, term * self.m, b, place - b)

    def _energies(self, view: Any) -> list[Any]:
        place = dr.clip(elevation(view) / HALF_PI * self.views - 0.5, 0, self.views - 1)
        k = dr.minimum(mi.UInt32(place), max(self.views - 2, 0))
        after, up = dr.minimum(k + 1, self.views - 1), place - k
        found = []
        for term in range(self.count):
            start = term * self.views
            below, above = take(self.terms, start + k), take(self.terms, start + after)
            found.append((below + up * (above - below)) * self._reach(view, mi.UInt32(term)))
        return found

    def _draw(self, view: Any, term: Any, part: Any, v: Any) -> Any:
        k, place = drawn(self.U, term * self.n, self.n, part * self._reach(view, term))
        low, high = take(self.depths, k), take(self.depths, k + 1)
        depth = low + place * (high - low)
        square = depth * (2 - depth)
        start, width = self._window(view, dr.atan2(dr.safe_sqrt(square), 1 - depth), term)
        share = start + v * width
        share = dr.select(share < 0, share + 1, share)
        b, across = drawn(self.V, term * self.m, self.m, share)
        azimuth = (b + across) * (2 * dr.pi / self.m)
        if self.angles.half:
            return mirrored(view, square, azimuth)
        return turned(view, 1 - depth, dr.safe_sqrt(square), azimuth)

    def _densities(self, view: Any, light: Any) -> list[Any]:
        p = view + light if self.angles.half else light
        jacobian = 1 / (2 * dr.norm(p)) if self.angles.half else 1.0
        theta = elevation(p)
        turn = azimuth_between(view, p) / (2 * dr.pi)
        k, b = self._bin(theta), bin_of(turn - dr.floor(turn), self.m)
        found = []
        for number in range(self.count):
            term = mi.UInt32(number)
            width = self._window(view, theta, term)[1]
            density = take(self.in_angle, term * self.n + k)
            density = density * take(self.in_azimuth, term * self.m + b)
            found.append(density * jacobian / (width * self._reach(view, term)))
        return found


def _between(cumulative: Any, start: Any, k: Any, place: Any) -> Any:
    """Cumulative distribution at a place, from 0 to 1, in its bin k."""
    upper = take(cumulative, start + k)
    lower = dr.select(k > 0, take(cumulative, start + dr.maximum(k, 1) - 1), 0.0)
    return lower + place * (upper - lower)
