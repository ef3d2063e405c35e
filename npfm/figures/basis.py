"""Objective and PSNR of fits in a basis of other materials' factors, by its size."""

import argparse
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from npfm.evaluation.basis import FITTED, FREE, PROJECTED, read_summary
from npfm.figures import own_colors, style

HEIGHT = 2.5  # inches
LINES: dict[str, Any] = {FITTED: "-", PROJECTED: (0, (3, 1.5)), FREE: ":"}
SAID = {
    FITTED: "fitted in the curves",
    PROJECTED: "its fit laid into the curves",
    FREE: "factors free",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm basis table")
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(read_summary(arguments.table), own_colors.colors(arguments))


def draw(table: pd.DataFrame, colors: Mapping[str, str] | None = None) -> Figure:
    """Draw the objective, and PSNR against curves and against bytes; a line each variant and way.

    Parameters
    ----------
    table : DataFrame
        As `npfm.evaluation.basis.summary` makes it; what is not finite is left out.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    """
    looks = style.looks(table["variant"].unique(), colors)
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        objective, by_curves, by_bytes = figure.subplots(1, 3)
        for ax, x, y in (
            (objective, "curves", "times_free"),
            (by_curves, "curves", "psnr_db"),
            (by_bytes, "bytes", "psnr_db"),
        ):
            _draw_lines(ax, table, x, y, looks)
            ax.grid(True)
            ax.set_axisbelow(True)
        counts = sorted(set(table.loc[table["way"] != FREE, "curves"].astype(int)))
        for ax in (objective, by_curves):
            ax.set_xscale("log")
            ax.set_xticks(counts, map(str, counts), minor=False)
            ax.set_xticks([], minor=True)
            ax.set_xlabel("curves of each of D, F and G")
        style.plain_logarithmic(objective.yaxis)
        style.plain_logarithmic(by_bytes.xaxis)
        objective.set_ylabel("objective, as a multiple of the free fit's")
        by_curves.set_ylabel("PSNR (dB), mean")
        by_bytes.set_ylabel("PSNR (dB), mean")
        by_bytes.set_xlabel("bytes of a material")
        handles = [
            *(Line2D([], [], label=k, color=look.color, **look.mark) for k, look in looks.items()),
            *(
                Line2D([], [], color="k", linestyle=LINES[w], label=said)
                for w, said in SAID.items()
            ),
        ]
        figure.legend(
            handles=handles, loc="outside upper center", ncols=len(handles), frameon=False
        )
    return figure


def _draw_lines(
    ax: Axes, table: pd.DataFrame, x: str, y: str, looks: Mapping[str, style.Look]
) -> None:
    for (variant, way), rows in table.groupby(["variant", "way"], sort=False):
        look, values = looks[str(variant)], rows[y].where(np.isfinite(rows[y]))
        line: dict[str, Any] = {"color": look.color, "linestyle": LINES[str(way)]}
        if str(way) != FREE:
            ax.plot(rows[x], values, **line, **look.mark)
            continue
        ax.axhline(values.iloc[0], **line)
        if x == "bytes":
            ax.plot(rows[x], values, linestyle="none", color=look.color, **look.mark)
