"""Figure 6 of Lawrence et al. 2004: the error of factors by the number of terms."""

import argparse
from itertools import cycle

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from npfm.evaluation import tables
from npfm.figures import style

HEIGHT = 2.4  # inches
NUMBERS = ("outer", "inner", "error", "rms")
MARKERS = "osD^v"
PANELS = {"rms": "root mean square error", "error": "mean absolute error"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--terms", required=True, help="CSV made by npfm factorisation terms")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(tables.read(arguments.terms, [], NUMBERS))


def draw(terms: pd.DataFrame) -> Figure:
    """Draw both errors, a line for each number of terms of the first factorisation.

    Parameters
    ----------
    terms : DataFrame
        As `npfm.evaluation.factorisation.by_terms` makes it.
    """
    # From dark to bright in their order, which lines so close are told apart by.
    shades = colormaps["viridis"](np.linspace(0, 0.85, terms["outer"].nunique()))
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        for ax, (column, what) in zip(figure.subplots(1, 2), PANELS.items(), strict=True):
            lines = terms.groupby("outer", sort=False)
            for (J, line), shade, marker in zip(lines, shades, cycle(MARKERS), strict=False):
                ax.plot(line["inner"], line[column], color=shade, marker=marker, label=f"J = {J:g}")
            ax.set_xlabel("terms K of the second factorisation")
            ax.set_ylabel(f"{what},\nshare of the mean")
            ax.set_ylim(bottom=0)
            ax.xaxis.set_major_locator(MaxNLocator(integer=True))
            ax.grid(True)
            ax.set_axisbelow(True)
        figure.axes[0].legend(frameon=False)
    return figure
