"""Figure 2 of Peng et al. 2017 as numbers: error against directions, by cosine and by D."""

import argparse

import pandas as pd
from matplotlib.figure import Figure

from npfm.evaluation.shared_lobes import WAYS, read_sampling
from npfm.figures import style

HEIGHT = 2.6  # inches
COLORS, MARKS = ("#0072B2", "#D55E00", "#000000"), "os^"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument(
        "--sampling", required=True, nargs="+", help="CSVs made by npfm shared-lobes sampling"
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the tables that the arguments name."""
    return draw(read_sampling(arguments.sampling))


def draw(sampling: pd.DataFrame) -> Figure:
    """Draw the root mean square error of the repetitions, a panel each material.

    Parameters
    ----------
    sampling : DataFrame
        As `npfm.evaluation.shared_lobes.sampling` makes it.
    """
    materials = sampling["material"].unique()
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        panels = figure.subplots(1, len(materials), sharey=True, squeeze=False)[0]
        for ax, name in zip(panels, materials, strict=True):
            own = sampling[sampling["material"] == name]
            for way, color, mark in zip(WAYS, COLORS, MARKS, strict=True):
                line = own[own["way"] == way]
                ax.loglog(line["samples"], line["rms"], color=color, marker=mark, label=way)
            ax.set_title(name)
            ax.set_xlabel("light directions a pixel")
            ax.grid(True)
            ax.set_axisbelow(True)
        panels[0].set_ylabel("root mean square error of radiance,\nof the largest radiance")
        panels[0].legend(frameon=False)
    return figure
