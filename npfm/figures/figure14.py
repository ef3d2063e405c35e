"""Figure 14 of Bagher et al. 2016: where on the object the renderings are wrong."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.evaluation import comparison, metrics, tables
from npfm.figures import renderings, style
from npfm.papers.captions import CAPTIONS, chosen
from npfm.storage.pictures import read_exr

COLORS = "Reds"  # the paper's hue; darker steadily, so that it needs no colour to be read
OUTSIDE = "0.75"  # of pixels that no object covers
BAR, BELOW = 0.08, 0.5  # inches: the colour bar, and the room for it and its labels


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    renderings.add_arguments(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    return draw(a.run, tables.read_psnr(a.psnr), a.variants, CAPTIONS[14])


def draw(
    run: str | Path, psnr: pd.DataFrame, variants: Sequence[str], materials: Sequence[str]
) -> Figure:
    """Draw the absolute errors, channels added, as shares of the largest one of our fit.

    One row a scene. In the corner of our fit stands its largest error, in the unit of the
    radiance, and in those of the others theirs, as a share of it; they are shown as 1.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the pictures of linear radiance.
    psnr : DataFrame
        Columns scene, material, variant, psnr_db; tells which pictures there are.
    variants : sequence of str
        Columns; our model is the first.
    materials : sequence of str
        What is drawn, all scenes of each; for one that is not there, another.

    Raises
    ------
    NpfmError
        If a picture is missing or damaged, or there is none to compare.
    """
    table, _ = renderings.common(psnr, variants)
    shown = chosen(materials, table.index.unique("material"))
    rows = [renderings.Row(*row) for name in shown for row in table.loc[[name]].index]
    with style.context():
        figure, axes = renderings.sheet(len(rows), len(variants), BELOW)
        for line, row in zip(axes, rows, strict=True):
            _draw_row(line, errors(run, row, variants))
            renderings.row_label(line[0], row)
        for ax, variant in zip(axes[0], variants, strict=True):
            ax.set_title(variant, pad=3)
        _draw_color_bar(figure, variants[0])
    return figure


def errors(
    run: str | Path, row: renderings.Row, variants: Sequence[str]
) -> list[NDArray[np.float64]]:
    """Error of each variant in linear radiance, channels added; NaN where no object is."""
    folder = Path(run) / "renders" / row.scene / row.material
    reference, foreground = comparison.read_reference(folder / f"{renderings.MEASURED}.exr")
    maps = []
    for name in variants:
        picture = read_exr(folder / f"{name}.exr")[..., :3]
        maps.append(np.where(foreground, metrics.absolute_error(picture, reference), np.nan))
    return maps


def _draw_row(axes: Sequence[Axes], maps: Sequence[NDArray[np.float64]]) -> None:
    largest = np.nanmax(maps[0]) or 1.0  # a fit without any error has no scale to give
    labels = [f"1 = {largest:.3g}", *(f"up to {np.nanmax(e) / largest:.3g}" for e in maps[1:])]
    for ax, values, label in zip(axes, maps, labels, strict=True):
        renderings.show(ax, values / largest, cmap=COLORS, vmin=0, vmax=1)
        ax.set_facecolor(OUTSIDE)
        renderings.corner_label(ax, label)


def _draw_color_bar(figure: Figure, ours: str) -> None:
    height = figure.get_figheight()
    cax = figure.add_axes((0.25, (BELOW - 0.06 - BAR) / height, 0.5, BAR / height))
    bar = figure.colorbar(
        ScalarMappable(Normalize(0, 1), COLORS), cax=cax, orientation="horizontal", extend="max"
    )
    bar.set_label(f"error of radiance, of the largest one of {ours}")
