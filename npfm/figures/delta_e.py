"""Figure 3 of Dupuy et al. 2015: mean colour-difference images over all materials."""

import argparse
import textwrap
from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.evaluation import tables
from npfm.figures import style
from npfm.figures.renderings import show
from npfm.storage.pictures import read_exr_parts

#: Inches beside and under a panel.
BAR, TEXT = 0.45, 0.6
LETTERS = 15  # of a name over a panel
#: Of the pixels' values; brighter ones are shown as this.
SHARE_SHOWN = 99.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--images", required=True, help="EXR made by power-iterations delta-e")
    parser.add_argument("--table", required=True, help="CSV made by power-iterations delta-e")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the images and the table that the arguments name."""
    images = {
        name: np.where(part[..., 3] > 0, part[..., 0], np.nan)
        for name, part in read_exr_parts(arguments.images).items()
    }
    return draw(images, tables.read(arguments.table, ["material", "variant"], ["delta_e"]))


def draw(images: Mapping[str, NDArray], table: pd.DataFrame) -> Figure:
    """Draw the image of each variant on one scale, its mean below.

    Parameters
    ----------
    images : mapping of str to ndarray, shape (height, width)
        CIEDE2000 in the mean over the materials; NaN outside the objects.
    table : DataFrame
        Columns material, variant, delta_e: the mean over the pixels of each picture.

    Returns
    -------
    Figure
    """
    variants = table.groupby("variant").delta_e
    highest = np.nanpercentile(np.stack(list(images.values())), SHARE_SHOWN)
    with style.context():
        side = (style.PAGE_WIDTH - BAR) / len(images)
        figure = Figure(figsize=(style.PAGE_WIDTH, side + TEXT), layout="constrained")
        axes = figure.subplots(1, len(images), squeeze=False)[0]
        for ax, (name, image) in zip(axes, images.items(), strict=True):
            show(ax, image, vmin=0, vmax=highest, cmap="inferno")
            values = variants.get_group(name)
            ax.set_title(textwrap.fill(name, LETTERS), pad=3)
            ax.set_xlabel(f"mean {values.mean():.2f}\n{len(values)} materials", labelpad=2)
        bar = figure.colorbar(axes[-1].images[0], ax=list(axes), fraction=0.02, pad=0.01)
        bar.set_label("CIEDE2000")
    return figure
