"""Figure 7 of Bagher et al. 2016: renderings of fits with and without compressive weighting."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db
from npfm.figures import renderings, style


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--psnr", required=True, help="CSV made by npfm tables psnr")
    parser.add_argument("--run", required=True, help="folder of the run")
    parser.add_argument("--scene", required=True, help="scene to show")
    parser.add_argument("--materials", nargs="+", required=True, help="rows")
    parser.add_argument(
        "--columns",
        nargs="+",
        required=True,
        metavar="HEADING=WITH,WITHOUT",
        help="variants fitted with and without the weight, by what they have in common",
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    rows = [renderings.Row(material, a.scene) for material in a.materials]
    return draw(a.run, tables.read_psnr(a.psnr), rows, pairs(a.columns))


def pairs(columns: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Variants with and without the weight, by what stands over the two."""
    parsed = {}
    for column in columns:
        heading, _, variants = column.rpartition("=")
        weighted, comma, plain = variants.partition(",")
        if not heading or not comma or "," in plain:
            raise NpfmError(f"--columns '{column}': give it as heading=with,without")
        parsed[heading] = weighted, plain
    return parsed


def draw(
    run: str | Path,
    psnr: pd.DataFrame,
    rows: Sequence[renderings.Row],
    columns: Mapping[str, tuple[str, str]],
) -> Figure:
    """Draw the measurement, and pairs of fits with and without compressive weighting.

    Parameters
    ----------
    run, psnr
        As `renderings.draw` takes them.
    rows : sequence of Row
        What is shown.
    columns : mapping of str to (str, str)
        Variants with and without, by what stands over the two.
    """
    variants = [variant for pair in columns.values() for variant in pair]
    headings = [f"{what}\n{how}" for what in columns for how in ("weighted", "not weighted")]
    remark = gains(psnr, rows, columns)
    with style.context():
        figure, _ = renderings.draw(run, psnr, rows, variants, remark, headings=headings)
    return figure


def gains(
    psnr: pd.DataFrame, rows: Sequence[renderings.Row], columns: Mapping[str, tuple[str, str]]
) -> str:
    """Tell by how much the weight raises PSNR, mean over the scenes, for each row."""
    means = psnr.groupby(["material", "variant"])["psnr_db"].agg(mean_db)
    by_material = []
    for row in rows:
        of = means.xs(row.material)
        gained = [of[weighted] - of[plain] for weighted, plain in columns.values()]
        # adding 0 turns -0.0 into 0.0
        numbers = ", ".join(
            "no PSNR" if np.isnan(gain) else f"{round(gain, 1) + 0.0:+.1f}" for gain in gained
        )
        by_material.append(f"{row.material} {numbers}")
    scenes = ", ".join(psnr["scene"].unique())
    return (
        f"Gain by weighting ({' / '.join(columns)}) in dB, mean over the scenes {scenes}: "
        + "; ".join(by_material)
    )
