"""Multiple importance sampling: several strategies, each sample weighted by who might have it."""

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.sampling.strategy import Strategy
from npfm.rendering.shading import Shading

Array = NDArray[np.float64]


def combine(
    strategies: Sequence[Strategy], points: Sequence[Array], at: Shading, power: float = 1.0
) -> tuple[Array, Array]:
    """Draw from several strategies, weighted by the power heuristic.

    Veach 1997, equation 9.13; Bagher et al. 2016, equation 21, where the power is 2. Power 1 is
    the balance heuristic.

    Parameters
    ----------
    strategies : sequence of Strategy
    points : sequence of ndarray, shape (p, m_s, 2)
        Points of the unit square for each strategy.
    at : Shading
        The p points.
    power : float
        Of the heuristic.

    Returns
    -------
    light : ndarray, shape (p, sum of m_s, 3)
    density : ndarray, shape (p, sum of m_s)
        Samples per steradian. The sum of f(light) / density estimates the integral of f.
    """
    light = np.concatenate(
        [s.sample(u, at) for s, u in zip(strategies, points, strict=True)], axis=1
    )
    numbers = [u.shape[1] for u in points]
    densities = [n * s.pdf(light, at) for s, n in zip(strategies, numbers, strict=True)]
    if power == 1:
        return light, reduce(np.add, densities)
    return light, _sharpened(np.stack(densities), numbers, power)


def _sharpened(densities: Array, numbers: Sequence[int], power: float) -> Array:
    """Samples per steradian that give the weights of the power heuristic, shape (p, m).

    `densities` (s, p, m) are those of each strategy for all samples: n_s p_s in equation 21.
    """
    source = np.repeat(np.arange(len(numbers)), numbers)
    own = np.take_along_axis(densities, source[None, None], axis=0)[0]
    # An infinite sum is a weight of 0, and a density of 0 is that of a sample that does not count.
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        return np.where(own > 0, own * ((densities / own) ** power).sum(axis=0), 0)
