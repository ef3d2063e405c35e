"""Fit the colour channels of a table one by one, and keep the record."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.fits import ChannelRecord, Trace
from npfm.fitting.objective import Objective, Samples, channel_samples, degeneracy, fold
from npfm.reflectance.table import CHANNELS, INVALID, Table

#: What parameters are stored as.
STORED = np.float32


@dataclass(frozen=True)
class ChannelFit:
    """Parameters of one channel in units of the samples' scale, and how they were found.

    The first trace is that of the start that led to the parameters.
    """

    parameters: dict[str, NDArray]
    traces: tuple[Trace, ...]


def fit_channels(
    table: Table,
    objective: Objective,
    fit_channel: Callable[[Samples, int], ChannelFit],
    coefficients: tuple[str, ...],
    reciprocal: bool = True,
) -> tuple[dict[str, NDArray[np.float32]], tuple[ChannelRecord, ...]]:
    """Fit each channel by itself, as the paper does (section 3).

    Parameters
    ----------
    table : Table
        Measured BRDF in 1/sr.
    objective : Objective
        Weights and range.
    fit_channel : callable
        Takes the samples of a channel and its number; the samples are folded if `reciprocal`.
    coefficients : tuple of str
        The parameters that carry the unit of the BRDF: they are scaled back to 1/sr.
    reciprocal : bool
        Whether the model takes the same value with light and view exchanged.

    Returns
    -------
    parameters : dict of str to ndarray of float32, first axis the channel
    records : tuple of ChannelRecord

    Raises
    ------
    NpfmError
        If a channel has no sample that counts, a NaN or an infinity, or values so large or so
        small that its coefficients cannot be stored.
    """
    fitted, records = [], []
    for channel, name in enumerate(CHANNELS):
        began = time.process_time()
        samples = channel_samples(table, channel, objective)
        folded = fold(samples)
        result = fit_channel(folded if reciprocal else samples, channel)
        best = result.traces[0]
        energy = folded.energy or 1.0
        fitted.append(_stored(result.parameters, folded.scale, coefficients, name))
        degenerate = degeneracy(folded)
        records.append(
            ChannelRecord(
                channel=name,
                seconds=time.process_time() - began,
                best_start=best.start,
                objective=best.objective[-1],
                objective_floor=folded.floor / energy,
                status=f"degenerate: {degenerate}" if degenerate else best.status,
                traces=result.traces,
            )
        )
    return {key: np.stack([c[key] for c in fitted]) for key in fitted[0]}, tuple(records)


def _stored(
    parameters: dict[str, NDArray], scale: float, coefficients: tuple[str, ...], channel: str
) -> dict[str, NDArray]:
    """Parameters as they are stored, the coefficients in 1/sr."""
    scaled = {
        key: np.asarray(value) * (scale if key in coefficients else 1.0)
        for key, value in parameters.items()
    }
    limits, largest = np.finfo(STORED), max(np.abs(scaled[key]).max() for key in coefficients)
    if largest > limits.max or 0 < largest < limits.tiny:
        raise NpfmError(
            f"the {channel} channel needs a coefficient of {largest:.1e} 1/sr, and a fit holds "
            f"{limits.tiny:.0e} to {limits.max:.0e}; scale the table"
        )
    return {key: value.astype(STORED) for key, value in scaled.items()}


def as_table(channels: list[NDArray], grid) -> Table:
    """Stack the values of three channels into a table, marked invalid below the horizon.

    Parameters
    ----------
    channels : list of three ndarray, shape grid.shape
        BRDF in 1/sr.
    grid : Grid
        Their grid.
    """
    values = np.stack([np.where(grid.above_horizon, channel, INVALID) for channel in channels])
    return Table(values, grid)
