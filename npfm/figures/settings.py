"""PSNR and seconds against the number of starts, and against the tolerance."""

import argparse

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from npfm.evaluation.accuracy_cost import FITS, read
from npfm.figures import style

HEIGHT = 3.8  # inches
LABELS = {
    "starts": "starts",
    "tolerance": "tolerance",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument(
        "--fits", nargs="+", required=True, help="CSVs made by npfm accuracy-cost fits"
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the tables that the arguments name."""
    return draw(read(arguments.fits, FITS))


def draw(fits: pd.DataFrame) -> Figure:
    """Draw what each material gains over the first setting, and what it takes.

    Parameters
    ----------
    fits : DataFrame
        As `npfm.evaluation.accuracy_cost.fits` makes it, of all materials; the stages ``starts``
        and ``tolerance`` count. What has no PSNR, or an infinite one, is left out.
    """
    looks = style.looks(list(fits["material"].unique()))
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        axes = figure.subplots(2, 2, sharex="col", sharey="row")
        for column, (stage, label) in zip(axes.T, LABELS.items(), strict=True):
            here = fits[fits["stage"] == stage]
            here = here.assign(setting=here["setting"].astype(float))
            psnr, seconds = (
                here.pivot_table(index="setting", columns="material", values=value, sort=False)
                for value in ("psnr_db", "seconds")
            )
            psnr = psnr.replace(np.inf, np.nan).reindex(columns=seconds.columns)
            _draw_panel(column[0], psnr - psnr.iloc[0], looks)
            _draw_panel(column[1], seconds, looks)
            mean = psnr.mean(axis=1)
            column[0].set_title(
                f"mean PSNR {mean.iloc[0]:.2f} to {mean.iloc[-1]:.2f} dB", loc="left", pad=2
            )
            column[1].set_xlabel(label)
        axes[1, 1].set_xscale("log")
        axes[1, 1].xaxis.set_minor_locator(NullLocator())
        axes[1, 1].invert_xaxis()
        axes[0, 0].set_ylabel("PSNR above that of the\nfirst setting (dB)")
        axes[1, 0].set_ylabel("seconds to fit a material")
        style.plain_logarithmic(axes[1, 0].yaxis)
        figure.legend(
            *axes[0, 0].get_legend_handles_labels(),
            loc="outside upper center",
            ncols=4,
            frameon=False,
        )
    return figure


def _draw_panel(ax: Axes, panel: pd.DataFrame, looks: dict[str, style.Look]) -> None:
    for material, look in looks.items():
        ax.plot(
            panel.index,
            panel[material],
            color=look.color,
            marker=look.marker,
            markeredgewidth=0,
            linestyle="-",
            linewidth=0.5,
            label=material,
        )
    ax.plot(panel.index, panel.mean(axis=1), color="black", linewidth=1.5, label="mean")
    ax.grid(True)
    ax.set_axisbelow(True)
