"""Figure 13 of Bagher et al. 2016: our fit against the factorisation of Bilgili et al. 2011."""

import argparse

from matplotlib.figure import Figure

from npfm.evaluation import tables
from npfm.figures import figure12
from npfm.papers.captions import CAPTIONS

add_arguments = figure12.add_arguments
draw = figure12.draw


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    return draw(a.run, tables.read_psnr(a.psnr), a.variants, CAPTIONS[13])
