"""Figure 4 of Peng et al. 2017: PSNR of every material's pictures and table."""

import argparse
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from npfm.evaluation import tables
from npfm.figures import own_colors, style

#: What is drawn from top to bottom, by columns of the table.
PANELS = {
    "rendering_db": "pictures, peak: the largest value",
    "rendering_8_bit_db": "pictures, peak: 255 where the mean is 1",
    "numerical_db": "tables, peak: the largest value",
    "numerical_8_bit_db": "tables, peak: 255 where the mean is 1",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="CSV made by tables fidelity")
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    table = tables.read(arguments.table, ["material", "variant"], list(PANELS))
    return draw(table, own_colors.colors(arguments))


def draw(table: pd.DataFrame, colors: Mapping[str, str] | None = None) -> Figure:
    """Draw a panel for each kind of PSNR, the materials in the order of the first variant's.

    Parameters
    ----------
    table : DataFrame
        Columns material, variant and `PANELS`, in dB; what is not finite is left out.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    """
    variants = list(table["variant"].unique())
    panels = {
        name: table.pivot(index="material", columns="variant", values=name)[variants]
        for name in PANELS
    }
    first = panels["rendering_db"][variants[0]]
    order = list(first.sort_values(kind="stable").index)
    with style.context():
        height = 1.1 * len(panels) + 1.3
        figure = Figure(figsize=(style.PAGE_WIDTH, height), layout="constrained")
        axes = figure.subplots(len(panels), 1, sharex=True)
        for ax, (name, title) in zip(axes, PANELS.items(), strict=True):
            panel = panels[name].reindex(order).replace([np.inf, -np.inf], np.nan)
            for variant, look in style.looks(variants, colors).items():
                ax.plot(
                    range(len(order)),
                    panel[variant],
                    label=f"{variant}: {panel[variant].mean():.1f} dB",
                    color=(look.color, 0.5),
                    **look.mark,
                    linestyle=look.linestyle,
                )
            ax.set_title(title, loc="left", pad=2)
            ax.set_ylabel("PSNR (dB)")
            ax.grid(True)
            ax.legend(fontsize=5.5, ncols=len(variants), frameon=False)
            ax.margins(y=0.25)
        axes[-1].set_xticks(range(len(order)), order, rotation=90)
    return figure
