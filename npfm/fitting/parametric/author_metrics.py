"""What the authors of parametric models minimise, as sums of squares over the cells of a table."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import Samples, solid_angles
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference

#: Ngan et al. leave light and view directions beyond it out, Loew et al. theta_h and theta_d.
AUTHORS_LIMIT = np.deg2rad(80)


@dataclass(frozen=True)
class Goal:
    """A measurement to be met: the sum of weight (T(model) - T(value))^2 is to be least.

    Parameters
    ----------
    weight, value : ndarray, shape (channels,) + grid.shape
        Weights, 0 where a sample does not count, and BRDF in units of `scale`.
    scale : ndarray, shape (channels,)
        In 1/sr.
    logarithmic : bool
        Whether T is log(1 + cos(theta_i) x), else it is x itself.
    grid : HalfDifference or Directional
        Where the samples lie.
    """

    weight: NDArray[np.float64]
    value: NDArray[np.float64]
    scale: NDArray[np.float64]
    logarithmic: bool
    grid: HalfDifference | Directional


Metric = Callable[[Sequence[Samples]], Goal]


def compressive(samples: Sequence[Samples]) -> Goal:
    """Bagher et al. 2016, equation 7, each channel as a share of the zero model's."""
    weight = np.stack([s.weight / (s.energy or 1.0) for s in samples])
    value, scale = _stacked(samples)
    return Goal(weight, value, scale, False, samples[0].grid)


def cosine(samples: Sequence[Samples]) -> Goal:
    """Sum of squared differences of cos(theta_i) x, for theta_i and theta_o to 80 degrees.

    The metric of Ngan et al. 2005, weighted by solid angle, all channels in one sum.
    """
    grid = samples[0].grid
    cos_i, cos_o = grid.cosines
    inside = np.minimum(cos_i, cos_o) >= np.cos(AUTHORS_LIMIT)
    weight = np.where(inside, solid_angles(grid) * cos_i**2, 0.0)
    value, scale = _stacked(samples)
    common = scale.max()
    value *= (scale / common)[:, None, None, None]
    weight = np.stack([np.where(s.weight > 0, weight, 0.0) for s in samples])
    weight /= np.sum(weight * value**2) or 1.0
    return Goal(weight, value, np.full_like(scale, common), False, grid)


def logarithmic(samples: Sequence[Samples]) -> Goal:
    """Sum of squared differences of log(1 + cos(theta_i) x), for theta_h, theta_d to 80 degrees.

    The metric E2 of Loew et al. 2012 (equations 31 and 32 there), in the words of Bagher et al.
    2016, section 2; x is the BRDF in 1/sr. The weight, which is not described there, is that of
    solid angle: the published fits are nearest to a minimum of this sum, compared with one in
    which cells count the same, or by the volume form.
    """
    grid = samples[0].grid
    inside = (grid.theta_h[:, None, None] <= AUTHORS_LIMIT) & (
        grid.theta_d[:, None] <= AUTHORS_LIMIT
    )
    value, scale = _stacked(samples)
    value *= scale[:, None, None, None]
    weight = np.where(inside, solid_angles(grid), 0.0)
    weight = np.stack([np.where(s.weight > 0, weight, 0.0) for s in samples])
    return Goal(weight, value, np.ones_like(scale), True, grid)


def _stacked(samples: Sequence[Samples]) -> tuple[NDArray, NDArray]:
    return np.stack([s.value for s in samples]), np.array([s.scale for s in samples])
