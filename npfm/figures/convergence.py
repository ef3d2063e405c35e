"""Objective against seconds: every start of every channel, by both solvers."""

import argparse
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from npfm.evaluation.accuracy_cost import TRACES, read
from npfm.figures import style

PANEL_HEIGHT, LEGEND_HEIGHT = 1.2, 0.75  # inches
#: Starts begin at 0 s, which a logarithmic axis does not have; they are drawn here.
FIRST_SECOND = 0.01
COLORS = {"gauss-newton": style.LOOKS["independent-g"].color, "awls": style.OTHER_COLORS[0]}
#: How a run is drawn, by its solver and whether it sees a part of the samples only.
RUNS: dict[tuple[str, int], dict[str, Any]] = {
    ("gauss-newton", 0): {"linewidth": 1.2, "zorder": 3},
    ("gauss-newton", 1): {"linewidth": 0.5, "linestyle": (0, (3, 1)), "zorder": 2},
    ("awls", 0): {"linewidth": 0.5, "zorder": 1},
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--traces", required=True, help="CSV made by npfm accuracy-cost traces")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(read([arguments.traces], TRACES))


def draw(traces: pd.DataFrame) -> Figure:
    """Draw a panel for each material and channel.

    Parameters
    ----------
    traces : DataFrame
        As `npfm.evaluation.accuracy_cost.traces` makes it.
    """
    materials, channels = traces["material"].unique(), traces["channel"].unique()
    size = style.PAGE_WIDTH, PANEL_HEIGHT * len(materials) + LEGEND_HEIGHT
    with style.context():
        figure = Figure(figsize=size, layout="constrained")
        shape = len(materials), len(channels)
        axes = figure.subplots(*shape, sharex=True, sharey="row", squeeze=False)
        for ax, (material, channel) in zip(
            axes.flat, [(m, c) for m in materials for c in channels], strict=True
        ):
            here = (traces["material"] == material) & (traces["channel"] == channel)
            _draw_panel(ax, traces[here])
            ax.set_title(f"{material}, {channel}", loc="left", pad=2)
        for ax in axes[-1]:
            ax.set_xlabel("seconds since the start began")
        figure.supylabel("objective, share of the zero model's", fontsize="medium")
        figure.legend(handles=_legend(traces), loc="outside upper center", ncols=2, frameon=False)
    return figure


def _draw_panel(ax: Axes, traces: pd.DataFrame) -> None:
    together = traces["start"] == "together"
    runs = traces[~together].groupby(["solver", "thinned", "start"], sort=False)
    for _, run in runs:
        solver, thinned = run["solver"].iloc[0], run["thinned"].iloc[0]
        seconds = np.maximum(run["seconds"], FIRST_SECOND)
        ax.plot(seconds, run["objective"], color=COLORS[solver], **RUNS[solver, thinned])
    ends = traces[together].set_index("solver")
    for solver, end in ends.iterrows():
        ax.plot(end["seconds"], end["objective"], **_end(COLORS[str(solver)]))
    ratio = ends["objective"]["awls"] / ends["objective"]["gauss-newton"] - 1
    text = f"gauss-newton {ends['objective']['gauss-newton']:.4g}\nawls {ratio:+.1%}"
    ax.text(0.97, 0.95, text, transform=ax.transAxes, ha="right", va="top")
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.grid(True)
    ax.set_axisbelow(True)


def _end(color: str) -> dict[str, Any]:
    return {"color": color, "marker": "o", "markersize": 4, "linestyle": "none", "zorder": 4}


def _legend(traces: pd.DataFrame) -> list[Line2D]:
    awls = traces[(traces["solver"] == "awls") & (traces["start"] != "together")]
    runs = awls.groupby(["material", "channel", "start"])["status"].agg(["first", "size"])
    capped = runs[runs["first"] == "iteration cap"]
    cap = f"; {len(capped)} of {len(runs)} stopped at" if len(capped) else ""
    cap += f" {capped['size'].max() - 1} iterations" if len(capped) else ""
    labels = {
        ("gauss-newton", 1): "gauss-newton: starts compared on some of the samples",
        ("gauss-newton", 0): "gauss-newton: the best of them goes on to all samples",
        ("awls", 0): f"awls: starts{cap}",
    }
    lines = [
        Line2D([], [], color=COLORS[key[0]], label=label, **RUNS[key])
        for key, label in labels.items()
    ]
    ends = Line2D([], [], label="all starts and preparations together", **_end("0.4"))
    return [*lines, ends]
