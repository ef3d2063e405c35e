"""Hard inputs for a fit: each function makes a table on a grid that no measurement should be like.

Docstrings say what each is; `CASES` has them by name. The target `stability` fits them on MERL's
grid, the tests on a small one.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import INVALID, Table

Array = NDArray[np.float64]


def _table(grid: HalfDifference, *channels: Array | float) -> Table:
    """Stack three channels, or one for all three; invalid below the horizon."""
    channels = channels * 3 if len(channels) == 1 else channels
    values = [np.where(grid.above_horizon, value, INVALID) for value in channels]
    return Table(np.stack(values), grid)


def _tan2(grid: HalfDifference) -> Array:
    return np.tan(grid.theta_h[:, None, None]) ** 2


def _cosines(grid: HalfDifference) -> tuple[Array, Array]:
    """Cosines of theta_i and theta_o, the least above 0 below the horizon."""
    cos_i, cos_o = (np.maximum(cosine, 1e-3) for cosine in grid.cosines)
    return cos_i, cos_o


def _fresnel(grid: HalfDifference, head_on: float) -> Array:
    """Schlick's approximation."""
    return head_on + (1 - head_on) * (1 - np.cos(grid.theta_d[:, None])) ** 5


def _glossy(grid: HalfDifference, roughness: float = 0.2) -> Array:
    """An ordinary material: a lobe that falls off as GGX does, on a diffuse part, in 1/sr."""
    lobe = 1 / (1 + _tan2(grid) / roughness**2) ** 2
    cos_i, cos_o = _cosines(grid)
    return 0.1 + lobe * _fresnel(grid, 0.3) / np.maximum(cos_i, cos_o)


def _noisy(values: Array, seed: int, share: float = 0.02) -> Array:
    return values * (1 + share * np.random.default_rng(seed).standard_normal(values.shape))


def perfect_mirror(grid: HalfDifference = MERL) -> Table:
    """All energy in the first bin of theta_h, zero elsewhere."""
    first = np.arange(grid.theta_h_bins)[:, None, None] == 0
    return _table(grid, *(1e3 * first * _fresnel(grid, head_on) for head_on in (0.9, 0.5, 0.04)))


def black(grid: HalfDifference = MERL) -> Table:
    """All zeros."""
    return _table(grid, 0.0)


def one_black_channel(grid: HalfDifference = MERL) -> Table:
    """Green is all zeros, red and blue are ordinary."""
    return _table(grid, _glossy(grid), 0.0, _glossy(grid, 0.5))


def constant(grid: HalfDifference = MERL) -> Table:
    """Lambertian: D, F, G and rho_d, rho_s cannot be told apart."""
    return _table(grid, 0.8 / np.pi, 0.3 / np.pi, 1e-4 / np.pi)


def twelve_decades(grid: HalfDifference = MERL) -> Table:
    """From 1e-6 to 1e6 1/sr along theta_h."""
    fall = 10.0 ** np.linspace(6, -6, grid.theta_h_bins)[:, None, None]
    values = fall * _fresnel(grid, 0.5)
    return _table(grid, values, _noisy(values, 1), fall[::-1] * np.ones(grid.shape))


def all_of_double_precision(grid: HalfDifference = MERL) -> Table:
    """From 1e-300 to 1e30 1/sr: along theta_h, at random, and nothing between the two."""
    fall = 10.0 ** np.linspace(30, -300, grid.theta_h_bins)[:, None, None]
    rng = np.random.default_rng(3)
    scattered = 10.0 ** rng.uniform(-300, 30, grid.shape)
    ends = np.where(rng.random(grid.shape) < 0.1, 1e30, 1e-300)
    return _table(grid, fall, scattered, ends)


def too_dark_to_store(grid: HalfDifference = MERL) -> Table:
    """Around 1e-300 1/sr everywhere, which float32 cannot hold."""
    return _table(grid, 1e-300 * _glossy(grid))


def single_sample(grid: HalfDifference = MERL) -> Table:
    """One valid sample a channel."""
    values = np.full((3, *grid.shape), INVALID)
    h, d, p = grid.theta_h_bins // 6, grid.theta_d_bins // 4, grid.phi_d_bins // 7
    values[:, h, d, p] = [0.5, 1.0, 2.0]
    return Table(values, grid)


def one_theta_h_row(grid: HalfDifference = MERL) -> Table:
    """Samples in one bin of theta_h only."""
    row = np.arange(grid.theta_h_bins)[:, None, None] == grid.theta_h_bins // 3
    glossy = _glossy(grid)
    values = (_noisy(glossy, seed) for seed in range(3))
    return _table(grid, *(np.where(row, value, INVALID) for value in values))


