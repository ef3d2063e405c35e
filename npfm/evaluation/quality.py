"""The table ``quality.csv`` of a run: fits by many metrics, and means of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from npfm.errors import NpfmError, suggest
from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db

COLUMNS = ("scene", "material", "variant", "metric", "value", "unit", "better")
SUMMARY = ("variant", "scene", "metric", "materials", "mean", "median", "unit", "better")
#: The scene of what is of a table and of no picture; no scene of a run may be called so.
ALL = "all"


@dataclass(frozen=True)
class Metric:
    """What a metric is called in figures, its unit, and which values of it are better."""

    label: str
    unit: str
    better: str


#: Of pictures: the paper's PSNR, of linear radiance, and those of `npfm.evaluation.perceived`.
PICTURES: Mapping[str, Metric] = {
    "psnr": Metric("PSNR", "dB", "higher"),
    "psnr-tone-mapped": Metric("PSNR of tone-mapped pictures", "dB", "higher"),
    "ssim": Metric("SSIM", "1", "higher"),
    "ldr-flip": Metric("LDR-FLIP", "1", "lower"),
    "hdr-flip": Metric("HDR-FLIP", "1", "lower"),
    "delta-e-2000": Metric("CIEDE2000", "1", "lower"),
    "hyab": Metric("HyAB", "1", "lower"),
}
#: Of tables (`npfm.evaluation.table_distances`).
TABLES: Mapping[str, Metric] = {
    "cube-root": Metric("cube roots of tables", "sr^(-1/3)", "lower"),
    "logarithm": Metric("logarithms of tables", "1", "lower"),
}
METRICS = {**PICTURES, **TABLES}


def metric(name: str) -> Metric:
    """Return the metric of a name.

    Raises
    ------
    NpfmError
        If there is none.
    """
    if name not in METRICS:
        raise NpfmError(f"unknown metric '{name}'; {suggest(name, METRICS)}")
    return METRICS[name]


def gather(paths: Sequence[str | Path]) -> pd.DataFrame:
    """Put tables of `material` together, in the order of the files; errors are those of `read`."""
    return pd.concat([read(path) for path in paths], ignore_index=True)


def read(path: str | Path) -> pd.DataFrame:
    """Read a table of `COLUMNS`.

    Raises
    ------
    NpfmError
        As `tables.read`, or if a metric is unknown or a value is there twice.
    """
    table = tables.read(path, [name for name in COLUMNS if name != "value"], ["value"])
    for name in table["metric"].unique():
        try:
            metric(name)
        except NpfmError as error:
            raise NpfmError(f"{path}: {error}") from error
    names = ["scene", "material", "variant", "metric"]
    twice = table[table.duplicated(names)]
    if not twice.empty:
        there = " ".join(twice[names].iloc[0])
        raise NpfmError(f"{path}: '{there}' is there twice; list every name once")
    return table[list(COLUMNS)]


def values_of(quality: pd.DataFrame, name: str) -> pd.DataFrame:
    """One metric of a table of `COLUMNS`: scene, material, variant, value.

    Raises
    ------
    NpfmError
        If the metric is unknown or not in the table.
    """
    metric(name)
    rows = quality[quality["metric"] == name]
    if rows.empty:
        raise NpfmError(f"no value of '{name}'; make the table again with npfm quality")
    return rows[["scene", "material", "variant", "value"]].reset_index(drop=True)


def summary(quality: pd.DataFrame) -> pd.DataFrame:
    """Mean and median of every metric over the materials.

    Returns
    -------
    DataFrame
        Columns `SUMMARY`: one row a variant, scene and metric, and one of all scenes together.
        Values that are infinite, as PSNR of equal pictures, or missing are left out of means;
        `materials` have a value.
    """
    pictures = quality[quality["scene"] != ALL]
    counted = pd.concat([pictures, quality.assign(scene=ALL)])
    counted = counted.assign(material=counted["material"].where(counted["value"].notna()))
    groups = counted.groupby(["variant", "scene", "metric"], sort=False)
    table = groups.agg(
        materials=("material", "nunique"),
        mean=("value", mean_db),
        median=("value", "median"),
        unit=("unit", "first"),
        better=("better", "first"),
    ).reset_index()
    ranks = {name: rank for rank, name in enumerate(quality["variant"].unique())}
    return table.sort_values("variant", key=lambda names: names.map(ranks), kind="stable")[
        list(SUMMARY)
    ].reset_index(drop=True)
