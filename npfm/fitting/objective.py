"""The fitting objective: which samples count, how much, and the sums that follow from it.

Bagher et al. 2016, section 4.1: E = sum_j w_j (rho_j - rho*_j)^2 with w = w_V w_I w_C.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from npfm.errors import NpfmError, suggest
from npfm.reflectance.directional import Directional
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, G, Table

#: Power of the compressive weight and steepness of the compressive function (section 4.1).
COMPRESSION_POWER = 1.4
COMPRESSION_ALPHA = np.log(2)
#: How much a cell of a table counts: by the 2016 paper's volume form (equation 9), or by the solid
#: angles of light and view that it stands for, as the eye sees them.
VOLUME_FORM = "volume-form"
CELLS = (VOLUME_FORM, "solid-angle")
#: Samples of no more than this share of the largest are black beside it: twice the decades that
#: the measured materials have.
BLACK = 1e-12
#: Samples that differ by no more than this share count as equal.
EQUAL = 1e-12


@dataclass(frozen=True)
class Objective:
    """What is minimised.

    Parameters
    ----------
    compressive : bool
        Whether the compressive weight (equation 11) is in the product; off for Figure 7.
    max_angle : float
        Largest theta_i and theta_o that count, in degrees.
    cells : str
        What w_V is on a half-difference grid, of `CELLS`; on others it is the solid angle.

    Raises
    ------
    NpfmError
        If the angle is not above 0 and below 90, or the weight of cells is unknown.
    """

    compressive: bool = True
    max_angle: float = 89.0
    cells: str = VOLUME_FORM

    def __post_init__(self) -> None:
        if self.cells not in CELLS:
            raise NpfmError(f"unknown weight of cells '{self.cells}'; {suggest(self.cells, CELLS)}")
        if not 0 < self.max_angle < 90:
            raise NpfmError(
                f"the largest angle that counts cannot be {self.max_angle:g} degrees; "
                "give a number above 0 and below 90"
            )


@dataclass(frozen=True)
class Samples(Generic[G]):
    """Weighted samples of one channel, in units of the channel's `scale`.

    Parameters
    ----------
    weight : ndarray, shape grid.shape
        w of equation 8, 0 where a sample does not count.
    value : ndarray, the same shape
        Measured BRDF divided by `scale`, 0 where a sample does not count.
    scale : float
        The weighted median (1/sr), that of what is not black where most is: fits work on numbers
        around 1. 1 where all is 0.
    floor : float
        Part of the objective that folding has taken out (0 before folding).
    grid : Grid
        Where the samples lie; folded samples on a half-difference grid keep the first half of its
        phi_d bins.
    """

    weight: NDArray[np.float64]
    value: NDArray[np.float64]
    scale: float
    floor: float
    grid: G

    @cached_property
    def energy(self) -> float:
        """Objective of the model that is 0 everywhere; relative objectives are shares of it."""
        return self.floor + float(np.vdot(self.weight, self.value**2))


def volume_form(grid: HalfDifference) -> NDArray[np.float64]:
    """Weight w_V of each cell: the volume form of (theta_h', theta_d, phi_d) space.

    Bagher et al. 2016, equation 9, times the factor 2 sqrt(theta_h) of d(theta_h) where bins are
    uniform in sqrt(theta_h) (equation 6; the paper's text drops a root). Global constants are
    left out.

    Returns
    -------
    ndarray, shape grid.shape
    """
    sin_d, cos_d = np.sin(grid.theta_d)[:, None], np.cos(grid.theta_d)[:, None]
    spread = np.sqrt(8 * sin_d**2 * (cos_d**2 + sin_d**2 * np.cos(grid.phi_d) ** 2))
    return 2 * np.sqrt(grid.theta_h)[:, None, None] * spread


def solid_angles(grid: Grid) -> NDArray[np.float64]:
    """Weight w_V of each cell by the solid angles of light and view that it stands for.

    On a half-difference grid 4 cos(theta_d) sin(theta_d) sin(theta_h) d(theta_h) d(theta_d)
    d(phi_d), with the d(theta_h) of bins uniform in sqrt(theta_h). On a directional one each
    elevation stands for half the way to its neighbours, the first for a cap around the normal.
    Global constants are left out.

    Returns
    -------
    ndarray, shape grid.shape
    """
    if isinstance(grid, HalfDifference):
        theta_h, theta_d = grid.theta_h[:, None, None], grid.theta_d[:, None]
        weight = np.sqrt(theta_h) * np.sin(theta_h) * np.sin(2 * theta_d)
        return np.broadcast_to(weight, grid.shape)
    if not isinstance(grid, Directional):
        raise TypeError(f"no weights are known for {grid.name}")
    shares = []
    for theta in (grid.theta_i, grid.theta_o):
        step = np.pi / 2 / len(theta)
        shares.append(np.cos(np.maximum(theta - step / 2, 0)) - np.cos(theta + step / 2))
    return np.broadcast_to(shares[0][:, None, None, None] * shares[1][:, None], grid.shape)


def importance(grid: Grid) -> NDArray[np.float64]:
    """Weight w_I = cos(theta_i) cos(theta_o) of each cell, 0 below the horizon (equation 10)."""
    cos_i, cos_o = grid.cosines
    return np.maximum(cos_i, 0) * np.maximum(cos_o, 0)


@lru_cache(maxsize=2)
def _geometric_weight(grid: Grid, max_angle: float, cells: str) -> NDArray[np.float64]:
    """w_V w_I of the cells that count, 0 elsewhere."""
    if isinstance(grid, HalfDifference) and cells == VOLUME_FORM:
        volume = volume_form(grid)
    else:
        volume = solid_angles(grid)
    return np.where(counted(grid, max_angle), volume * importance(grid), 0.0)


def compressive_weight(relative: NDArray) -> NDArray[np.float64]:
    """Weight w_C of samples given in units of the weighted median.

    Bagher et al. 2016, equations 11 and 12: ((1 - exp(-alpha x)) / (alpha x))^p, which is 1 at
    x = 0 and falls to 0 as x grows.
    """
    exponent = COMPRESSION_ALPHA * np.asarray(relative, dtype=float)
    safe = np.where(exponent > 0, exponent, 1.0)
    share = np.where(exponent > 0, compressed(safe, 1.0) / safe, 1.0)
    return share**COMPRESSION_POWER


def compressed(x: ArrayLike, alpha: float = COMPRESSION_ALPHA) -> NDArray[np.float64]:
    """Compressive function f(x; alpha) = (1 - exp(-alpha x)) / alpha (equation 12).

    Bagher et al. 2016; it maps non-negative numbers to [0, 1 / alpha), and with the default alpha
    1 to the middle of that.
    """
    return -np.expm1(-alpha * np.asarray(x)) / alpha


def weighted_median(value: NDArray, weight: NDArray) -> float:
    """Smallest value at which at least half of the weight is reached.

    Parameters
    ----------
    value, weight : ndarray, the same shape
        Weights are non-negative; samples of weight 0 do not count.

    Raises
    ------
    ValueError
        If all weights are 0.
    """
    counts = weight > 0
    value, weight = value[counts], weight[counts]
    if value.size == 0:
        raise ValueError("the weighted median of no samples is not defined")
    order = np.argsort(value)
    reached = np.cumsum(weight[order])
    return float(value[order][np.searchsorted(reached, reached[-1] / 2)])


def counted(grid: Grid, max_angle: float) -> NDArray[np.bool_]:
    """Cells whose theta_i and theta_o are both at most `max_angle` degrees (section 4.1)."""
    lowest = np.cos(np.deg2rad(max_angle))
    cos_i, cos_o = grid.cosines
    return (cos_i >= lowest) & (cos_o >= lowest) & grid.above_horizon


def channel_samples(table: Table, channel: int, objective: Objective) -> Samples:
    """Weighted samples of one channel of a table.

    Parameters
    ----------
    table : Table
        Measured BRDF in 1/sr, negative where not measured.
    channel : int
        0, 1 or 2.
    objective : Objective
        Which samples count and how.

    Raises
    ------
    NpfmError
        If an entry of the channel is NaN or infinite, or no sample of it counts.
    """
    measured = table.values[channel]
    if not np.isfinite(measured).all():
        raise NpfmError(
            f"the {CHANNELS[channel]} channel has entries that are NaN or infinite; mark missing "
            "samples with a negative value, as MERL does"
        )
    weight = _geometric_weight(table.grid, objective.max_angle, objective.cells)
    usable = (weight > 0) & (measured >= 0)
    if not usable.any():
        raise NpfmError(
            f"the {CHANNELS[channel]} channel has no valid sample at theta_i and theta_o up to "
            f"{objective.max_angle:g} degrees; nothing can be fitted to it"
        )
    value = np.where(usable, measured, 0.0)
    weight = np.where(usable, weight, 0.0)
    scale = _typical(value, weight)
    value = value / scale
    if objective.compressive:
        weight = weight * compressive_weight(value)
    return Samples(weight, value, scale, 0.0, table.grid)


def _typical(value: NDArray, weight: NDArray) -> float:
    """Weighted median: of the samples that are not black if it is black itself; 1 if all are 0.

    So a table times c has c times this unit however dark most of it is, and no sample has more
    than 1 / BLACK units, whose square is far from the end of double precision.
    """
    threshold = BLACK * value.max()
    median = weighted_median(value, weight)
    if median <= threshold and threshold > 0:
        median = weighted_median(value, np.where(value > threshold, weight, 0.0))
    return median or 1.0


def fold(samples: Samples) -> Samples:
    """Merge each sample with the one that has light and view exchanged.

    A reciprocal model takes the same value m at phi_d and pi - phi_d, and
    w1 (m - r1)^2 + w2 (m - r2)^2 = (w1 + w2) (m - r)^2 + w1 w2 (r1 - r2)^2 / (w1 + w2) with r the
    weighted mean. The objective is the same to rounding, on half the samples; the last term
    is what no reciprocal model can remove, and goes into `floor`.

    Returns
    -------
    Samples
        With weight and value of shape (theta_h, theta_d, phi_d / 2). On a directional grid the
        shape stays, and a sample is where the light comes first; there is nothing to merge where
        light and view have other directions.
    """
    if isinstance(samples.grid, Directional):
        return _fold_directional(samples)
    half = samples.value.shape[-1] // 2
    w1, w2 = samples.weight[..., :half], samples.weight[..., : half - 1 : -1]
    r1, r2 = samples.value[..., :half], samples.value[..., : half - 1 : -1]
    weight, value, floor = _merged(w1, w2, r1, r2)
    return Samples(weight, value, samples.scale, samples.floor + floor, samples.grid)


def _fold_directional(samples: Samples) -> Samples:
    shape = samples.weight.shape
    if shape[:2] != shape[2:]:
        return samples
    weight, value = (a.reshape(shape[0] * shape[1], -1) for a in (samples.weight, samples.value))
    # Light and view in one direction are a pair by themselves, which counts once.
    w1, w2 = np.triu(weight), np.triu(weight.T, 1)
    weight, value, floor = _merged(w1, w2, value, value.T)
    scale, before, grid = samples.scale, samples.floor, samples.grid
    return Samples(weight.reshape(shape), value.reshape(shape), scale, before + floor, grid)


def _merged(
    w1: NDArray, w2: NDArray, r1: NDArray, r2: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Weights and values of merged samples, and the part of the objective that stays."""
    weight = w1 + w2
    safe = np.where(weight > 0, weight, 1.0)
    floor = float(np.sum(w1 * (w2 / safe) * (r1 - r2) ** 2))
    return weight, (w1 * r1 + w2 * r2) / safe, floor


def degeneracy(samples: Samples) -> str | None:
    """What makes many fits of folded samples equally good, in words for the status, or None."""
    counts, top = samples.weight > 0, samples.value.max()
    number = np.count_nonzero(counts)
    if number == 1:
        return "one sample"
    if top == 0:
        return "every sample is 0"
    if np.count_nonzero(samples.value >= (1 - EQUAL) * top) == number and (
        samples.floor <= EQUAL * samples.energy
    ):
        return "all samples are equal"
    if isinstance(samples.grid, Directional):
        return None
    seen = np.any(counts, axis=-1)
    for axis, name in ((1, "theta_h"), (0, "theta_d")):
        if np.count_nonzero(np.any(seen, axis=axis)) == 1:
            return f"samples in one bin of {name} only"
    return None


def evaluate(samples: Samples, model: NDArray) -> float:
    """Objective of model values, summed sample by sample (equation 7).

    Parameters
    ----------
    samples : Samples
        The measurements.
    model : ndarray, shape of samples.weight
        Model values in units of samples.scale.
    """
    return samples.floor + float(np.sum(samples.weight * (model - samples.value) ** 2))
