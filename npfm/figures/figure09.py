"""Figure 9 of Bagher et al. 2016: renderings of the non-parametric fits, with close-ups."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from npfm.figures import renderings, style
from npfm.figures.renderings import Window
from npfm.papers.captions import CAPTIONS

INSET = 0.4  # side of an inset, of the picture's
#: Left and lower edge of an inset; in the fourth corner stands the PSNR.
CORNERS = ((0.0, 1 - INSET), (1 - INSET, 1 - INSET), (1 - INSET, 0.0))
FRAME = "#56B4E9"  # of Okabe and Ito's colours the one that stands out on bright and dark


def draw(
    run: str | Path, psnr: pd.DataFrame, variants: Sequence[str], materials: Sequence[str]
) -> Figure:
    """Draw the fits beside the measurement, each material in its most telling scene.

    The close-up shows where the fits, all together, are wrong most visibly.

    Parameters
    ----------
    run, psnr
        As `renderings.draw` takes them.
    variants : sequence of str
        Columns.
    materials : sequence of str
        Rows; for those that are not there, others.

    Raises
    ------
    NpfmError
        If a picture is missing, or there is none to compare.
    """
    table, remark = renderings.common(psnr, variants)
    rows = renderings.most_telling(run, table, materials, variants)
    with style.context():
        figure, axes = renderings.draw(run, psnr, rows, variants, remark)
        for line, row in zip(axes, rows, strict=True):
            window = renderings.telling_window(run, row, variants)
            corner = emptiest_corner(renderings.foreground(run, row), window)
            for ax, name in zip(line, (renderings.MEASURED, *variants), strict=True):
                _add_close_up(ax, renderings.picture(run, row, name), window, corner)
    return figure


add_arguments = renderings.add_arguments
make = renderings.made_by(draw, CAPTIONS[9])


def emptiest_corner(foreground: NDArray[np.bool_], window: Window) -> tuple[float, float]:
    """Corner where an inset hides least of the objects, and nothing of the window.

    Parameters
    ----------
    foreground : ndarray of bool, shape (height, width)
        Where there are objects.
    window : Window
        What the inset shows.

    Returns
    -------
    tuple of float
        Left and lower edge of the inset, as shares of the picture's width and height.
    """
    height, width = foreground.shape
    hidden = {}
    for left, bottom in CORNERS:
        top = 1 - bottom - INSET
        rows = slice(round(top * height), round((top + INSET) * height))
        columns = slice(round(left * width), round((left + INSET) * width))
        free = foreground.astype(float)
        inside = np.s_[window.row : window.row + window.side]
        free[inside, window.column : window.column + window.side] = height * width
        hidden[left, bottom] = free[rows, columns].sum()
    return min(hidden, key=lambda corner: hidden[corner])


def _add_close_up(ax: Axes, pixels: NDArray, window: Window, corner: tuple[float, float]) -> None:
    """Frame the window, and show it large in a corner."""
    row, column, side = window.row, window.column, window.side
    start = column - 0.5, row - 0.5
    ax.add_patch(Rectangle(start, side, side, fill=False, edgecolor=FRAME, linewidth=0.8))
    inset = ax.inset_axes((*corner, INSET, INSET))
    renderings.show(inset, pixels[row : row + side, column : column + side])
    inset.spines[:].set(color=FRAME, linewidth=0.8)
