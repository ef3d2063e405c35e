"""Tables 2 and 3 of Lawrence et al. 2004 as maps: the variance of every way for every material."""

import argparse

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from npfm.evaluation.importance import INDEPENDENT, SOBOL
from npfm.figures import style, ways

#: Inches: a row, names of materials and what is above them, names of ways beside, the bar.
ROW, HEAD, BESIDE, BAR = 0.135, 0.8, 2.0, 0.55
#: Times the least variance at which the colours end.
MOST = 1e3


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm importance table")
    parser.add_argument(
        "--points",
        choices=[INDEPENDENT, SOBOL],
        default=INDEPENDENT,
        help="of one sample, or of the most that there are by the renderer's points",
    )


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    return draw(ways.read_labelled(arguments.table), arguments.points)


def draw(table: pd.DataFrame, points: str) -> Figure:
    """Draw a map for each light, a row each way and a column each material, the best in bold.

    Parameters
    ----------
    table : DataFrame
        As `npfm.figures.ways.read_labelled` reads it.
    points : str
        Which rows of it.
    """
    rows = ways.most_samples(table, points)
    lights, names = rows["light"].unique(), rows["way"].unique()
    panel = HEAD + ROW * len(names)
    with style.context():
        height = panel * len(lights)
        figure = Figure(figsize=(style.PAGE_WIDTH, height))
        for k, light in enumerate(lights):
            values = rows[rows["light"] == light].pivot(
                index="way", columns="material", values="n_var"
            )
            bottom = (height - (k + 1) * panel) / height + 0.08 / height
            inside = (ROW * len(names)) / height
            width = (style.PAGE_WIDTH - BESIDE - BAR) / style.PAGE_WIDTH
            ax = figure.add_axes((BESIDE / style.PAGE_WIDTH, bottom, width, inside))
            image = _draw(ax, values.reindex(names))
            count = rows["samples"].iloc[0]
            number = "of one sample" if points == INDEPENDENT else f"at {count:g} samples"
            top = bottom + inside + 0.3 / height
            figure.text(0.1 / style.PAGE_WIDTH, top, f"{light}\nn_var {number}", fontsize="large")
            bar = figure.add_axes(
                (1 - 0.85 * BAR / style.PAGE_WIDTH, bottom, 0.08 / style.PAGE_WIDTH, inside)
            )
            figure.colorbar(image, cax=bar)
            bar.set_yticks([0, 1, 2, 3], ["least", "x 10", "x 100", "x 1000"], fontsize=5)
    return figure


def _draw(ax: Axes, values: pd.DataFrame) -> AxesImage:
    least = values.min()
    shades = np.log10((values / least).clip(upper=MOST).to_numpy())
    scale = Normalize(0, np.log10(MOST))
    image = ax.imshow(shades, aspect="auto", cmap="YlOrBr", norm=scale)
    for row, name in enumerate(values.index):
        for column, material in enumerate(values.columns):
            value = values.loc[name, material]
            best = value == least[material]
            ax.text(
                column,
                row,
                number(value),
                ha="center",
                va="center_baseline",
                fontsize=5,
                fontweight="bold" if best else "normal",
                color="white" if shades[row, column] > 2.2 else "black",
            )
    ax.set_xticks(range(values.shape[1]), list(values.columns), rotation=40, ha="left")
    ax.set_yticks(range(values.shape[0]), list(values.index))
    ax.tick_params(top=True, labeltop=True, bottom=False, labelbottom=False, length=0)
    return image


def number(value: float) -> str:
    """Two digits of a number, without an exponent."""
    if not np.isfinite(value):
        return ""
    return np.format_float_positional(value, precision=2, fractional=False, trim="-")
