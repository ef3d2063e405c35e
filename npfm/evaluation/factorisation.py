"""How accurate factors are, under a measure that is stated, and how accurate lobes are beside them.

Lawrence et al. 2004, Table 1: the mean absolute error "normalized by the mean BRDF value" over "a
dense set of samples of the 4D domain, independent of the resolution". What is compared is not said;
here it is the reflected light, cos(theta_i) rho, that is factored, at directions that are spread
evenly in their angles: theta_i and theta_o over 0 to 90 degrees, both azimuths over 360.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.fitting.factorisation.matrix import Brdf
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.reflectance.factored import Factors, reflectance

Array = NDArray[np.float64]

#: Pairs of directions that an error is the mean over.
PAIRS = 400_000
#: Pairs treated at once.
BLOCK = 50_000
TEXT = ("material", "parameterisation", "recipe")
NUMBERS = (
    "theta_o",
    "phi_o",
    "theta_p",
    "phi_p",
    "outer",
    "inner",
    "bytes",
    "error",
    "rms",
    "paper",
    "lafortune",
    "lafortune_paper",
    "seconds",
)


def directions(count: int, seed: int) -> tuple[Array, Array]:
    """Light and view directions (count, 3), each even in its angle and its azimuth."""
    random = np.random.default_rng(seed).random((2, 2, count))
    theta, phi = np.pi / 2 * random[:, 0], 2 * np.pi * random[:, 1]
    sine = np.sin(theta)
    light, view = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)
    return light, view


def errors(brdf: Brdf, model: Brdf, count: int = PAIRS, seed: int = 1) -> tuple[float, float]:
    """Mean absolute and root mean square error of a model, as shares of the mean.

    Both of the reflected light in the mean over the channels, as the module says.

    Parameters
    ----------
    brdf, model : callable
        Reflectance (3, n) in 1/sr at pairs of directions (n, 3).
    count : int
        Pairs of directions.
    seed : int
        Of these.
    """
    light, view = directions(count, seed)
    parts = []
    for begin in range(0, count, BLOCK):
        i, o = light[begin : begin + BLOCK], view[begin : begin + BLOCK]
        parts.append([i[:, 2] * f(i, o).mean(axis=0) for f in (brdf, model)])
    measured, shown = np.concatenate(parts, axis=1)
    difference, mean = measured - shown, measured.mean() or 1.0
    return float(np.abs(difference).mean() / mean), float(np.sqrt((difference**2).mean()) / mean)


def described(name: str, factors: Factors) -> dict[str, Any]:
    """Return what a row tells of factors before any measurement."""
    angles = factors.angles
    sizes = dict(zip(("theta_o", "phi_o", "theta_p", "phi_p"), angles.shape, strict=True))
    return {
        "material": name,
        "parameterisation": "half-vector" if angles.half else "incident",
        "recipe": "improved" if angles.improved else "paper",
        **sizes,
        "outer": factors.terms[0],
        "inner": factors.terms[1],
        "bytes": 4 * sum(array.size for array in factors.arrays().values()),
    }


def by_terms(
    brdf: Brdf, recipe: Recipe, outer: Iterable[int], inner: Iterable[int]
) -> pd.DataFrame:
    """Error of a BRDF by the number of terms: Figure 6 of the paper.

    Returns
    -------
    DataFrame
        Columns outer, inner, error and rms.
    """
    rows = []
    numbers = list(inner)
    for J in outer:
        for K in numbers:
            factors = factor(brdf, Recipe(recipe.angles, (J, K))).factors
            error, rms = errors(brdf, model(factors))
            rows.append({"outer": J, "inner": K, "error": error, "rms": rms})
    return pd.DataFrame(rows)


def model(factors: Factors) -> Brdf:
    """Reflectance of factors at pairs of directions."""
    return lambda light, view: reflectance(factors, light, view)


def table(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Rows as a table, in the order of `TEXT` and `NUMBERS`."""
    return pd.DataFrame(list(rows), columns=[*TEXT, *NUMBERS])
