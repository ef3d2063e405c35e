"""Figure 5 of Dupuy et al. 2015: seconds of a fit against the number of samples it is made from."""

import argparse

import pandas as pd
from matplotlib.figure import Figure

from npfm.evaluation import tables
from npfm.figures import style

#: What is drawn, and how it is named.
PARTS = {
    "eigenproblem": "D: the eigenproblem",
    "mirrors": "mirrors: G1 and values for F = 1",
    "fresnel": "F of three channels",
    "once": "once for all materials of a grid",
}
#: The same of anisotropic surfaces.
ANISOTROPIC = {
    "circulant": "D: by Fourier transforms",
    "dense": "D: with the whole matrix",
    "kernel": "once for all materials of a grid",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--timing", required=True, help="CSV made by power-iterations timing")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(tables.read(arguments.timing, ["part"], ["nodes", "seconds"]))


def draw(timing: pd.DataFrame) -> Figure:
    """Draw a line for each part of a fit, and for the sum of what is done for every material.

    Parameters
    ----------
    timing : DataFrame
        Columns nodes, part, seconds.

    Returns
    -------
    Figure
    """
    seconds = timing.pivot(index="nodes", columns="part", values="seconds")
    with style.context():
        figure = Figure(figsize=(style.COLUMN_WIDTH, 2.4), layout="constrained")
        ax = figure.subplots()
        parts = PARTS if "once" in seconds else ANISOTROPIC
        for (part, label), marker in zip(parts.items(), "<8Hd", strict=False):
            line = ":" if label.startswith("once") else "-"
            ax.plot(seconds.index, seconds[part], marker=marker, linestyle=line, label=label)
        if parts is PARTS:
            whole = seconds.drop(columns="once").sum(axis=1)
            ax.plot(seconds.index, whole, color="black", marker="s", label="a material, D to F")
        ax.set(xscale="log", yscale="log", xlabel="backscattering samples")
        ax.set_ylabel("processor seconds")
        ax.set_xticks(list(seconds.index), [f"{nodes:g}" for nodes in seconds.index])
        ax.minorticks_off()
        ax.grid(True)
        # Where no line runs: "best" covers the end of the shortest one.
        ax.legend(fontsize=6, loc="best" if parts is PARTS else "lower right")
    return figure
