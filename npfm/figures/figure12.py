"""Figure 12 of Bagher et al. 2016: our fit against the microfacet model of Loew et al. 2012."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from npfm.evaluation import tables
from npfm.figures import renderings, scores, style
from npfm.papers.captions import CAPTIONS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    renderings.add_arguments(parser)


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    return draw(a.run, tables.read_psnr(a.psnr), a.variants, CAPTIONS[12])


def draw(
    run: str | Path, psnr: pd.DataFrame, variants: Sequence[str], materials: Sequence[str]
) -> Figure:
    """Draw the fits beside the measurement, and below how often ours is the better one.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the tone-mapped pictures.
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    variants : sequence of str
        Columns; our model is the first, and all renderings are counted against each other one.
    materials : sequence of str
        Rows, each in its most telling scene; for those that are not there, others.

    Raises
    ------
    NpfmError
        If a picture is missing, or there is none to compare.
    """
    ours, *others = variants
    table, _ = renderings.common(psnr, variants)
    counted = scores.count(psnr, ours, others)
    with style.context():
        rows = renderings.most_telling(run, table, materials, variants)
        figure, _ = renderings.draw(run, psnr, rows, variants, below=scores.height(counted))
        scores.draw(figure, counted, ours)
    return figure
