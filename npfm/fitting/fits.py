"""What a fit is: parameters in float32, and the record of how they were found."""

import json
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance import grids
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import G
from npfm.storage.files import Kind, marked, replacing

FORMAT = "npfm-fit-1"
UNITS = "angles in radians, BRDF in 1/sr"
FIT = Kind("a fit", ".npz", marked(b"format.npy", b"model.npy", b"units.npy", b"grid.npy"))
RECORD = Kind("a record of a fit", ".json", marked(b'"model"', b'"parameters"', b'"channels"'))


@dataclass(frozen=True)
class Trace:
    """One run of a solver from one start.

    Parameters
    ----------
    start : str
        Name of the start.
    status : str
        ``converged``, ``iteration cap``, or ``stalled``: nothing that was tried lowers the
        objective, though its derivative says that it can be lowered.
    iterations, gss_calls : int
        Sweeps over the factors, and golden-section searches among them.
    seconds, objective : tuple of float
        At the start and after each iteration: processor time since the start, which other work
        on the machine does not lengthen, and the objective as a
        share of that of the zero model.
    compared : float, optional
        Where the starts were compared on fewer samples than this run ended on: its objective
        there, as a share of that of the zero model.
    """

    start: str
    status: str
    iterations: int
    gss_calls: int
    seconds: tuple[float, ...]
    objective: tuple[float, ...]
    compared: float | None = None

    @property
    def end(self) -> float:
        """Objective that is compared with those of the other starts."""
        return self.objective[-1] if self.compared is None else self.compared


@dataclass(frozen=True)
class ChannelRecord:
    """How one channel was fitted; `objective` and `objective_floor` are relative as in `Trace`.

    `seconds` is the processor time of the whole channel, all starts and preparations included;
    `objective_floor` is the part of the objective that no reciprocal model can remove; `status` is
    that of the best start, or ``degenerate: <why>`` if the samples leave many fits equally good.
    """

    channel: str
    seconds: float
    best_start: str
    objective: float
    objective_floor: float
    status: str
    traces: tuple[Trace, ...]

    @property
    def iterations(self) -> int:
        """Sweeps over the factors, all starts together."""
        return sum(trace.iterations for trace in self.traces)

    @property
    def gss_calls(self) -> int:
        """Golden-section searches, all starts together."""
        return sum(trace.gss_calls for trace in self.traces)


@dataclass(frozen=True)
class Fit(Generic[G]):
    """A fitted model of one material.

    Parameters
    ----------
    model : str
        Name of the model in the registry.
    parameters : dict of str to ndarray of float32
        The model's own arrays, first axis the colour channel; nothing else is needed to
        tabulate.
    grid : HalfDifference
        The grid of the table that was fitted.
    records : tuple of ChannelRecord
        One a channel; empty when only the parameters were read.
    """

    model: str
    parameters: dict[str, NDArray[np.float32]]
    grid: G
    records: tuple[ChannelRecord, ...] = ()

    @property
    def parameter_count(self) -> int:
        """Number of stored values."""
        return sum(array.size for array in self.parameters.values())

    @property
    def parameter_bytes(self) -> int:
        """Bytes of the stored values."""
        return sum(array.nbytes for array in self.parameters.values())


def record_path(path: str | Path) -> Path:
    """Where the record of the fit at `path` lies: beside it, as JSON."""
    return Path(path).with_suffix(".json")


def save(path: str | Path, fit: Fit) -> None:
    """Write the parameters to `path` (``.npz``) and the record beside them (``.json``).

    The parameters alone are the fit: the same seed gives the same bytes. Times are in the record.
    """
    labels = {"format": FORMAT, "model": fit.model, "units": UNITS}
    # Fits had only one kind of grid at first, and those on it are the same bytes as ever.
    if fit.grid.kind != HalfDifference.kind:
        labels["grid_kind"] = fit.grid.kind
    about = {name: np.array(text) for name, text in labels.items()}
    with replacing(path, FIT) as temporary:
        np.savez(temporary, **about, grid=np.array(fit.grid.shape), **fit.parameters)
    record = {
        "model": fit.model,
        "parameters": fit.parameter_count,
        "bytes": fit.parameter_bytes,
        "channels": [asdict(channel) for channel in fit.records],
    }
    with replacing(record_path(path), RECORD) as temporary:
        temporary.write_text(json.dumps(record, indent=1) + "\n")


def load(path: str | Path) -> Fit:
    """Read the parameters of a fit.

    Raises
    ------
    NpfmError
        If the file is absent or is not a fit.
    """
    try:
        # A zip and nothing else: np.load would also take single arrays and pickles.
        with open(path, "rb") as file, zipfile.ZipFile(file), np.load(file) as archive:
            arrays = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise NpfmError(
            f"{path}: cannot be read as a fit ({error}); make it with npfm fit"
        ) from error
    if str(arrays.pop("format", "")) != FORMAT:
        raise NpfmError(f"{path}: not a fit of format {FORMAT}; make it again with npfm fit")
    arrays.pop("units")
    kind = str(arrays.pop("grid_kind", HalfDifference.kind))
    grid = grids.named(kind, arrays.pop("grid"))
    return Fit(str(arrays.pop("model")), arrays, grid)


def load_record(path: str | Path) -> dict:
    """Read the record beside the fit at `path`, with its channels as `ChannelRecord`.

    Raises
    ------
    NpfmError
        If the record is absent or is not one.
    """
    try:
        record = json.loads(record_path(path).read_text())
        channels = tuple(_channel(channel) for channel in record["channels"])
        return record | {"channels": channels}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NpfmError(
            f"{record_path(path)}: cannot be read as the record of a fit ({error}); "
            "make it again with npfm fit"
        ) from error


def _channel(record: dict) -> ChannelRecord:
    traces = (
        Trace(**trace | {key: tuple(trace[key]) for key in ("seconds", "objective")})
        for trace in record["traces"]
    )
    return ChannelRecord(**record | {"traces": tuple(traces)})
