"""What a fit is: parameters in float32, and the record of how they were found."""

import inspect
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType
from typing import Any, Generic

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance import grids
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import CHANNELS, G, Table
from npfm.storage.archives import read_arrays
from npfm.storage.files import Kind, marked, replacing

FORMAT = "npfm-fit-1"
UNITS = "angles in radians, BRDF in 1/sr"
FIT = Kind("a fit", ".npz", marked(b"format.npy", b"model.npy", b"units.npy", b"grid.npy"))
RECORD = Kind("a record of a fit", ".json", marked(b'"model"', b'"parameters"', b'"channels"'))
ITERATIONS = Kind(  # npfm.fitting.iterations, which only fits that are followed depend on
    "a record of iterations", ".npz", marked(b"iterations.npy", b"names.npy", b"objective.npy")
)
#: What a file has beside the arrays of the model.
ABOUT = ("format", "model", "units", "grid")
#: A fit of more bytes than the largest table, MERL's in double precision, is none.
MOST_BYTES = 8 * 3 * MERL.size
#: No table has more cells, and one that has would not fit into memory: of half-difference grids
#: MERL's is the largest, and of directional ones a step of 5 degrees is as fine as is measured.
MOST_CELLS = {HalfDifference.kind: MERL.size, Directional.kind: (18 * 72) ** 2}
AGAIN = "make it again with npfm fit"


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
    arrays: dict[str, Any] = {name: np.array(text) for name, text in labels.items()}
    arrays |= {"grid": np.array(fit.grid.shape), **fit.parameters}
    with replacing(path, FIT) as temporary:
        np.savez(temporary, **arrays)
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

    Returns
    -------
    Fit
        Asking its parameters for an array that the file lacks raises `NpfmError`.

    Raises
    ------
    NpfmError
        If the file is absent, is not a fit or damaged, or an array holds no finite numbers or has
        no axis of the channels.
    """
    arrays = read_arrays(path, "a fit", AGAIN, MOST_BYTES)
    if str(arrays.get("format", "")) != FORMAT:
        raise NpfmError(f"{path}: not a fit of format {FORMAT}; {AGAIN}")
    if missing := [name for name in ABOUT if name not in arrays]:
        raise NpfmError(f"{path}: a fit without {', '.join(missing)}; {AGAIN}")
    about = {name: arrays.pop(name) for name in ABOUT}
    kind = str(arrays.pop("grid_kind", HalfDifference.kind))
    if (units := str(about["units"])) != UNITS:
        raise NpfmError(f"{path}: the units are '{units}', not '{UNITS}'; {AGAIN}")
    for name, array in arrays.items():
        _check_parameter(path, name, array)
    return Fit(str(about["model"]), _Parameters(path, arrays), _grid(path, kind, about["grid"]))


def tabulate(path: str | Path, fit: Fit, model: ModuleType) -> Table:
    """Values of a fit out of a file, which is named if its arrays are not those of the model.

    Parameters
    ----------
    path : str or Path
        Where the fit was read.
    fit : Fit
        The fit.
    model : module
        The module of its model.

    Raises
    ------
    NpfmError
        If an array is missing or has another shape.
    """
    try:
        counted = inspect.signature(model.parameter_count).parameters
        # Where a setting of the model counts, the number of values says nothing.
        if len(counted) == 1 and fit.parameter_count != (count := model.parameter_count(fit.grid)):
            raise ValueError(f"{fit.parameter_count} values, not {count}")
        return model.tabulate(fit)
    except (LookupError, ValueError, TypeError) as error:
        there = ", ".join(f"{name} {array.shape}" for name, array in fit.parameters.items())
        reason = " ".join(str(error).split())
        raise NpfmError(
            f"{path}: its arrays ({there}) are not those of {fit.model} ({reason}); {AGAIN}"
        ) from error


class _Parameters(dict[str, NDArray[np.float32]]):
    """Arrays of a file, which is named when one is asked for that it lacks."""

    def __init__(self, path: str | Path, arrays: dict[str, NDArray]) -> None:
        super().__init__(arrays)
        self.path = path

    def __missing__(self, name: str) -> NDArray:
        there = ", ".join(sorted(self)) or "no array"
        raise NpfmError(f"{self.path}: a fit without the array '{name}', it has {there}; {AGAIN}")


def _grid(path: str | Path, kind: str, bins: NDArray) -> grids.Grid:
    if bins.ndim != 1 or bins.dtype.kind not in "iu" or not bins.size or (bins < 1).any():
        raise NpfmError(f"{path}: the grid is {bins}, not numbers of bins; {AGAIN}")
    try:
        grid = grids.named(kind, bins.tolist())
    except NpfmError as error:
        raise NpfmError(f"{path}: {error}; {AGAIN}") from error
    odd = isinstance(grid, HalfDifference) and grid.phi_d_bins % 2
    if grid.size > MOST_CELLS.get(kind, MERL.size) or odd:
        raise NpfmError(f"{path}: no table is on a grid of {bins} bins; {AGAIN}")
    return grid


def _check_parameter(path: str | Path, name: str, array: NDArray) -> None:
    if array.dtype != np.float32:
        raise NpfmError(f"{path}: {name} is of type {array.dtype}, not float32; {AGAIN}")
    if array.ndim == 0 or array.size == 0 or array.shape[0] not in (1, len(CHANNELS)):
        raise NpfmError(
            f"{path}: {name} is of shape {array.shape}, whose first axis is not that of the "
            f"{len(CHANNELS)} channels; {AGAIN}"
        )
    if not np.isfinite(array).all():
        raise NpfmError(f"{path}: {name} holds a NaN or an infinity; {AGAIN}")


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
        known = {key: record[key] for key in ("model", "parameters", "bytes")}
        return record | known | {"channels": channels}
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise NpfmError(
            f"{record_path(path)}: cannot be read as the record of a fit ({reason}); {AGAIN}"
        ) from error


def _channel(record: dict) -> ChannelRecord:
    traces = (
        Trace(**trace | {key: tuple(trace[key]) for key in ("seconds", "objective")})
        for trace in record["traces"]
    )
    return ChannelRecord(**record | {"traces": tuple(traces)})
