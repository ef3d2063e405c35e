"""The tables of a run: tidy data frames from fits and pictures.

Every table is made from explicit lists of names, never from what lies in a folder, so that files
left over from an earlier run do not count. Rows stand in the order of those lists.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from tqdm import tqdm

from npfm.errors import NpfmError
from npfm.evaluation.comparison import decibels_and_gaps
from npfm.evaluation.metrics import mean_db
from npfm.fitting.factors.smith import diffuseness
from npfm.fitting.fits import ChannelRecord, load, load_record
from npfm.storage.files import Kind, marked, replacing

#: Values are kept to six digits: enough for any of the tables, and the same on every machine.
FLOAT_FORMAT = "%.6g"

#: Any table; `write` looks closer.
TABLE = Kind("a table", ".csv", marked(b","))


def write(path: str | Path, table: pd.DataFrame) -> None:
    """Write a table as CSV; infinity as ``inf``, a missing value as nothing.

    A file that is there already is replaced if it has the same columns.
    """
    header = ",".join(map(str, table.columns)) + "\n"
    kind = Kind("this table", TABLE.suffix, marked(header.encode()))
    with replacing(path, kind) as temporary:
        table.to_csv(temporary, index=False, float_format=FLOAT_FORMAT, lineterminator="\n")


def read(
    path: str | Path, text: Sequence[str], numbers: Sequence[str], *, may_be_empty: bool = False
) -> pd.DataFrame:
    """Read columns of a table that `write` has written.

    Parameters
    ----------
    path : str or Path
        CSV file.
    text, numbers : sequence of str
        Columns to be read as text and as numbers.
    may_be_empty : bool
        Whether a table without rows will do.

    Raises
    ------
    NpfmError
        If the file is absent or no CSV, or a column is missing or holds something else.
    """
    types = dict.fromkeys(text, str) | dict.fromkeys(numbers, float)
    # a material may be called "none" or "001": only an empty number is a missing value
    missing = {name: [""] for name in numbers}
    try:
        _check_rows(path)
        table = pd.read_csv(
            path, usecols=list(types), dtype=types, keep_default_na=False, na_values=missing
        )
    except (OSError, ValueError, csv.Error) as error:
        why = " ".join(str(error).split())
        raise NpfmError(f"{path}: cannot be read as a table ({why}); make it again") from error
    if table.empty and not may_be_empty:
        raise NpfmError(f"{path}: a table without rows; make it again")
    return table


def check(path: str | Path, table: pd.DataFrame, column: str, known: Sequence[str]) -> None:
    """Refuse a table with another word in a column than those that are known.

    Raises
    ------
    NpfmError
        Naming the first.
    """
    wrong = table.loc[~table[column].isin(known), column]
    if not wrong.empty:
        raise NpfmError(
            f"{path}: the {column} '{wrong.iloc[0]}' is none of {', '.join(known)}; make it again"
        )


def check_finite(path: str | Path, table: pd.DataFrame, columns: Sequence[str]) -> None:
    """Refuse a table with a number missing or infinite in one of some columns.

    Raises
    ------
    NpfmError
        Naming the first of the columns.
    """
    for column in columns:
        if not np.isfinite(table[column]).all():
            raise NpfmError(f"{path}: no number in the column {column}; make it again")


def _check_rows(path: str | Path) -> None:
    """Raise ValueError for a file that is cut off: pandas would fill it up in silence."""
    content = Path(path).read_text(encoding="utf-8")
    rows = csv.reader(io.StringIO(content, newline=""))
    columns = {len(row) for row in rows if row}
    if len(columns) > 1 or (content and not content.endswith("\n")):
        raise ValueError("a row is cut off or has too many columns")


def read_psnr(path: str | Path) -> pd.DataFrame:
    """Read the table that `psnr` makes; errors are those of `read`, or a picture twice.

    The PSNR is NaN where there is a gap.
    """
    names = ["scene", "material", "variant"]
    table = read(path, names, ["psnr_db"])
    twice = table[table.duplicated(names)]
    if not twice.empty:
        picture = " ".join(twice[names].iloc[0])
        raise NpfmError(f"{path}: '{picture}' is there twice; list every name once")
    return table


def read_published(path: str | Path) -> pd.DataFrame:
    """Read the table of `npfm.papers.authors_distance`; errors are those of `read`."""
    readings = ["published", "g_at_centres", "f_at_degrees"]
    numbers = [*readings, "ours", "log_ratio", "log_error"]
    return read(path, ["material", "channel"], numbers, may_be_empty=True)


def psnr(
    run: str | Path,
    scenes: Sequence[str],
    materials: Sequence[str],
    variants: Sequence[str],
    missing: Sequence[str] = (),
) -> pd.DataFrame:
    """Compare every picture of a run with that of the measurement.

    Parameters
    ----------
    run : str or Path
        Folder that holds ``renders/<scene>/<material>/<variant>.exr`` and ``measured.exr``.
    scenes, materials, variants : sequence of str
        What counts.
    missing : sequence of str
        Pairs ``variant/material`` that do not.

    Returns
    -------
    DataFrame
        Columns scene, material, variant, psnr_db (infinite for equal pictures), gap: why there is
        no psnr_db, as of a material that is black. One such material keeps nothing from others.

    Raises
    ------
    NpfmError
        If a picture is missing or is not of the reference's size.
    """
    rows = []
    pairs = tqdm(list(product(scenes, materials)), desc="psnr", unit="reference", disable=None)
    for scene, material in pairs:
        folder = Path(run) / "renders" / scene / material
        there = [name for name in variants if f"{name}/{material}" not in missing]
        pictures = [folder / f"{name}.exr" for name in there]
        found = decibels_and_gaps(folder / "measured.exr", pictures)
        rows += [(scene, material, name, *row) for name, row in zip(there, found, strict=True)]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db", "gap"])


def fits(
    run: str | Path,
    materials: Sequence[str],
    variants: Sequence[str],
    missing: Sequence[str] = (),
) -> pd.DataFrame:
    """Gather how every channel was fitted.

    Parameters
    ----------
    run : str or Path
        Folder that holds ``fits/<variant>/<material>.npz`` and their records.
    materials, variants : sequence of str
        What counts.
    missing : sequence of str
        Pairs ``variant/material`` that do not.

    Returns
    -------
    DataFrame
        One row a channel. Iterations and golden-section calls are of all `starts` together;
        objectives are shares of that of the zero model.

    Raises
    ------
    NpfmError
        If a record is missing or is none.
    """
    return pd.DataFrame(
        {"material": material, "variant": variant, **_channel_row(channel)}
        for material, variant in product(materials, variants)
        if f"{variant}/{material}" not in missing
        for channel in load_record(_fit_path(run, variant, material))["channels"]
    )


def _channel_row(channel: ChannelRecord) -> dict:
    return {
        "channel": channel.channel,
        "seconds": channel.seconds,
        "iterations": channel.iterations,
        "gss_calls": channel.gss_calls,
        "starts": len(channel.traces),
        "best_start": channel.best_start,
        "objective": channel.objective,
        "objective_floor": channel.objective_floor,
        "status": channel.status,
    }


def sizes(run: str | Path, psnr: pd.DataFrame) -> pd.DataFrame:
    """Size of a fit of each variant: columns variant, parameters, bytes.

    Of the largest, should the fits of a variant differ.

    Parameters
    ----------
    run : str or Path
        Folder that holds ``fits/<variant>/<material>.npz`` and their records.
    psnr : DataFrame
        As `psnr` makes it: the variants and materials that count.

    Raises
    ------
    NpfmError
        If a record is missing or is none.
    """
    rows = []
    for variant, pictures in psnr.groupby("variant", sort=False):
        materials = pictures["material"].unique()
        records = [load_record(_fit_path(run, str(variant), material)) for material in materials]
        rows.append((variant, *(max(r[key] for r in records) for key in ("parameters", "bytes"))))
    return pd.DataFrame(rows, columns=["variant", "parameters", "bytes"])


def materials(run: str | Path, names: Sequence[str]) -> pd.DataFrame:
    """Diffuseness of the materials: equation 19 of the naive fit's D, mean over the channels.

    Parameters
    ----------
    run : str or Path
        Folder that holds ``fits/naive/<material>.npz``.
    names : sequence of str
        What counts.

    Returns
    -------
    DataFrame
        Columns material, diffuseness (dimensionless, at most pi).

    Raises
    ------
    NpfmError
        If a fit is missing or is not one of the naive model.
    """
    rows = []
    for name in names:
        path = _fit_path(run, "naive", name)
        fit = load(path)
        if fit.model != "naive":
            raise NpfmError(f"{path}: a fit of {fit.model}, not of naive; fit it again")
        rows.append((name, diffuseness(fit.parameters["D"].astype(float), fit.grid).mean()))
    return pd.DataFrame(rows, columns=["material", "diffuseness"])


def summary(psnr: pd.DataFrame, sizes: pd.DataFrame, paper: Mapping[str, float]) -> pd.DataFrame:
    """Average the PSNR of each variant over materials, and compare with the paper's.

    Parameters
    ----------
    psnr, sizes : DataFrame
        As `psnr` and `sizes` make them.
    paper : mapping of str to float
        The averages that the paper prints, in dB, by variant.

    Returns
    -------
    DataFrame
        One row a variant and scene, and one with the scene ``all`` over all pictures, which is
        the average that the paper prints. `materials` have a PSNR; they differ where a variant has
        no fit of some. Means are those of `mean_db`: so many pictures that equal their reference
        (`exact`) or have no PSNR (`gaps`) are left out of them. Medians are over `exact` as well.
    """
    counted = psnr.assign(
        material=psnr["material"].where(psnr["psnr_db"].notna()),
        exact=np.isposinf(psnr["psnr_db"]),
        gap=psnr["psnr_db"].isna(),
    )
    over_all = counted.assign(scene="all")
    groups = pd.concat([counted, over_all]).groupby(["variant", "scene"], sort=False)
    table = groups.agg(
        materials=("material", "nunique"),
        mean_psnr_db=("psnr_db", mean_db),
        median_psnr_db=("psnr_db", "median"),
        exact=("exact", "sum"),
        gaps=("gap", "sum"),
    ).reset_index()
    order = {name: rank for rank, name in enumerate(sizes["variant"])}
    table = table.sort_values("variant", key=lambda names: names.map(order), kind="stable")
    table = table.merge(sizes, on="variant", how="left")
    printed = table["variant"].map(paper)
    return table.assign(paper_psnr_db=printed.where(table["scene"] == "all"))


def _fit_path(run: str | Path, variant: str, material: str) -> Path:
    return Path(run) / "fits" / variant / f"{material}.npz"
