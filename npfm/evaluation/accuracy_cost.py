"""What accuracy costs: tables from records of fits and scenes, and from pictures of them."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.fitting.fits import load_record
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.transport import Transport, columns, pictures

TRACES = "material", "channel", "solver", "start", "thinned", "status", "seconds", "objective"
FITS = "material", "stage", "setting", "scene", "seconds", "bytes", "psnr_db"
SAMPLING = (
    "sampling", "samples", "seconds", "material", "picture_db", "psnr_db", "reference_db"
)  # fmt: skip
#: Columns that hold text, in any of the tables.
TEXT = {*TRACES[:4], "status", *FITS[:4], "sampling"}
#: What stands for a start in the row of all of them together.
TOGETHER = "together"


def read(paths: Sequence[str], columns: Sequence[str]) -> pd.DataFrame:
    """Read one of the tables from the files it was written to; errors are those of `tables.read`.

    Parameters
    ----------
    paths : sequence of str
        CSV files.
    columns : sequence of str
        `TRACES`, `FITS` or `SAMPLING`.
    """
    text = [name for name in columns if name in TEXT]
    numbers = [name for name in columns if name not in TEXT]
    return pd.concat([tables.read(path, text, numbers) for path in paths], ignore_index=True)


def traces(folders: Mapping[str, str], materials: Sequence[str]) -> pd.DataFrame:
    """Gather the objective after each iteration of every start.

    Parameters
    ----------
    folders : mapping of str to str
        Folder of the fits by each solver.
    materials : sequence of str
        What counts.

    Returns
    -------
    DataFrame
        Columns `TRACES`. Seconds count from the beginning of each start; the objective is a
        share of the zero model's. The runs by which gauss-newton compares starts, on some of the
        samples, have thinned = 1, others 0. A last row for each channel, its start `TOGETHER`,
        has the best objective and the seconds of all starts and preparations.

    Raises
    ------
    NpfmError
        If a record is missing or is none.
    """
    rows = []
    for solver, folder in folders.items():
        for material in materials:
            for channel in load_record(f"{folder}/{material}.npz")["channels"]:
                head = material, channel.channel, solver
                for trace in channel.traces:
                    thinned = solver == "gauss-newton" and trace.start != channel.best_start
                    kind = trace.start, int(thinned), trace.status
                    points = zip(trace.seconds, trace.objective, strict=True)
                    rows += [(*head, *kind, *point) for point in points]
                end = channel.status, channel.seconds, channel.objective
                rows.append((*head, TOGETHER, 0, *end))
    return pd.DataFrame(rows, columns=TRACES)


def fits(
    measured: Table,
    settings: Mapping[tuple[str, str], str],
    scenes: Mapping[str, Transport],
    tabulate: Callable[[str], Table],
) -> pd.DataFrame:
    """Compare fits of one material made with different settings.

    Parameters
    ----------
    measured : Table
    settings : mapping of (str, str) to str
        Path of the fit for each stage and setting.
    scenes : mapping of str to Transport
        Where they are compared.
    tabulate : callable
        Gives the table of the fit at a path.

    Returns
    -------
    DataFrame
        Columns `FITS` but material. Seconds are of the fit with all channels and starts, bytes
        those of its parameters.

    Raises
    ------
    NpfmError
        If a record is missing or is none.
    """
    paths = list(dict.fromkeys(settings.values()))
    values = np.empty((3, measured.grid.column_count, 1 + len(paths)), dtype=np.float32)
    for k, path in enumerate([None, *paths]):
        table = tabulate(path) if path else measured
        shown = table.where_measured(measured)
        values[..., k] = shown.grid.column_values(shown.values)
    quality = {}
    for scene, matrix in scenes.items():
        reference, *compared = pictures(matrix, values)
        for path, picture in zip(paths, compared, strict=True):
            quality[path, scene], _ = psnr_or_gap(picture, reference, matrix.foreground)
    rows = []
    for setting, path in settings.items():
        found = load_record(path)
        cost = sum(channel.seconds for channel in found["channels"]), found["bytes"]
        rows += [(*setting, scene, *cost, quality[path, scene]) for scene in scenes]
    return pd.DataFrame(rows, columns=FITS[1:])


def sampling(
    reference: str, builds: Sequence[str], materials: Mapping[str, tuple[Table, Table]]
) -> pd.DataFrame:
    """Compare scenes built with few samples with one built with many.

    Parameters
    ----------
    reference : str
        Folder of the scene with many samples.
    builds : sequence of str
        Folders of the others, each with the record of its making in a ``.json`` beside it.
    materials : mapping of str to (Table, Table)
        Measurement and fit of each material.

    Returns
    -------
    DataFrame
        Columns `SAMPLING`: seconds of the building; picture_db, the PSNR of the measurement's
        picture against that in the reference; psnr_db, the PSNR of the fit's picture against
        the measurement's, and reference_db, the same in the reference.
    """
    shown = [table for pair in materials.values() for table in pair]
    values = columns(shown)
    exact = transport.load(reference)
    foreground, truth = exact.foreground, pictures(exact, values)
    rows = []
    for build in builds:
        made = json.loads(Path(f"{build}.json").read_text())
        cost = "+".join(made["sampling"]), made["samples"], made["seconds"]
        found = pictures(transport.load(build), values)
        for k, material in enumerate(materials):
            measured, fit = found[2 * k], found[2 * k + 1]
            true_measured, true_fit = truth[2 * k], truth[2 * k + 1]
            compared = (measured, true_measured), (fit, measured), (true_fit, true_measured)
            decibels = (psnr_or_gap(*pair, foreground)[0] for pair in compared)
            rows.append((*cost, material, *decibels))
    return pd.DataFrame(rows, columns=SAMPLING)


def cost(fits: pd.DataFrame, sampling: pd.DataFrame) -> pd.DataFrame:
    """Return the price of a decibel, stage by stage.

    Parameters
    ----------
    fits, sampling : DataFrame
        As `fits`, of all materials, and `sampling` make them.

    Returns
    -------
    DataFrame
        Columns stage, setting, seconds, psnr_db, db_gained, seconds_per_db. Seconds and PSNR are
        means over materials and scenes; PSNR is that of fits, or in the stages of sampling that
        of the measurement's picture against the reference. db_gained is against the best of the
        settings above in the same stage, and seconds_per_db the further seconds for it; negative
        ones say that the better setting took less time.
    """
    means = _means(fits, ["stage", "setting"])
    models = means["stage"] == "model"
    rows = [means[models].sort_values("seconds", kind="stable"), means[~models]]
    samples = sampling["samples"].astype(int)
    built = sampling.assign(stage="sampling " + sampling["sampling"], setting=samples)
    built = built.drop(columns="psnr_db").rename(columns={"picture_db": "psnr_db"})
    table = pd.concat([*rows, _means(built, ["stage", "setting"])], ignore_index=True)
    gains = [_gains(stage) for _, stage in table.groupby("stage", sort=False)]
    return table.join(pd.concat(gains))


def _means(table: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    groups = table.groupby(keys, sort=False)
    return groups.agg({"seconds": "mean", "psnr_db": mean_db}).reset_index()


def _gains(stage: pd.DataFrame) -> pd.DataFrame:
    rows: list[tuple[float, float]] = []
    best: tuple[float, float] | None = None
    for seconds, psnr_db in zip(stage["seconds"], stage["psnr_db"], strict=True):
        gained = psnr_db - best[1] if best else np.nan
        price = (seconds - best[0]) / gained if best and gained > 0 else np.nan
        rows.append((gained, price))
        best = (seconds, psnr_db) if best is None or gained > 0 else best
    return pd.DataFrame(rows, index=stage.index, columns=["db_gained", "seconds_per_db"])
