"""Figures 8 and 9 of Lawrence et al. 2004: where a picture is noisy, by the way of sampling."""

import argparse
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.figures import style
from npfm.figures.importance import number
from npfm.figures.renderings import show
from npfm.storage.pictures import read_exr_parts

#: Inches beside the panels, above the first row, and under each panel.
BAR, TITLE, TEXT = 0.5, 0.35, 0.16
LETTERS = 13  # of a line of a title
#: Decades that are shown below the brightest.
DECADES = 5


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument(
        "--images",
        nargs="+",
        required=True,
        help="EXRs of npfm importance measure, LIGHT/MATERIAL.exr",
    )
    parser.add_argument("--ways", nargs="+", required=True, help="which of their parts")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures that the arguments name."""
    images = {}
    for path in map(Path, arguments.images):
        parts = read_exr_parts(path)
        if missing := [name for name in arguments.ways if name not in parts]:
            raise NpfmError(f"{path}: no part '{missing[0]}'; measure that way again")
        images[f"{path.stem}\n{path.parent.name}"] = [
            np.where(part[..., 3] > 0, part[..., 0], np.nan)
            for part in map(parts.__getitem__, arguments.ways)
        ]
    return draw(images, arguments.ways)


def draw(images: Mapping[str, Sequence[NDArray]], ways: Sequence[str]) -> Figure:
    """Draw the variance of one sample by pixel, a row each picture, on one logarithmic scale.

    Parameters
    ----------
    images : mapping of str to sequence of ndarray, shape (h, w)
        By what stands beside it, an image each way; NaN outside the object.
    ways : sequence of str
    """
    highest = max(np.nanmax(image) for row in images.values() for image in row)
    lowest = highest / 10**DECADES
    scale = LogNorm(lowest, highest)
    side = (style.PAGE_WIDTH - BAR) / len(ways)
    with style.context():
        height = TITLE + (side + TEXT) * len(images)
        figure = Figure(figsize=(style.PAGE_WIDTH, height), layout="constrained")
        axes = figure.subplots(len(images), len(ways), squeeze=False)
        for (name, row), line in zip(images.items(), axes, strict=True):
            for image, ax in zip(row, line, strict=True):
                show(ax, np.maximum(image, lowest), norm=scale, cmap="inferno")
                ax.set_xlabel(number(np.nanmean(image)), labelpad=2)
            line[0].set_ylabel(name)
        for name, ax in zip(ways, axes[0], strict=True):
            ax.set_title(textwrap.fill(spaced(name), LETTERS), pad=3)
        bar = figure.colorbar(axes[0, 0].images[0], ax=axes, fraction=0.02, pad=0.01)
        bar.set_label("n_var of one sample")
    return figure


def spaced(way: str) -> str:
    """Name of a part with spaces where lines may be broken."""
    return way.replace("+", " + ").replace("/", " ").replace("^", ", power ")
