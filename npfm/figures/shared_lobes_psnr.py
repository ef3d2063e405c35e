"""Figure 3 of Peng et al. 2017: mean PSNR of every material, sorted by independent-g's."""

import argparse
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.shared_lobes import PSNR, wins
from npfm.figures import own_colors, style
from npfm.papers import peng2017

OURS, OTHER = "shared-lobes", "independent-g"
HEIGHT, LETTER = 2.8, 0.05  # inches; the second for a letter of the longest name of a material
#: Names of more materials than this would overlap.
MOST_NAMED = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--psnr", required=True, help="CSV made by npfm shared-lobes psnr")
    own_colors.add_colors(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    table = tables.read(arguments.psnr, list(PSNR[:2]), list(PSNR[2:]))
    if missing := {OURS, OTHER} - set(table["variant"]):
        raise NpfmError(f"{arguments.psnr}: no PSNR of {', '.join(sorted(missing))}")
    return draw(table, own_colors.colors(arguments))


def draw(psnr: pd.DataFrame, colors: Mapping[str, str] | None = None) -> Figure:
    """Draw a line for each variant, and count the materials on which ours is above the other.

    Parameters
    ----------
    psnr : DataFrame
        As `npfm.evaluation.shared_lobes.psnr` makes it; what is not finite is left out.
    colors : mapping of str to str, optional
        Colours of variants, in place of the project's.
    """
    table = psnr.pivot(index="material", columns="variant", values="psnr_db")
    table = table.sort_index().sort_values(OTHER, kind="stable", na_position="last")
    names = list(table.index)
    named = len(names) <= MOST_NAMED
    height = HEIGHT + (LETTER * max(map(len, names)) if named else 0)
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, height), layout="constrained")
        ax = figure.subplots()
        for variant, look in style.looks(psnr["variant"].unique(), colors).items():
            values = table[variant].where(np.isfinite(table[variant]))
            label = f"{variant}: mean {values.mean():.2f} dB"
            ax.plot(
                range(len(values)),
                values,
                color=(look.color, 0.5),
                **look.mark,
                linestyle=look.linestyle,
                label=label,
            )
        ax.set_title(_count(psnr), loc="left", pad=3)
        ax.set_ylabel("PSNR (dB), mean over the scenes")
        ax.set_xlabel(f"material, by increasing PSNR of {OTHER}")
        if named:
            ax.set_xticks(range(len(names)), names, rotation=90)
        ax.margins(x=0.01)
        ax.grid(True)
        ax.set_axisbelow(True)
        ax.legend(frameon=False)
    return figure


def _count(psnr: pd.DataFrame) -> str:
    ours, materials = wins(psnr, OURS, OTHER)
    paper = f"{peng2017.BETTER_THAN_INDEPENDENT_G} of {peng2017.MATERIALS}"
    return f"{OURS} above {OTHER} for {ours} of {materials} materials; in the paper for {paper}"
