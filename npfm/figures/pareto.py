"""Mean PSNR against mean seconds, and against bytes, of every variant by every solver."""

import argparse
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from npfm.evaluation.accuracy_cost import FITS, read
from npfm.evaluation.metrics import mean_db
from npfm.figures import own_colors, style

HEIGHT, LEGEND_LINE, LEGEND_COLUMNS = 2.6, 0.16, 3  # inches, but for the columns
LARGEST_MARK = 260.0  # square points, for the most bytes
FRONT: dict[str, Any] = {"color": "0.5", "linewidth": 0.7}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument(
        "--fits", nargs="+", required=True, help="CSVs made by npfm accuracy-cost fits"
    )
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the tables that the arguments name."""
    return draw(read(arguments.fits, FITS), own_colors.colors(arguments))


def draw(fits: pd.DataFrame, colors: Mapping[str, str] | None = None) -> Figure:
    """Draw one mark a variant and solver, its area in proportion to the bytes of a fit.

    Parameters
    ----------
    fits : DataFrame
        As `npfm.evaluation.accuracy_cost.fits` makes it, of all materials; the stage ``model``
        counts.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    """
    models = fits[fits["stage"] == "model"].groupby("setting", sort=False)
    means = models.agg({"seconds": "mean", "bytes": "max", "psnr_db": mean_db})
    marks = _marks(list(means.index), colors)
    lines = 2 + -(-(len(means) + 1) // LEGEND_COLUMNS)
    with style.context():
        size = style.PAGE_WIDTH, HEIGHT + LEGEND_LINE * lines
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(1, 2, sharey=True)
        for ax, cost in zip(axes, ("seconds", "bytes"), strict=True):
            _draw_panel(ax, means, marks, cost)
        axes[0].set_xlabel("seconds to fit a material (mean)")
        axes[1].set_xlabel("bytes of a fit")
        axes[0].set_ylabel("PSNR (dB), mean over materials and scenes")
        handles = [
            Line2D([], [], markersize=4, label=f"{label}: {size:.0f} bytes", **mark)
            for (label, mark), size in zip(marks.items(), means["bytes"], strict=True)
        ]
        figure.legend(
            handles=[*handles, Line2D([], [], label="Pareto front", **FRONT)],
            title="area of a mark: bytes of a fit; hollow: awls",
            loc="outside upper center",
            ncols=LEGEND_COLUMNS,
            frameon=False,
        )
    return figure


def front(costs: pd.Series, values: pd.Series) -> list[int]:
    """Positions of the points that no other one beats, by increasing cost.

    Parameters
    ----------
    costs, values : Series
        Less of the first is better, and more of the second.
    """
    best, kept = -np.inf, []
    for k in np.lexsort((-values, costs)):
        if values.iloc[k] > best:
            kept.append(int(k))
            best = values.iloc[k]
    return kept


def _marks(settings: list[str], colors: Mapping[str, str] | None) -> dict[str, dict[str, Any]]:
    """How each variant and solver is drawn, by its label."""
    names = [setting.partition("/")[::2] for setting in settings]
    looks = style.looks(list(dict.fromkeys(variant for variant, _ in names)), colors)
    return {
        ", ".join(filter(None, (variant, solver))): {
            "marker": looks[variant].marker,
            "markeredgecolor": looks[variant].color,
            "markerfacecolor": "white" if solver == "awls" else looks[variant].color,
            "linestyle": "none",
        }
        for variant, solver in names
    }


def _draw_panel(ax: Axes, means: pd.DataFrame, marks: dict[str, dict[str, Any]], cost: str) -> None:
    for mark, row in zip(marks.values(), means.to_dict("records"), strict=True):
        width = np.sqrt(LARGEST_MARK * row["bytes"] / means["bytes"].max())
        ax.plot(row[cost], row["psnr_db"], markersize=width, **mark)
    style.plain_logarithmic(ax.xaxis)
    ax.margins(0.15)
    ax.grid(True)
    ax.set_axisbelow(True)
    means = means[np.isfinite(means["psnr_db"])]
    if means.empty:
        return
    on = means.iloc[front(means[cost], means["psnr_db"])]
    right, bottom = ax.get_xlim()[1], ax.get_ylim()[0]
    ax.set(xlim=ax.get_xlim(), ylim=ax.get_ylim())
    # From edge to edge: left of it and above it nothing was reached.
    x = [on[cost].iloc[0], *on[cost], right]
    y = [bottom, *on["psnr_db"], on["psnr_db"].iloc[-1]]
    ax.plot(x, y, drawstyle="steps-post", zorder=1, **FRONT)
