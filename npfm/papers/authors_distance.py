"""How far a run's tables are from the factors that Bagher et al. 2016 published."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.fitting.factors.microfacet import tabulate_channel
from npfm.fitting.objective import Objective, Samples, channel_samples, evaluate, weighted_median
from npfm.reflectance.table import CHANNELS, Table

COLUMNS = "material", "channel", "published", "ours", "log_ratio", "log_error"


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
        Factors and coefficients as `npfm.papers.authors_factors.read` returns them. Cells that
        rest on a component that no sample has touched do not count.
    fitted : Table
        Our fit of the same model to `measured`.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, one row a channel: the objective (equation 7) of both as a share of the
        zero model's, and the median of ln(published / measured) and of its magnitude; all by
        the paper's weights w of equation 8.
    """
    rows = []
    for k, channel in enumerate(CHANNELS):
        factors = {name: values[k] for name, values in published.items()}
        model = tabulate_channel(measured.grid, **factors)
        samples = _known(channel_samples(measured, k, Objective()), np.isfinite(model))
        objectives = [
            evaluate(samples, np.nan_to_num(values) / samples.scale) / samples.energy
            for values in (model, fitted.values[k])
        ]
        rows.append((material, channel, *objectives, *_log_ratio(samples, model)))
    return pd.DataFrame(rows, columns=COLUMNS)


def _known(samples: Samples, known: NDArray[np.bool_]) -> Samples:
    """Return the samples with those elsewhere left out."""
    weight, value = (np.where(known, array, 0.0) for array in (samples.weight, samples.value))
    return replace(samples, weight=weight, value=value)


def _log_ratio(samples: Samples, model: NDArray) -> tuple[float, float]:
    """Weighted median of ln(model / measured), and of its magnitude."""
    counts = (samples.weight > 0) & (samples.value > 0) & (model > 0)
    ratio = np.log(model[counts] / (samples.value[counts] * samples.scale))
    weight = samples.weight[counts]
    return weighted_median(ratio, weight), weighted_median(np.abs(ratio), weight)
