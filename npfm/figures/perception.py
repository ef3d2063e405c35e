"""How well every metric of fits agrees with what people see."""

import argparse
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npfm.evaluation import perception, quality
from npfm.figures import style

ROW_HEIGHT, MARGIN = 0.3, 1.0  # inches
#: Marks of groups of models or classes of materials, from above in each row; the colours are of
#: Okabe and Ito, told apart by their shapes as well.
MARKS = (("#000000", "s"), ("#0072B2", "o"), ("#D55E00", "^"), ("#009E73", "D"), ("#CC79A7", "v"))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument(
        "--correlations", required=True, help="CSV made by npfm perception correlations"
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(perception.read(arguments.correlations))


def draw(correlations: pd.DataFrame) -> Figure:
    """Draw the correlations of every metric: by group of models, and by class of material.

    Parameters
    ----------
    correlations : DataFrame
        As `npfm.evaluation.perception.correlations` makes it; metrics stand in the order of
        their correlation over the first group and all materials.
    """
    first = correlations["models"].iloc[0]
    over_all = correlations[correlations["class"] == perception.ALL]
    leading = over_all[over_all["models"] == first].sort_values("spearman")
    metrics = list(leading["metric"])
    of_first = correlations[correlations["models"] == first]
    with style.context():
        size = style.PAGE_WIDTH, ROW_HEIGHT * len(metrics) + MARGIN
        figure = Figure(figsize=size, layout="constrained")
        left, right = figure.subplots(1, 2, sharex=True, sharey=True)
        _panel(left, _named(over_all, "models"), metrics)
        _panel(right, _named(of_first, "class"), metrics)
        left.set_yticks(range(len(metrics)), [quality.METRICS[m].label for m in metrics])
        left.set_title("all materials, by how near the fits are to those shown", loc="left")
        right.set_title(f"fits {first}, by class of material", loc="left")
    return figure


def _named(table: pd.DataFrame, column: str) -> Mapping[str, pd.DataFrame]:
    """Rows by what a column says, under a name with the number of pairs and materials."""
    named = {}
    for name, rows in table.groupby(column, sort=False):
        pairs, materials = (rows[count].iloc[0] for count in ("pairs", "materials"))
        named[f"{name}: {pairs:.0f} pairs, {materials:.0f} materials"] = rows
    return named


def _panel(ax: Axes, groups: Mapping[str, pd.DataFrame], metrics: Sequence[str]) -> None:
    offsets = np.linspace(0.3, -0.3, len(groups)) if len(groups) > 1 else np.zeros(1)
    for (name, rows), offset, (color, marker) in zip(groups.items(), offsets, MARKS, strict=False):
        rows = rows.set_index("metric").loc[list(metrics)]
        places = np.arange(len(metrics)) + offset
        ax.hlines(places, rows["low"], rows["high"], color=color, linewidth=0.8)
        ax.plot(rows["spearman"], places, marker, color=color, label=name, markersize=3)
    ax.axvline(0, color="0.6", linewidth=0.5)
    ax.grid(True, axis="x")
    ax.set_axisbelow(True)
    ax.set_xlabel("rank correlation with people's opinions")
    ax.legend(frameon=False, loc="upper left", bbox_to_anchor=(0, -0.13), borderpad=0)
