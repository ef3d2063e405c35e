"""Figure 7 of Lawrence et al. 2004: the variance of pictures against samples a pixel."""

import argparse
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npfm.errors import NpfmError
from npfm.evaluation.importance import SOBOL
from npfm.figures import style, ways

HEIGHT, LINE = 0.55, 0.105  # inches: of a panel without its legend, and of a line of that


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm importance table")
    parser.add_argument("--materials", nargs="+", required=True, help="names")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(ways.read_labelled(arguments.table), arguments.materials)


def draw(table: pd.DataFrame, materials: Sequence[str]) -> Figure:
    """Draw a panel for each material and light, a line for each way with its slope.

    Parameters
    ----------
    table : DataFrame
        As `npfm.figures.ways.read_labelled` reads it.
    materials : sequence of str

    Raises
    ------
    NpfmError
        If the table lacks one of the materials.
    """
    rows = table[table["points"] == SOBOL]
    if missing := [name for name in materials if name not in set(rows["material"])]:
        raise NpfmError(f"the table has no rows of '{missing[0]}'; name a material that it has")
    lights = list(rows["light"].unique())
    names = rows["way"].unique()
    looks = ways.looks(names)
    height = (HEIGHT + LINE * len(names)) * len(materials)
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, height), layout="constrained")
        axes = figure.subplots(len(materials), len(lights), squeeze=False, sharex=True)
        for material, line in zip(materials, axes, strict=True):
            for light, ax in zip(lights, line, strict=True):
                one = rows[(rows["material"] == material) & (rows["light"] == light)]
                _draw(ax, one, looks)
                ax.set_title(f"{material}, {light}")
        figure.supylabel("variance over the mean square", fontsize="medium")
        for ax in axes[-1]:
            ax.set_xlabel("samples a pixel")
    return figure


def _draw(ax: Axes, rows: pd.DataFrame, looks: dict[str, style.Look]) -> None:
    for name, line in rows.groupby("way", sort=False):
        look = looks[str(name)]
        variance = line["n_var"] / line["samples"]
        ax.plot(
            line["samples"],
            variance,
            color=look.color,
            linestyle=look.linestyle,
            **look.mark,
            label=f"{name}: {slope(line['samples'], variance):+.2f}",
        )
    style.plain_logarithmic(ax.xaxis)
    ax.set_xticks(sorted(rows["samples"].unique()))
    ax.set_yscale("log")
    ax.grid(True)
    ax.legend(
        fontsize=4.5,
        frameon=False,
        loc="center left",
        bbox_to_anchor=(1, 0.5),
        title="slope of the variance",
        title_fontsize=4.5,
        labelspacing=0.3,
    )


def slope(samples: pd.Series, variance: pd.Series) -> float:
    """Exponent of the power of the samples that fits the variance best."""
    positive = variance > 0
    if positive.sum() < 2:
        return np.nan
    return float(np.polyfit(np.log(samples[positive]), np.log(variance[positive]), 1)[0])
