"""A page of renderings of one material, as in the supplement of Bagher et al. 2016."""

import argparse
import textwrap
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from npfm.evaluation import tables
from npfm.figures import style
from npfm.figures.renderings import MEASURED, Row, decibels_label, picture, show

COLUMNS = 6  # pictures side by side: names below and beside them stay readable on a page
CELL = style.PAGE_WIDTH / COLUMNS  # inches, side of a picture with its margins
LETTERS = 24  # of a name above a picture
TEXT = 0.2  # inches, name and decibels of a picture


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--psnr", required=True, help="CSV made by npfm tables psnr")
    parser.add_argument("--run", required=True, help="folder of the run")
    parser.add_argument("--material", required=True, help="the material")
    parser.add_argument("--scenes", nargs="+", required=True, help="in this order")
    parser.add_argument("--variants", nargs="+", required=True, help="beside the measurement")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    return draw(a.run, tables.read_psnr(a.psnr), a.material, a.scenes, a.variants)


def draw(
    run: str | Path,
    psnr: pd.DataFrame,
    material: str,
    scenes: Sequence[str],
    variants: Sequence[str],
) -> Figure:
    """Draw the measurement and the fits of a material side by side, scene after scene.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the tone-mapped pictures.
    psnr : DataFrame
        Columns scene, material, variant, psnr_db. A variant without a row for the material has
        no fit of it; it is left out and named in the title.
    material : str
        The material.
    scenes, variants : sequence of str
        What is drawn; the measurement comes first.

    Returns
    -------
    Figure

    Raises
    ------
    NpfmError
        If a picture is missing.
    """
    decibels = psnr[psnr.material == material].set_index(["scene", "variant"]).psnr_db
    fitted = [name for name in variants if name in decibels.index.unique("variant")]
    shown = [MEASURED, *fitted]
    lines = -(-len(shown) // COLUMNS)  # of a scene
    columns = -(-len(shown) // lines)
    with style.context():
        size = CELL * columns, (CELL + TEXT) * lines * len(scenes) + 0.3
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.subplots(lines * len(scenes), columns, squeeze=False)
        for k, scene in enumerate(scenes):
            axes = grid[k * lines : (k + 1) * lines].flat
            for ax, name in zip(axes, shown, strict=False):
                show(ax, picture(run, Row(material, scene), name))
                ax.set_title(textwrap.fill(name, LETTERS), fontsize=6, pad=3)
                if name != MEASURED:
                    ax.set_xlabel(decibels_label(decibels[scene, name]), fontsize=6, labelpad=2)
            axes[0].set_ylabel(f"scene {scene}")
            for ax in axes[len(shown) :]:
                ax.set_axis_off()
        figure.suptitle(_title(material, variants, fitted), fontsize=9)
    return figure


def _title(material: str, variants: Sequence[str], fitted: Sequence[str]) -> str:
    missing = [name for name in variants if name not in fitted]
    return material + (f" (no fit: {', '.join(missing)})" if missing else "")
