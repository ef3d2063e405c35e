"""How far a run's tables are from the factors that Bagher et al. 2016 published."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.datasets import published_factors
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.objective import Objective, Samples, channel_samples, evaluate, weighted_median
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, Table

Array = NDArray[np.float64]

#: Objectives of the published factors: as they are read, and with G's nodes half a degree further
#: or F's half a degree earlier.
READINGS = "published", "g_at_centres", "f_at_degrees"
COLUMNS = "material", "channel", *READINGS, "ours", "log_ratio", "log_error"


def distance(
    material: str,
    measured: Table,
    published: Mapping[str, NDArray],
    fitted: Table,
) -> pd.DataFrame:
    """Compare published factors and a fit with the table of a material.

    Parameters
    ----------
    material : str
        Its name.
    measured : Table
        What the run takes for the measurement.
    published : mapping of str to ndarray
        Factors and coefficients as `npfm.datasets.published_factors.read` returns them. Cells that
        rest on a component that no sample has touched do not count.
    fitted : Table
        Our fit of the same model to `measured`.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, one row a channel: the objective (equation 7) of the published factors
        in each reading and of ours, as a share of the zero model's, and the median of
        ln(published / measured) and of its magnitude; all by the paper's weights w of equation 8.
    """
    rows = []
    for k, channel in enumerate(CHANNELS):
        models = _readings(measured.grid, {name: values[k] for name, values in published.items()})
        known = np.logical_and.reduce([np.isfinite(model) for model in models])
        samples = _known(channel_samples(measured, k, Objective()), known)
        objectives = [
            evaluate(samples, np.nan_to_num(values) / samples.scale) / (samples.energy or 1.0)
            for values in (*models, fitted.values[k])
        ]
        rows.append((material, channel, *objectives, *_log_ratio(samples, models[0])))
    return pd.DataFrame(rows, columns=COLUMNS)


def _readings(grid: HalfDifference, factors: Mapping[str, Any]) -> list[NDArray]:
    """Values of a channel in the order of `READINGS`."""
    degrees = grid.theta_d - grid.theta_d[0]
    return [
        tabulate_channel(grid, **factors),
        tabulate_channel(grid, **factors, g_theta=G_THETA),
        tabulate_channel(grid, **factors, f_theta=degrees),
    ]


def tabulate_channel(
    grid: HalfDifference,
    D: Array,
    F: Array,
    G: Array,
    rho_d: float,
    rho_s: float,
    *,
    g_theta: Array = published_factors.G_THETA,
    f_theta: Array | None = None,
) -> Array:
    """Equation 3 at the centre of every cell of a grid, for one channel of published factors.

    Parameters
    ----------
    grid : HalfDifference
        With as many theta_h and theta_d bins as D and F have components.
    D, F, G : ndarray
        Factors, NaN where a component is not known.
    rho_d, rho_s : float
        In 1/sr.
    g_theta, f_theta : ndarray, optional
        Angles in radians that the components of G and F belong to, linear between them; without
        `f_theta`, those of F belong to the bins of theta_d.

    Returns
    -------
    ndarray, shape grid.shape
        BRDF in 1/sr; NaN in cells that rest on an unknown component, and below the horizon.
    """
    if f_theta is not None:
        F = np.interp(grid.theta_d, f_theta, F)
    value = rho_s * D[:, None, None] * F[:, None]
    for cosine in grid.cosines:
        theta = np.arccos(np.clip(cosine, 0, 1))
        value = value * np.interp(theta, g_theta, G) / np.cos(np.minimum(theta, g_theta[-1]))
    return np.where(grid.above_horizon, rho_d + value, np.nan)


def _known(samples: Samples, known: NDArray[np.bool_]) -> Samples:
    """Return the samples with those elsewhere left out."""
    weight, value = (np.where(known, array, 0.0) for array in (samples.weight, samples.value))
    return replace(samples, weight=weight, value=value)


def _log_ratio(samples: Samples, model: NDArray) -> tuple[float, float]:
    """Weighted median of ln(model / measured), and of its magnitude."""
    counts = (samples.weight > 0) & (samples.value > 0) & (model > 0)
    if not counts.any():  # black
        return np.nan, np.nan
    ratio = np.log(model[counts] / (samples.value[counts] * samples.scale))
    weight = samples.weight[counts]
    return weighted_median(ratio, weight), weighted_median(np.abs(ratio), weight)
