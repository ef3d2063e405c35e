"""How noisy an estimate of a picture is, by the way in which its light directions are chosen.

What each pixel integrates is the light, times BRDF and cosine, in luminance. The variance of an
estimate falls with the number of its samples; `n_var` is that number, times the variance in the
mean over the pixels, over the mean square of the picture. One sample at a time it is the variance
of a single sample, and the same for any number.
"""

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.grids import components
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import LUMINANCE, Environment
from npfm.rendering.sampling.combination import combine
from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate
from npfm.rendering.sampling.strategy import Strategy
from npfm.rendering.shading import Shading

Array = NDArray[np.float64]

#: Samples treated at once, at about a kilobyte of working memory each.
BLOCK = 1 << 17
#: Sets of shared points whose spread tells how sure the variance of one sample is.
BATCHES = 16


@dataclass(frozen=True)
class Integral:
    """What is integrated at each point: reflected light, by the direction that it came from.

    Parameters
    ----------
    at : Shading
        The p points.
    environment : Environment
    table : Table
        The material; negative entries reflect nothing.
    """

    at: Shading
    environment: Environment
    table: Table

    def __len__(self) -> int:
        return len(self.at)

    def __getitem__(self, part: slice) -> "Integral":
        return Integral(self.at[part], self.environment, self.table)

    def __call__(self, light: Array) -> Array:
        """Luminance per steradian (p, m) from directions `light` (p, m, 3); 0 from below."""
        grid, at = self.table.grid, self.at
        axes = grid.axes(at.normal, at.view, at.tangent)
        along = light @ np.stack(axes, axis=-1)
        point, sample = np.nonzero(along[..., 0] > 0)
        along = along[point, sample]
        index, share = grid.cells(along, components(at.view, axes), point)
        brdf = np.maximum(self.table.values.reshape(3, -1)[:, index], 0)
        if share is not None:
            brdf = (brdf * share).sum(axis=-1)
        radiance = self.environment.lookup(light[point, sample])
        reflected = np.zeros(light.shape[:2])
        reflected[point, sample] = ((radiance * LUMINANCE).T * brdf).sum(axis=0) * along[:, 0]
        return reflected


@dataclass(frozen=True)
class Combined:
    """Strategies that share the samples of an estimate evenly, by the power heuristic.

    Veach 1997, equation 9.13; Bagher et al. 2016, equations 20 and 21.
    """

    strategies: tuple[str, ...]
    power: float = 1.0

    def weights(self, densities: Mapping[str, Array]) -> Array:
        """Weights of the strategies' samples, by direction: (s, p, m), the sum 1 or 0."""
        own = np.stack([densities[name] for name in self.strategies])
        largest = own.max(axis=0)
        raised = (own / np.where(largest > 0, largest, 1)) ** self.power
        return raised / np.maximum(raised.sum(axis=0), 1)


def single(
    ways: Sequence[Combined],
    strategies: Mapping[str, Strategy],
    integral: Integral,
    shared: Sequence[str],
    count: int,
    seed: int,
) -> tuple[Array, Array]:
    """Variance of independent samples, of all ways at once, by points that all of them share.

    The points come from a mixture of strategies whose density is q: a mean over them, each weighted
    by 1/q, of f^2/p is the second moment of a sample of density p. Where p is small it is tails
    that count, which repeated trials with p itself miss.

    Parameters
    ----------
    ways : sequence of Combined
    strategies : mapping of str to Strategy
        By the names that the ways know them by.
    integral : Integral
    shared : sequence of str
        Strategies that the points are from.
    count : int
        Points of each of these at each pixel, in each of `BATCHES` sets.
    seed : int

    Returns
    -------
    variance : ndarray, shape (BATCHES, ways, p)
        Of an estimate, times the number of its samples.
    mean : ndarray, shape (p,)
        The integral, from all batches.
    """
    variance = np.empty((BATCHES, len(ways), len(integral)))
    mean = np.empty((BATCHES, len(integral)))
    random = np.random.default_rng(seed)
    used = dict.fromkeys(name for way in ways for name in way.strategies)
    for batch in range(BATCHES):
        shifts = random.random((len(shared), len(integral), 1, 2))
        for part in parts(len(integral), count * len(shared)):
            points = [rotate(low_discrepancy(count), shift[part]) for shift in shifts]
            f = integral[part]
            light, q = combine([strategies[name] for name in shared], points, f.at)
            weighted = np.where(q > 0, f(light) / np.where(q > 0, q, 1), 0)
            mean[batch, part] = weighted.sum(axis=1)
            densities = {name: strategies[name].pdf(light, f.at) for name in used}
            for k, way in enumerate(ways):
                variance[batch, k, part] = _moments(way, densities, weighted, q)
    return variance, mean.mean(axis=0)


