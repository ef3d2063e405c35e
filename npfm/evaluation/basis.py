"""How many curves describe the factors of a material that they were not made from.

Every material is left out once: the factors of all others give the curves, and it is fitted in
them, a handful of unknowns in place of hundreds. Beside that, its own fit is laid into the curves,
which shows what is lost where nothing is fitted again.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.fitting.basis.fit import Found, fit, prepare, project
from npfm.fitting.basis.library import Library
from npfm.fitting.basis.lobes import lobes_of, parameters_of
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.shared_lobes.problem import compiled
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.table import CHANNELS, Table
from npfm.rendering.transport import Transport, columns, pictures

#: Ways to a material's factors: fitted in a basis, its own fit laid into one, and that fit itself.
FITTED, PROJECTED, FREE = "fitted", "projected", "free"
MEASURED = (
    "material", "variant", "way", "curves", "unknowns", "bytes", "basis_bytes", "seconds",
    "objective", "scene", "psnr_db",
)  # fmt: skip
TEXT = ("material", "variant", "way", "scene")
SUMMARY = (
    "variant", "way", "curves", "materials", "unknowns", "bytes", "basis_bytes", "seconds",
    "seconds_most", "objective", "times_free", "times_free_most", "psnr_db", "db_lost",
    "db_lost_most",
)  # fmt: skip
#: Of a number as fits store it.
BYTES = 4


@dataclass(frozen=True)
class Own:
    """The fit of a material with free factors.

    Parameters
    ----------
    fit : Fit
    objective : float
        As a share of the zero model's, mean over the channels.
    seconds : float
        Processor time of all channels and starts.
    """

    fit: Fit
    objective: float
    seconds: float


@dataclass(frozen=True)
class Way:
    """A row of the table, and the fit that is rendered for it: none of what is laid into curves."""

    name: str
    curves: int
    unknowns: int
    basis_values: int
    seconds: float
    objective: float
    fit: Fit | None = None


def ways(
    measured: Table,
    own: Own,
    others: Library,
    counts: Sequence[int],
    objective: Objective,
    solve: Solver,
) -> list[Way]:
    """Fit a material in bases of other materials' factors, and lay its own fit into them.

    Parameters
    ----------
    measured : Table
    own : Own
    others : Library
        Factors of other materials, by the model of its own fit.
    counts : sequence of int
        How many curves; as many as the other materials make, if these are fewer.
    objective : Objective
        Of all fits.
    solve : Solver
        Gauss-Newton with its settings.

    Returns
    -------
    list of Way
        The free fit first. Seconds are those of a material alone, its samples' preparation and
        all starts included; the curves are there before.
    """
    compiled()
    began = time.process_time()
    samples = [fold(channel_samples(measured, k, objective)) for k in range(len(CHANNELS))]
    groups = prepare(samples, others)
    prepared = time.process_time() - began
    scales = np.array([channel.scale for channel in samples])
    free = own.fit.parameter_count
    found = [Way(FREE, 0, free, 0, own.seconds, own.objective, own.fit)]
    bases = others.bases(max(counts))
    most = min(basis.count for basis in bases.values())
    for count in sorted({min(count, most) for count in counts}):
        smaller = {name: basis.first(count) for name, basis in bases.items()}
        began = time.process_time()
        fitted = fit(groups, others, smaller, solve)
        seconds = prepared + time.process_time() - began
        laid = project(groups, lobes_of(own.fit.parameters), others, smaller, objective)
        sizes = others.unknowns(count), others.basis_values(count)
        made = _as_fit(fitted, others, own.fit, scales)
        found.append(Way(FITTED, count, *sizes, seconds, fitted.objective, made))
        found.append(Way(PROJECTED, count, *sizes, np.nan, laid.objective))
    return found


def _as_fit(found: Found, library: Library, own: Fit, scales: np.ndarray) -> Fit:
    """Return what was found as a fit of the model, its coefficients in 1/sr."""
    parameters = parameters_of(found.lobes, library.single)
    parameters["rho_d"] = parameters["rho_d"] * scales
    rho_s = parameters["rho_s"]
    parameters["rho_s"] = rho_s * scales.reshape(-1, *(1,) * (rho_s.ndim - 1))
    stored = {name: array.astype(np.float32) for name, array in parameters.items()}
    return Fit(own.model, {**own.parameters, **stored}, own.grid)


def measure(
    measured: Table,
    found: Sequence[Way],
    scenes: Mapping[str, Transport],
    tabulate: Callable[[Fit], Table],
) -> pd.DataFrame:
    """Compare the pictures of fits with those of the measurement.

    Parameters
    ----------
    measured : Table
    found : sequence of Way
    scenes : mapping of str to Transport
    tabulate : callable
        The model's.

    Returns
    -------
    DataFrame
        Columns `MEASURED` but material and variant; a row for each way, number of curves and scene.
    """
    fits = [way.fit for way in found if way.fit is not None]
    made = (tabulate(fit).where_measured(measured) for fit in fits)
    shown = columns([measured, *made])
    rows = []
    for scene, matrix in scenes.items():
        reference, *compared = pictures(matrix, shown)
        rendered = iter(compared)
        for way in found:
            level = float("nan")
            if way.fit is not None:
                level, _ = psnr_or_gap(next(rendered), reference, matrix.foreground)
            sizes = way.unknowns, BYTES * way.unknowns, BYTES * way.basis_values
            cost = way.seconds, way.objective
            rows.append((way.name, way.curves, *sizes, *cost, scene, level))
    return pd.DataFrame(rows, columns=MEASURED[2:])


def read(paths: Sequence[str]) -> pd.DataFrame:
    """Read what `measure` found of several materials; errors are those of `read_summary`."""
    numbers = [name for name in MEASURED if name not in TEXT]
    found = [_read(path, TEXT, numbers)[list(MEASURED)] for path in paths]
    return pd.concat(found, ignore_index=True)


def read_summary(path: str) -> pd.DataFrame:
    """Read a table of `summary`; errors are those of `tables.read`, or of a way that is none."""
    return _read(path, SUMMARY[:2], SUMMARY[2:])


def _read(path: str, text: Sequence[str], numbers: Sequence[str]) -> pd.DataFrame:
    table = tables.read(path, text, numbers)
    tables.check(path, table, "way", (FITTED, PROJECTED, FREE))
    tables.check_finite(path, table, ["curves"])
    return table


def summary(measured: pd.DataFrame) -> pd.DataFrame:
    """What each number of curves reaches, over all materials.

    Parameters
    ----------
    measured : DataFrame
        As `measure` makes it, of all materials and variants.

    Returns
    -------
    DataFrame
        Columns `SUMMARY`: bytes of one material, and of the curves that all have in common;
        median and largest seconds; objective, and its multiple of the free fit's, as geometric
        means over the materials, and the largest multiple; PSNR, mean over the scenes, then over
        the materials, and how much less than the free fit's it is: mean and most. Objectives of 0,
        as of a black material, and PSNR that are not finite count in none of them.
    """
    keys = ["material", "variant", "way", "curves"]
    numbers = dict.fromkeys(MEASURED[4:9], "first")
    each = measured.groupby(keys, sort=False).agg({**numbers, "psnr_db": mean_db}).reset_index()
    above = each["objective"].where(each["objective"] > 0)
    finite = each["psnr_db"].where(np.isfinite(each["psnr_db"]))
    counted = each.assign(objective=above, psnr_db=finite)
    free = counted[each["way"] == FREE].set_index(["material", "variant"])
    own = pd.MultiIndex.from_frame(each[["material", "variant"]])
    times = above.to_numpy() / free["objective"].reindex(own).to_numpy()
    lost = free["psnr_db"].reindex(own).to_numpy() - finite.to_numpy()
    each = each.assign(times=times, lost=lost, logarithm=np.log(above))
    each["log_times"] = np.log(each["times"])
    groups = each.groupby(["variant", "way", "curves"], sort=False)
    found = groups.agg(
        materials=("material", "nunique"),
        unknowns=("unknowns", "first"),
        bytes=("bytes", "first"),
        basis_bytes=("basis_bytes", "first"),
        seconds=("seconds", "median"),
        seconds_most=("seconds", "max"),
        objective=("logarithm", "mean"),
        times_free=("log_times", "mean"),
        times_free_most=("times", "max"),
        psnr_db=("psnr_db", mean_db),
        db_lost=("lost", mean_db),
        db_lost_most=("lost", "max"),
    ).reset_index()
    found["objective"], found["times_free"] = (
        np.exp(found["objective"]),
        np.exp(found["times_free"]),
    )
    return found[list(SUMMARY)]
