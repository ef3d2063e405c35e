"""How far factors of equally good fits lie apart, and those that lie furthest."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npfm.errors import NpfmError
from npfm.evaluation import uniqueness as study
from npfm.figures import style
from npfm.figures.figure06 import COLORS, LABELS
from npfm.figures.slice_axes import factor_axis
from npfm.fitting import iterations
from npfm.fitting.factors.problem import SMALLEST
from npfm.fitting.iterations import Iterations
from npfm.reflectance.table import CHANNELS
from npfm.storage.names import distinct

ROW_HEIGHT, LEGEND_HEIGHT = 2.2, 0.3  # inches
#: Panels, from left to right; distances below the least are drawn there.
FACTORS, LEAST = ("D", "F", "G"), 1e-4
#: Of materials in the panels of distances, so many are named.
NAMED = 2


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm uniqueness table")
    parser.add_argument(
        "--iterations", nargs="+", required=True, help="made by npfm fit --iterations, of each"
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table and the records that the arguments name."""
    table = study.read([arguments.table])
    material, channel = furthest(table)
    paths = arguments.iterations
    known = dict(zip(distinct(Path(path).stem for path in paths), paths, strict=True))
    if material not in known:
        raise NpfmError(f"{arguments.table}: no record of {material} among --iterations")
    return draw(table, iterations.load(known[material]), f"{material}, {channel}")


def furthest(table: pd.DataFrame) -> tuple[str, str]:
    """Material and channel whose equally good factors lie furthest apart."""
    row = table.iloc[int(table[list(FACTORS)].max(axis=1).to_numpy().argmax())]
    return str(row["material"]), str(row["channel"])


def draw(table: pd.DataFrame, found: Iterations, shown: str) -> Figure:
    """Draw distances over the ratio of singular values, and the factors of one channel.

    Parameters
    ----------
    table : DataFrame
        As `npfm.evaluation.uniqueness.measure` makes it, of all materials.
    found : Iterations
        Of the material that is shown.
    shown : str
        Its name and the channel, with a comma between.
    """
    channel = shown.rpartition(", ")[2]
    with style.context():
        size = style.PAGE_WIDTH, 2 * ROW_HEIGHT + LEGEND_HEIGHT
        figure = Figure(figsize=size, layout="constrained")
        above, below = figure.subplots(2, 3, sharey="row")
        for ax, name in zip(above, FACTORS, strict=True):
            _draw_distances(ax, table, name)
        above[0].set_ylabel("distance of equally good factors\n(logarithms, root mean square)")
        for ax, name in zip(below, FACTORS, strict=True):
            _draw_ends(ax, found, CHANNELS.index(channel), name)
        below[0].set_ylabel(f"{shown}\nrelative")
        handles = above[0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=3, frameon=False)
    return figure


def _draw_distances(ax: Axes, table: pd.DataFrame, name: str) -> None:
    for channel, rows in table.groupby("channel", sort=False):
        ax.plot(
            rows["sigma_ratio"],
            np.maximum(rows[name], LEAST),
            linestyle="none",
            marker="o",
            color=(COLORS[str(channel)], 0.6),
            markeredgewidth=0,
            label=str(channel),
        )
    ax.axhline(study.APART, color="0.4", linestyle=":")
    for _, row in table.nlargest(NAMED, name).drop_duplicates("material").iterrows():
        place = row["sigma_ratio"], max(row[name], LEAST)
        left = place[0] > table["sigma_ratio"].max() / 2
        look: dict[str, Any] = {"xytext": (-3 if left else 3, 2), "ha": "right" if left else "left"}
        ax.annotate(row["material"], place, textcoords="offset points", fontsize=5, **look)
    ax.set(yscale="log", title=name, xlim=(0, None))
    ax.margins(y=0.12)  # for the names
    ax.set_xlabel("second singular value of B over the first")
    ax.grid(True)
    ax.set_axisbelow(True)


def _draw_ends(ax: Axes, found: Iterations, channel: int, name: str) -> None:
    best, *others = getattr(found, name)[study.near(found, channel)]
    for factor in others:
        # Scales are free: each curve is drawn where its middle meets the best one's.
        scale = np.exp(np.median(np.log(best / np.maximum(factor, SMALLEST))))
        ax.plot(found.angles[name], scale * factor, color=("#0072B2", 0.7))
    ax.plot(found.angles[name], best, color="k", linestyle=(0, (3, 1.5)))
    factor_axis(ax, name)
    ax.set(ylim=(5e-7, 20), xlabel=LABELS[name])
