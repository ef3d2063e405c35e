"""Tables 2 and 3 of Lawrence et al. 2004 as plots: what factored sampling gains on others."""

import argparse

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from npfm.evaluation.importance import FACTORED, PAPER, SOBOL
from npfm.figures import style, ways

HEIGHT = 2.1  # inches, of a panel
#: How far apart ways stand that belong to one material, and the printed figure from ours.
STEP, BESIDE = 0.12, 0.05


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm importance table")
    parser.add_argument(
        "--strategies", nargs="+", required=True, help="what factored sampling is compared with"
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(ways.read_labelled(arguments.table, "published"), arguments.strategies)


def draw(table: pd.DataFrame, strategies: list[str]) -> Figure:
    """Draw a panel each light: variance over that of the paper's factored sampling, by material.

    Parameters
    ----------
    table : DataFrame
        As `npfm.figures.ways.read_labelled` reads it, with the column `published`.
    strategies : list of str
        Which are drawn, and the other recipes of the factored one.
    """
    rows = ways.most_samples(table, SOBOL)
    ours = (rows["strategy"] == FACTORED) & (rows["recipe"] != PAPER)
    rows = rows[rows["strategy"].isin(strategies) | ours]
    lights, looks = list(rows["light"].unique()), ways.looks(rows["way"].unique())
    with style.context():
        size = (style.PAGE_WIDTH, HEIGHT * len(lights) + 0.5)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(lights), 1, squeeze=False, sharex=True)[:, 0]
        for light, ax in zip(lights, axes, strict=True):
            _draw(ax, rows[rows["light"] == light], looks)
            ax.set_title(f"{light}: variance over that of {ways.label(FACTORED, PAPER)}")
        handles, labels = axes[0].get_legend_handles_labels()
        printed = Line2D([], [], color="black", ls="", marker="_", ms=5, mew=1.2)
        axes[0].legend(
            [*handles, printed],
            [*labels, "printed in the paper"],
            fontsize=6,
            loc="upper left",
            bbox_to_anchor=(1, 1),
            frameon=False,
        )
    return figure


def _draw(ax: Axes, rows: pd.DataFrame, looks: dict[str, style.Look]) -> None:
    materials = list(rows["material"].unique())
    for k, (name, line) in enumerate(rows.groupby("way", sort=False)):
        look = looks[str(name)]
        x = line["material"].map(materials.index) + STEP * (k - (len(looks) - 1) / 2)
        ax.plot(x, line["improvement"], color=look.color, ls="", **look.mark, label=str(name))
        ax.plot(x + BESIDE, line["published"], "_", color=look.color, ms=5, mew=1.2)
    ax.axhline(1, color="0.5", linewidth=0.5)
    ax.set_yscale("log")
    ax.set_xticks(range(len(materials)), materials, rotation=30, ha="right")
    ax.set_xlim(-0.6, len(materials) - 0.4)
    ax.grid(True, axis="y")