def _moments(way: Combined, densities: Mapping[str, Array], weighted: Array, q: Array) -> Array:
    """Variance (p,) of an estimate, times its samples, where points carry `weighted` = f / q.

    With S strategies of n samples each that is S times the sum of the variances of w_s f / p_s.
    """
    total = np.zeros(len(q))
    for name, weight in zip(way.strategies, way.weights(densities), strict=True):
        p = densities[name]
        # f^2 / (p q) = weighted^2 q / p
        square = (weight * weighted) ** 2 * q / np.where(p > 0, p, 1)
        total += square.sum(axis=1) - (weight * weighted).sum(axis=1) ** 2
    return len(way.strategies) * total


def repeated(
    way: Combined,
    strategies: Mapping[str, Strategy],
    integral: Integral,
    samples: int,
    repetitions: int,
    seed: int,
    *,
    stratified: bool = True,
) -> tuple[Array, int, float]:
    """Estimate the integrals again and again.

    Parameters
    ----------
    way : Combined
    strategies : mapping of str to Strategy
    integral : Integral
    samples : int
        Of an estimate, rounded down to be shared evenly by the strategies.
    repetitions : int
    seed : int
    stratified : bool
        By the renderer's points (Sobol, rotated), or by independent ones.

    Returns
    -------
    estimates : ndarray, shape (repetitions, p)
    samples : int
        That an estimate has.
    seconds : float
        Of the processor, for a sample: to choose it, weight it and look up light and material.
    """
    random = np.random.default_rng(seed)
    chosen = [strategies[name] for name in way.strategies]
    count = samples // len(chosen)
    estimates = np.empty((repetitions, len(integral)))
    seconds = 0.0
    for estimate in estimates:
        for part in parts(len(integral), count * len(chosen)):
            f = integral[part]
            points = [_points(random, len(f), count, stratified) for _ in chosen]
            began = time.process_time()
            light, density = combine(chosen, points, f.at, way.power)
            reflected = f(light)
            counts = (reflected > 0) & (density > 0)
            estimate[part] = np.where(counts, reflected / np.where(counts, density, 1), 0).sum(1)
            seconds += time.process_time() - began
    used = count * len(chosen)
    return estimates, used, seconds / (used * estimates.size)


def _points(random: np.random.Generator, pixels: int, count: int, stratified: bool) -> Array:
    if not stratified:
        return random.random((pixels, count, 2))
    points = low_discrepancy(count)
    # In the order of x, as the renderer has them: neighbours search the same part of the light.
    points = points[np.argsort(points[:, 0])]
    return rotate(points, random.random((pixels, 1, 2)))


def parts(points: int, samples: int) -> Iterator[slice]:
    """Slices of points with about `BLOCK` samples each."""
    step = max(1, BLOCK // samples)
    yield from (slice(first, first + step) for first in range(0, points, step))


def interval(values: Array) -> tuple[float, float, float]:
    """Mean of values, and the ends of an interval of two standard errors on both sides of it."""
    mean, error = values.mean(), values.std(ddof=1) / np.sqrt(len(values))
    return float(mean), float(mean - 2 * error), float(mean + 2 * error)
