"""Small materials made of lobes, and fits that have exactly their factors."""

import numpy as np

from npfm.fitting.basis.lobes import Lobes, parameters_of
from npfm.fitting.fits import Fit
from npfm.fitting.shared_lobes.starts import ggx
from npfm.reflectance.half_difference import HalfDifference

GRID = HalfDifference(18, 18, 36)
NODES = (np.arange(90) + 0.5) / 90 * np.pi / 2


def lobes(roughness, steepness, shadow, channels=1, count=1):
    """GGX lobes; F rises as a power and G falls as one."""
    D = ggx(GRID.theta_h, roughness * 1.5 ** np.arange(count))
    F = np.exp(steepness * (1 + 0.1 * np.arange(channels))[:, None] * (GRID.theta_d - 1.5))
    G = np.cos(NODES) ** (shadow * (1 + 0.2 * np.arange(count))[:, None])
    return Lobes(
        D, F / F.max(1, keepdims=True), G, np.full((channels, count), 2.0), np.ones(channels)
    )


def fit_of(model, *numbers):
    single = model == "independent-g"
    groups = [lobes(*numbers)] * 3 if single else [lobes(*numbers, channels=3, count=2)]
    parameters = parameters_of(groups, single)
    return Fit(model, {k: v.astype(np.float32) for k, v in parameters.items()}, GRID)


def many(model):
    """Fits of eight materials, whose factors hang on three numbers smoothly."""
    rng = np.random.default_rng(5)
    numbers = zip(
        rng.uniform(0.1, 0.5, 8), rng.uniform(0, 2, 8), rng.uniform(0.2, 1, 8), strict=True
    )
    return {f"m{k}": fit_of(model, *each) for k, each in enumerate(numbers)}
