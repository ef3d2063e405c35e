"""Fit the colour channels of a table, one by one or all together, and keep the record.

`fit_channels` is for models whose parameters belong to one channel each. Where channels share
parameters, `fit_coupled` gives a model the samples of all of them at once.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from npfm.errors import NpfmError
from npfm.fitting.fits import ChannelRecord, Fit, Trace
from npfm.fitting.objective import (
    Objective,
    Samples,
    channel_samples,
    degeneracy,
    evaluate,
    fold,
)
from npfm.reflectance.grids import Grid
from npfm.reflectance.table import CHANNELS, INVALID, Table

#: What parameters are stored as.
STORED = np.float32


@dataclass(frozen=True)
class ChannelFit:
    """Parameters of one channel in units of the samples' scale, and how they were found.

    The first trace is that of the start that led to the parameters.
    """

    parameters: Mapping[str, ArrayLike]
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


@dataclass(frozen=True)
class CoupledFit:
    """Parameters of all channels, and how they were found.

    Parameters
    ----------
    parameters : dict of str to ndarray
        First axis the channel, or of length 1 where the channels share a parameter; coefficients
        in units of the samples' scale of their channel.
    traces : sequence of three sequences of Trace
        For each channel its runs, first the one that led to the parameters; their seconds are
        the channel's part of the time (see `shared_traces`).
    """

    parameters: dict[str, NDArray]
    traces: Sequence[Sequence[Trace]]


def shared_traces(traces: Sequence[Trace]) -> Sequence[Sequence[Trace]]:
    """Runs that fitted all channels at once, for each of them: a third of the time is its part."""
    part = [replace(t, seconds=tuple(s / len(CHANNELS) for s in t.seconds)) for t in traces]
    return [part] * len(CHANNELS)


def fit_coupled(
    name: str,
    table: Table,
    objective: Objective,
    fit_together: Callable[[Sequence[Samples]], CoupledFit],
    tabulate: Callable[[Fit], Table],
    coefficients: tuple[str, ...],
    reciprocal: bool = True,
    folded_record: bool = True,
) -> Fit:
    """Fit all channels at once, for a model in which they share parameters.

    The records are as those of `fit_channels`, one a channel. Their objective is that of the
    channel in the table of the stored parameters; what the traces tell is up to the model.

    Parameters
    ----------
    name : str
        Of the model.
    table : Table
        Measured BRDF in 1/sr.
    objective : Objective
        Weights and range.
    fit_together : callable
        Takes the samples of the three channels, folded if `reciprocal`.
    tabulate : callable
        The model's.
    coefficients : tuple of str
        The parameters that carry the unit of the BRDF: they are scaled back to 1/sr.
    reciprocal : bool
        Whether the model is fitted to folded samples.
    folded_record : bool
        Whether the records compare folded samples: not, if light and view exchanged change a table.

    Raises
    ------
    NpfmError
        As `fit_channels`.
    """
    began = time.process_time()
    samples = [channel_samples(table, channel, objective) for channel in range(len(CHANNELS))]
    folded = [fold(channel) for channel in samples]
    result = fit_together(folded if reciprocal else samples)
    stored = [
        _stored(
            {key: result.parameters[key][channel] for key in coefficients},
            folded[channel].scale,
            coefficients,
            CHANNELS[channel],
        )
        for channel in range(len(CHANNELS))
    ]
    parameters = {
        key: np.stack([part[key] for part in stored]) if key in coefficients else value
        for key, value in result.parameters.items()
    }
    parameters = {key: np.asarray(value).astype(STORED) for key, value in parameters.items()}
    fit = Fit(name, parameters, table.grid)
    seconds = time.process_time() - began
    compared = folded if folded_record else samples
    records = records_of(tabulate(fit), compared, result.traces, seconds)
    floors = [channel.floor / (channel.energy or 1.0) for channel in folded]
    reasons = [degeneracy(channel) for channel in folded]
    return replace(
        fit,
        records=tuple(
            replace(
                record,
                objective_floor=floor,
                status=f"degenerate: {reason}" if reason else record.status,
            )
            for record, floor, reason in zip(records, floors, reasons, strict=True)
        ),
    )


def records_of(
    made: Table,
    samples: Sequence[Samples],
    traces: Sequence[Sequence[Trace]],
    seconds: float,
) -> tuple[ChannelRecord, ...]:
    """Records of a fit by its table: the objective is that of equation 7 of Bagher et al. 2016.

    Parameters
    ----------
    made : Table
        What the fit's model makes of it.
    samples : sequence of Samples
        Of each channel; folded only if the table is reciprocal.
    traces : sequence of sequence of Trace
        Of each channel, first the run that led to the fit.
    seconds : float
        Processor time of all channels; what is not in the runs is shared out equally.
    """
    runs = [sum(trace.seconds[-1] for trace in channel) for channel in traces]
    rest = max(seconds - sum(runs), 0.0) / len(CHANNELS)
    records = []
    for channel, name in enumerate(CHANNELS):
        measured, first = samples[channel], traces[channel][0]
        half = made.values[channel][..., : measured.value.shape[-1]]
        energy = measured.energy or 1.0
        reached = evaluate(measured, half / measured.scale) / energy
        records.append(
            ChannelRecord(
                channel=name,
                seconds=runs[channel] + rest,
                best_start=first.start,
                objective=reached,
                objective_floor=measured.floor / energy,
                status=first.status,
                traces=tuple(traces[channel]),
            )
        )
    return tuple(records)


def with_end(record: ChannelRecord) -> ChannelRecord:
    """Return the record with its objective as the end of its best run, whatever that minimised."""
    first, *others = record.traces
    return replace(record, traces=(replace(first, objective=(record.objective,)), *others))


def _stored(
    parameters: Mapping[str, ArrayLike], scale: float, coefficients: tuple[str, ...], channel: str
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


def as_table(channels: list[NDArray], grid: Grid) -> Table:
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
