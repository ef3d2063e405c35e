"""A material that changes over an object, and mixtures half way, by each way of blending."""

import argparse
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import blends
from npfm.evaluation.blends import FIRST, MEASURED, REST, SECOND, TABLES, WEIGHTS
from npfm.figures import style
from npfm.figures.renderings import corner_label, show
from npfm.storage.pictures import read_exr_parts, tone_map

#: Colours of the four materials where their weights are shown (Okabe and Ito 2008).
COLORS = ("#E69F00", "#56B4E9", "#009E73", "#CC79A7")
REMARK = (
    "First row: CPU seconds of the picture. Below: theta_h at which the highlight has fallen to "
    f"half and to a hundredth of its height\n({REST:g}°: there is none); and mean radiance, as a "
    "share of the mean of the two materials."
)
HEADING, EDGES = 0.17, 0.55  # inches over a row of pictures, and over and under all of them


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by npfm blends")
    parser.add_argument("--half-way", required=True, help="CSV of its mixtures half way")
    parser.add_argument("--pictures", required=True, help="EXR of its pictures")
    for name, value in (("--exposure", 0.02), ("--gamma", 2.2)):
        parser.add_argument(name, type=float, default=value, help="of the pictures")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the tables and pictures that the arguments name."""
    if not (0 < arguments.exposure < np.inf and 0 < arguments.gamma < np.inf):
        raise NpfmError("--exposure and --gamma: give numbers above 0")
    costs, between = blends.read(arguments.table, arguments.half_way)
    parts = read_exr_parts(arguments.pictures)
    shown = {
        name: part if name == WEIGHTS else tone_map(part, arguments.exposure, arguments.gamma)
        for name, part in parts.items()
    }
    try:
        return draw(costs, between, shown)
    except KeyError as error:
        message = f"{arguments.pictures}: no picture {error} in it; make it again with npfm blends"
        raise NpfmError(message) from error


def draw(costs: pd.DataFrame, between: pd.DataFrame, shown: Mapping[str, NDArray]) -> Figure:
    """Draw the textured object in a row, and below it a row for each pair of materials.

    Parameters
    ----------
    costs, between : DataFrame
        As `npfm.evaluation.blends.measure` and `half_way` make them.
    shown : mapping of str to ndarray, shape (h, w, 3)
        Their pictures as display values, and the weights, of shape (h, w, 4), from 0 to 1.

    Raises
    ------
    KeyError
        If a picture is missing.
    """
    ways = [TABLES, *(way for way in between["way"].unique() if way not in (FIRST, SECOND, TABLES))]
    pairs = [table.set_index("way") for _, table in between.groupby("pair", sort=False)]
    columns, rows = len(ways) + 2, 1 + len(pairs)
    cell = style.PAGE_WIDTH / columns
    with style.context():
        size = style.PAGE_WIDTH, rows * (cell + HEADING) + EDGES
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.subplots(rows, columns, squeeze=False)
        _draw_textured(grid[0], costs.set_index("way")["picture_seconds"], ways, shown)
        for number, (line, numbers) in enumerate(zip(grid[1:], pairs, strict=True)):
            titles = dict(numbers.iloc[0][[FIRST, SECOND]])
            for ax, way in zip(line, [FIRST, *ways, SECOND], strict=True):
                show(ax, shown[f"{number}/{way}"])
                ax.set_title(titles.get(way, way), pad=3, fontsize=6)
                row = numbers.loc[way]
                text = f"{row['half_degrees']:.2g}° {row['foot_degrees']:.2g}°"
                if way not in titles and np.isfinite(row["brightness"]):
                    text += f"  {100 * row['brightness']:.0f} %"
                corner_label(ax, text)
        figure.supxlabel(REMARK, fontsize=6)
        names = [str(numbers[FIRST].iloc[0]) for numbers in pairs]
        _legend(figure, [*names, str(pairs[-1][SECOND].iloc[0])])
    return figure


def _draw_textured(
    line: NDArray, seconds: pd.Series, ways: list[str], shown: Mapping[str, NDArray]
) -> None:
    weights = np.asarray(shown[WEIGHTS], dtype=float)
    mixed = weights @ np.array([to_rgb(color) for color in COLORS])
    empty = 1 - weights.sum(axis=-1, keepdims=True)
    show(line[0], np.clip(mixed + empty, 0, 1))
    line[0].set_title("weights", pad=3, fontsize=6)
    for ax, way in zip(line[1:], [MEASURED, *ways], strict=True):
        show(ax, shown[way])
        ax.set_title(way, pad=3, fontsize=6)
        corner_label(ax, f"{seconds[way]:.2g} s")


def _legend(figure: Figure, names: list[str]) -> None:
    """Say which colour of the weights is which material."""
    marks = [
        Line2D([], [], color=color, marker="o", linestyle="", label=name)
        for color, name in zip(COLORS, names, strict=False)
    ]
    figure.legend(handles=marks, loc="outside upper center", ncols=len(marks), frameon=False)
