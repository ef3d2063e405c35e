"""Where the error of fits sits, by the angles of cells and by the slant of the surface."""

import argparse
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from npfm.evaluation import tables
from npfm.evaluation.where import RECIPROCAL
from npfm.figures import own_colors, style

#: Columns of the figure, and what their axes are.
TITLES = {
    "theta_h": "theta_h (degrees)",
    "theta_d": "theta_d (degrees)",
    "lowest": "larger of theta_i, theta_o",
    "slant": "normal and view, at pixels",
}
#: More materials than these do not fit on a page.
MOST_MATERIALS = 6
#: Where the axes of objectives begin, in percent; variants lie a hundred thousand times apart.
LEAST_PERCENT = 0.01
LEGEND_COLUMNS = 4
LEFT = "what no reciprocal model can remove"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by tables where")
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    numbers = ["from_degrees", "to_degrees", "percent"]
    table = tables.read(arguments.table, ["material", "variant", "angle"], numbers)
    return draw(table, own_colors.colors(arguments))


def draw(table: pd.DataFrame, colors: Mapping[str, str] | None = None) -> Figure:
    """Draw a row for each material, and a panel for each angle.

    Parameters
    ----------
    table : DataFrame
        As `npfm.evaluation.where.where` makes it. Of many materials, those with the largest
        objective of the best reciprocal table are shown.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    """
    floor = table[(table["variant"] == RECIPROCAL) & (table["angle"] == "theta_h")]
    order = floor.groupby("material", sort=False)["percent"].sum().nlargest(MOST_MATERIALS)
    materials = [name for name in table["material"].unique() if name in order.index]
    angles = [angle for angle in TITLES if angle in set(table["angle"])]
    variants = [name for name in table["variant"].unique() if name != RECIPROCAL]
    looks = style.looks(variants, colors)
    with style.context():
        height = 1.35 * len(materials) + 0.5 + 0.16 * (len(looks) // LEGEND_COLUMNS + 1)
        figure = Figure(figsize=(style.PAGE_WIDTH, height), layout="constrained")
        axes = figure.subplots(len(materials), len(angles), squeeze=False, sharex="col")
        for row, material in zip(axes, materials, strict=True):
            for ax, angle in zip(row, angles, strict=True):
                shown = table[(table["material"] == material) & (table["angle"] == angle)]
                _panel(ax, shown, looks)
                if angle != "slant":
                    ax.set_yscale("log")
                    ax.set_ylim(LEAST_PERCENT, max(ax.get_ylim()[1], 10 * LEAST_PERCENT))
            row[0].set_title(material, loc="left", pad=2)
            row[0].set_ylabel("% of black's\nobjective")
            if "slant" in angles:
                row[-1].set_ylabel("% of squared\nerror")
        for ax, angle in zip(axes[-1], angles, strict=True):
            ax.set_xlabel(TITLES[angle])
        # A material may lack a variant, or cells to tell of it.
        found = [ax.get_legend_handles_labels() for ax in axes.ravel()]
        named = {label: handle for pair in found for handle, label in zip(*pair, strict=True)}
        labels = [label for label in (*looks, LEFT) if label in named]
        handles = [named[label] for label in labels]
        figure.legend(
            handles, labels, loc="outside lower center", ncols=LEGEND_COLUMNS, frameon=False
        )
    return figure


def _panel(ax: Axes, shown: pd.DataFrame, looks: Mapping[str, style.Look]) -> None:
    """Draw the parts in bins, all of one width, since those of small angles are narrow."""
    if shown.empty:
        return
    parts = dict(iter(shown.groupby("variant", sort=False)))
    edges = [*shown["from_degrees"].unique(), shown["to_degrees"].max()]
    places = np.arange(len(edges) - 1)
    if RECIPROCAL in parts:
        height = parts[RECIPROCAL]["percent"]
        ax.bar(places, height, 1.0, color="0.85", label=LEFT)
    for variant, look in looks.items():
        if variant in parts:
            line = {"color": look.color, "linestyle": look.linestyle, **look.mark}
            ax.plot(places, parts[variant]["percent"], label=variant, **line)
    ax.set_xticks(np.arange(len(edges)) - 0.5, [f"{edge:g}" for edge in edges], fontsize=5)
    ax.set_ylim(bottom=0)
    ax.grid(True, axis="y")
    ax.set_axisbelow(True)
