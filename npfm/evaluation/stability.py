"""What must hold of every fit of any table, and the rows that say how the hard cases went."""

from collections.abc import Callable, Iterable
from types import ModuleType

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation.hard_cases import CASES
from npfm.fitting.channels import STORED
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, Samples, channel_samples, evaluate
from npfm.fitting.solvers.normal import system
from npfm.reflectance.table import Table

COLUMNS = [
    "case", "variant", "solver", "status", "finite", "objective", "objective_floor", "condition",
    "seconds",
]  # fmt: skip
#: How far, as a share of the energy, rounding can raise an objective above that of a constant.
ROUNDING = 1e-9
STATUSES = ("converged", "iteration cap", "stalled", "degenerate: ")


def violations(table: Table, fit: Fit, model: ModuleType) -> list[str]:
    """What must hold of every fit of any table, and does not; `model` is the module it is of."""
    made, found = model.tabulate(fit), []
    if not all(np.isfinite(a).all() for a in (*fit.parameters.values(), made.values)):
        found.append("a NaN or an infinity")
    if (made.values[:, table.grid.above_horizon] < 0).any():
        found.append("a negative value")
    for name in {"D", "F", "G", "H"} & fit.parameters.keys():
        factor, clamp = fit.parameters[name], STORED(getattr(model, "CLAMP", 0))
        if not ((factor >= clamp) & (factor <= 1)).all():
            found.append(f"{name} outside [{clamp}, 1]")
    for name in {"rho_d", "rho_s", "B"} & fit.parameters.keys():
        if (fit.parameters[name] < 0).any():
            found.append(f"{name} below 0")
    for channel, record in enumerate(fit.records):
        samples = channel_samples(table, channel, Objective())
        energy = samples.energy or 1.0
        reached = evaluate(samples, made.values[channel] / samples.scale) / energy
        mean = np.vdot(samples.weight, samples.value) / samples.weight.sum()
        constant = evaluate(samples, np.broadcast_to(mean, samples.value.shape)) / energy
        if getattr(model, "OBJECTIVE", True) and reached > constant + ROUNDING:
            found.append(f"{record.channel}: {reached:g}, a constant leaves {constant:g}")
        if abs(reached - record.objective) > 1e-5 * reached + ROUNDING:
            found.append(f"{record.channel}: {reached:g}, recorded as {record.objective:g}")
        if not record.status.startswith(STATUSES):
            found.append(f"{record.channel}: status '{record.status}'")
    return found


def condition(model: ModuleType, samples: Samples, p: dict[str, NDArray]) -> float:
    """Condition number of what a model solves at a fit of one channel.

    Of the Gauss-Newton matrix in the free unknowns, scaled to a unit diagonal, without as many of
    its smallest eigenvalues as the model has `FREEDOMS`; of a model that tells its `systems`, the
    largest of those. Infinite if singular in double precision, NaN for a model that has neither.

    Parameters
    ----------
    model : module
        Of the fit's model. `linearised` gives its problem and the state of the parameters.
    samples : Samples
        Not folded.
    p : dict of str to ndarray of float64
        Parameters of the channel in the units of the samples.
    """
    if hasattr(model, "systems"):
        found = [_scaled_condition(matrix, 0) for matrix in model.systems(samples, p)]
        return max(found, default=float("nan"))
    if not hasattr(model, "linearised"):
        return float("nan")
    _, matrix = system(*model.linearised(samples, p)).reduced
    return _scaled_condition(matrix, model.FREEDOMS) if matrix.size else float("nan")


def _scaled_condition(matrix: NDArray, freedoms: int) -> float:
    root = np.sqrt(np.diag(matrix))
    values = np.linalg.eigvalsh(matrix / root / root[:, None])[freedoms:]
    if not values.size:
        return float("nan")
    least = values.size * np.finfo(float).eps * values[-1]
    return float(values[-1] / values[0]) if values[0] > least else float("inf")


def row(case: str, table: Table, model: ModuleType, method: str, fit: Callable[[], Fit]) -> dict:
    """One row of the table: over the channels all statuses, the largest values, all seconds.

    Parameters
    ----------
    case : str
        Name of the case.
    table : Table
        The case itself.
    model : module
        Of the model that is fitted.
    method : str
        Name of the solver; empty for a model that needs none.
    fit : callable
        Fits the table.

    Raises
    ------
    AssertionError
        If what must hold of every fit does not.
    """
    entry = dict.fromkeys(COLUMNS) | {"case": case, "variant": model.NAME, "solver": method}
    try:
        made = fit()
    except NpfmError as error:
        return entry | {"status": f"refused: {error}"}
    if wrong := violations(table, made, model):
        raise AssertionError(f"{case}, {model.NAME}, {method}: {'; '.join(wrong)}")
    return entry | {
        "status": " / ".join(dict.fromkeys(record.status for record in made.records)),
        "finite": True,
        "objective": max(record.objective for record in made.records),
        "objective_floor": max(record.objective_floor for record in made.records),
        "condition": pd.Series(_conditions(table, made, model)).max(),
        "seconds": sum(record.seconds for record in made.records),
    }


def _conditions(table: Table, fit: Fit, model: ModuleType) -> list[float]:
    """Condition number in each channel."""
    found = []
    for channel in range(3):
        samples = channel_samples(table, channel, Objective())
        units = dict.fromkeys(("rho_d", "rho_s", "B", "U"), samples.scale)
        # What the channels share is stored once.
        own = {key: a[min(channel, len(a) - 1)] for key, a in fit.parameters.items()}
        p = {key: a.astype(float) / units.get(key, 1) for key, a in own.items()}
        found.append(condition(model, samples, p))
    return found


def gathered(tables: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Join tables, sorted by case."""
    order = {case: place for place, case in enumerate(CASES)}
    joined = pd.concat(list(tables))
    return joined.sort_values("case", key=lambda cases: cases.map(order), kind="stable")
