"""Error of the renderer against samples and seconds, by how light directions are chosen."""

import argparse

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npfm.evaluation.accuracy_cost import SAMPLING, read
from npfm.evaluation.metrics import mean_db
from npfm.figures import style

HEIGHT = 4.4  # inches
TITLES = {
    "light": "light alone",
    "half-vector": "half vectors alone",
    "light+half-vector": "both combined",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--sampling", required=True, help="CSV made by npfm accuracy-cost sampling")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(read([arguments.sampling], SAMPLING))


def draw(sampling: pd.DataFrame) -> Figure:
    """Draw the error of pictures, and that of the PSNR of a fit that is measured on them.

    Parameters
    ----------
    sampling : DataFrame
        As `npfm.evaluation.accuracy_cost.sampling` makes it.
    """
    groups = errors(sampling).groupby("sampling", sort=False)
    lines = {str(name): line for name, line in groups}
    looks = style.looks(list(lines))
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        axes = figure.subplots(2, 2, sharex="col", sharey="row")
        for name, line in lines.items():
            doubling = slope(line["samples"], line["picture_db"])
            power = slope(line["samples"], np.log2(line["error_db"]))
            labels = f"{doubling:+.2f} dB a doubling", f"error ~ samples^{power:.2f}"
            for row, column, label in zip(axes, ("picture_db", "error_db"), labels, strict=True):
                _draw_line(row, line, column, looks[name], f"{TITLES[name]}: {label}")
        style.plain_logarithmic(axes[1, 0].yaxis)
        axes[0, 0].set_ylabel("PSNR of the measurement's picture\nagainst the reference (dB)")
        axes[1, 0].set_ylabel("error of the PSNR of a fit (dB),\nroot mean square over materials")
        axes[1, 0].set_xlabel("samples a pixel")
        axes[1, 1].set_xlabel("seconds to build the scene")
        for ax in axes[:, 0]:
            ax.legend(frameon=False)
        for ax in axes.flat:
            ax.grid(True)
            ax.set_axisbelow(True)
    return figure


def errors(sampling: pd.DataFrame) -> pd.DataFrame:
    """Errors over all materials.

    Returns
    -------
    DataFrame
        Columns sampling, samples, seconds, picture_db (mean), and error_db: root mean square of
        psnr_db less reference_db.
    """
    squared = (sampling["psnr_db"] - sampling["reference_db"]) ** 2
    groups = sampling.assign(error_db=squared).groupby(["sampling", "samples"], sort=False)
    means = groups.agg({"seconds": "mean", "picture_db": mean_db, "error_db": "mean"})
    means = means.reset_index()
    return means.assign(error_db=np.sqrt(means["error_db"]))


def slope(samples: pd.Series, values: pd.Series) -> float:
    """Slope of the line that fits the values best, for a doubling of the samples."""
    return float(np.polyfit(np.log2(samples), values, 1)[0])


def _draw_line(
    row: list[Axes], line: pd.DataFrame, column: str, look: style.Look, label: str
) -> None:
    for ax, x in zip(row, ("samples", "seconds"), strict=True):
        ax.plot(line[x], line[column], color=look.color, marker=look.marker, label=label)
        style.plain_logarithmic(ax.xaxis)