def nan_entries(grid: HalfDifference = MERL) -> Table:
    """An ordinary material with a few NaN."""
    return _table(grid, np.where(_some(grid, 4, 0.01), np.nan, _glossy(grid)))


def infinite_entries(grid: HalfDifference = MERL) -> Table:
    """An ordinary material with a few infinities."""
    return _table(grid, np.where(_some(grid, 5, 0.01), np.inf, _glossy(grid)))


def negative_entries(grid: HalfDifference = MERL) -> Table:
    """An ordinary material, nine in ten samples of it negative, down to -1e300."""
    negative = -(10.0 ** np.random.default_rng(6).uniform(-300, 300, grid.shape))
    return _table(grid, np.where(_some(grid, 7, 0.9), negative, _glossy(grid)))


def only_grazing(grid: HalfDifference = MERL) -> Table:
    """Samples only where light or view is at more than 80 degrees."""
    grazing = np.minimum(*grid.cosines) < np.cos(np.deg2rad(80))
    values = (_noisy(_glossy(grid, roughness), 8) for roughness in (0.1, 0.3, 0.6))
    return _table(grid, *(np.where(grazing, value, INVALID) for value in values))


def outliers(grid: HalfDifference = MERL) -> Table:
    """Salt and pepper: one sample in a hundred at 1e6 times the median, another one at 0."""
    draw = np.random.default_rng(9).random(grid.shape)
    glossy = _glossy(grid)
    salt = 1e6 * np.median(glossy[grid.above_horizon])
    return _table(grid, np.select([draw < 0.01, draw < 0.02], [salt, 0.0], glossy))


def channels_apart(grid: HalfDifference = MERL) -> Table:
    """The same in all channels, but red times 1e-6 and blue times 1e6."""
    glossy = _noisy(_glossy(grid), 10)
    return _table(grid, 1e-6 * glossy, glossy, 1e6 * glossy)


def vanishing_masking_shadowing(grid: HalfDifference = MERL) -> Table:
    """G falls to zero at grazing angles, faster than the cosines below it."""
    cos_i, cos_o = (np.where(cosine < 0.35, 0.0, cosine) for cosine in _cosines(grid))
    lobe = np.exp(-_tan2(grid) / 0.2**2) * _fresnel(grid, 0.5)
    return _table(grid, *(diffuse + lobe * (cos_i * cos_o) ** 2 for diffuse in (0.0, 0.01, 1.0)))


def narrow_lobe(grid: HalfDifference = MERL) -> Table:
    """D so narrow that Smith's integral meets one bin of it; less than any measurement's error."""
    lobe = np.exp(-_tan2(grid) / np.tan(grid.theta_h[0]) ** 2)
    return _table(
        grid, *(d + s * lobe * _fresnel(grid, 0.6) for d, s in ((0, 1e5), (0.2, 1e3), (1, 1)))
    )


def heavy_tail(grid: HalfDifference = MERL) -> Table:
    """D with a tail so long that the variance of its slopes diverges (GTR, gamma 1.5 and less)."""
    return _table(
        grid,
        *(
            0.01 + 10 * _fresnel(grid, 0.5) / (1 + _tan2(grid) / 0.1**2) ** gamma
            for gamma in (2.0, 1.5, 1.0)
        ),
    )


def two_identical_lobes(grid: HalfDifference = MERL) -> Table:
    """The sum of two equal lobes: which is which cannot be said, and need not."""
    return _table(grid, _noisy(2 * _glossy(grid), 11), 2 * _glossy(grid), 2 * _glossy(grid, 0.05))


def noise(grid: HalfDifference = MERL) -> Table:
    """Noise without a signal: uniform, exponential, and over ten decades."""
    rng = np.random.default_rng(12)
    shape = grid.shape
    return _table(
        grid, rng.random(shape), rng.exponential(size=shape), 10.0 ** rng.uniform(-5, 5, shape)
    )


def _some(grid: HalfDifference, seed: int, share: float) -> NDArray[np.bool_]:
    return np.random.default_rng(seed).random(grid.shape) < share


CASES: dict[str, Callable[..., Table]] = {
    case.__name__.replace("_", "-"): case
    for case in (
        perfect_mirror,
        black,
        one_black_channel,
        constant,
        twelve_decades,
        all_of_double_precision,
        too_dark_to_store,
        single_sample,
        one_theta_h_row,
        nan_entries,
        infinite_entries,
        negative_entries,
        only_grazing,
        outliers,
        channels_apart,
        vanishing_masking_shadowing,
        narrow_lobe,
        heavy_tail,
        two_identical_lobes,
        noise,
    )
}
