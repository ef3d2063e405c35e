"""Rows of renderings, the measurement beside its fits, as in Figures 7 and 9 to 15."""

import argparse
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.comparison import read_reference
from npfm.evaluation.head_to_head import renderings
from npfm.figures import style
from npfm.papers.captions import chosen

#: Draws a figure from what its command line says.
Maker = Callable[[argparse.Namespace], Figure]

MEASURED = "measured"
#: Inches.
LABEL, HEADING, GAP, EDGE, LINE = 0.44, 0.18, 0.05, 0.02, 0.12
LABEL_LETTERS = 16  # of a material's name in a line beside its row
REMARK_LETTERS = 19  # in an inch of a remark
WINDOWS = 5  # a window's side is a picture's divided by this
EQUAL_DB = 200.0  # stands for an infinite PSNR where differences are taken: beyond float32


@dataclass(frozen=True)
class Row:
    """What a row of pictures shows."""

    material: str
    scene: str


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments that these figures share."""
    parser.add_argument("--psnr", required=True, help="CSV made by npfm tables psnr")
    parser.add_argument("--run", required=True, help="folder of the run")
    parser.add_argument("--variants", nargs="+", required=True, help="columns, ours first")


def made_by(draw: Callable[..., Figure], *more: Sequence[str]) -> Maker:
    """Return the `make` of a figure of these arguments.

    Parameters
    ----------
    draw : callable
        Takes the folder of the run, the table of PSNR, the variants, and `more`.
    *more : sequence of str
        What the figure is told besides.
    """

    def make(arguments: argparse.Namespace) -> Figure:
        """Draw the figure from the pictures and the table that the arguments name."""
        psnr = tables.read_psnr(arguments.psnr)
        return draw(arguments.run, psnr, arguments.variants, *more)

    return make


@dataclass(frozen=True)
class Window:
    """A square of a picture: its upper left pixel, its side, and how much pictures differ there."""

    row: int
    column: int
    side: int
    difference: float


def common(psnr: pd.DataFrame, variants: Sequence[str]) -> tuple[pd.DataFrame, str]:
    """PSNR of the pictures that every variant has, and a remark on those that one lacks.

    Parameters
    ----------
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    variants : sequence of str
        What is compared.

    Returns
    -------
    table : DataFrame
        dB, at most `EQUAL_DB`, by (material, scene) and variant.
    remark : str
        Empty if nothing is missing.

    Raises
    ------
    NpfmError
        If no picture is left.
    """
    table = renderings(psnr, list(variants))
    left = table.dropna().clip(upper=EQUAL_DB)
    if left.empty:
        raise NpfmError(f"no picture that all of {', '.join(variants)} have; make them first")
    lacking = [f"{name} {count}" for name, count in table.isna().sum().items() if count]
    of = f"left out of {len(table)} renderings, for want of a fit or a PSNR: "
    return left, of + ", ".join(lacking) if lacking else ""


def window(pictures: Sequence[NDArray]) -> Window:
    """Find the square in which pictures differ most to the eye.

    It is placed by the root mean square, which prefers highlights and silhouettes to large even
    areas; how much they differ there is told by the mean, which a few odd pixels hardly change.

    Parameters
    ----------
    pictures : sequence of ndarray, shape (height, width, 3)
        Display values.
    """
    range_ = np.ptp(pictures, axis=0)
    side = max(1, min(range_.shape[:2]) // WINDOWS)
    squares = sliding_window_view((range_**2).mean(axis=2), (side, side)).mean(axis=(2, 3))
    row, column = np.unravel_index(np.argmax(squares), squares.shape)
    inside = range_[row : row + side, column : column + side]
    return Window(int(row), int(column), side, float(inside.mean()))


def telling_window(run: str | Path, row: Row, variants: Sequence[str]) -> Window:
    """`window` of pictures of a run."""
    return window([picture(run, row, name) for name in (MEASURED, *variants)])


def most_telling(
    run: str | Path, table: pd.DataFrame, wanted: Sequence[str], variants: Sequence[str]
) -> list[Row]:
    """Return a row for each material: the scene in which its fits are wrong most visibly.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the tone-mapped pictures.
    table : DataFrame
        By (material, scene), one row a picture.
    wanted : sequence of str
        Materials; for one that the table lacks, the nearest in diffuseness.
    variants : sequence of str
        The fits.
    """
    materials = chosen(wanted, table.index.unique("material"))
    return [
        max(
            (Row(*index) for index in table.loc[[name]].index),
            key=lambda row: telling_window(run, row, variants).difference,
        )
        for name in materials
    ]


def width(columns: int) -> float:
    """Inches of a figure with so many columns of pictures: a page's, or a column's of the text."""
    return style.PAGE_WIDTH if columns > 3 else style.COLUMN_WIDTH


def sheet(
    rows: int, columns: int, below: float, heading: float = HEADING
) -> tuple[Figure, NDArray]:
    """Return a figure of square cells that fill its width, and their axes, top row first.

    Parameters
    ----------
    rows, columns : int
        Number of cells.
    below, heading : float
        Inches left under and over the cells.
    """
    total = width(columns)
    pitch = (total - LABEL - EDGE + GAP) / columns
    height = heading + rows * pitch + below
    figure = Figure(figsize=(total, height))
    grid = figure.add_gridspec(
        rows,
        columns,
        left=LABEL / total,
        right=1 - EDGE / total,
        top=1 - heading / height,
        bottom=(below + GAP) / height,
        wspace=GAP / (pitch - GAP),
        hspace=GAP / (pitch - GAP),
    )
    return figure, grid.subplots(squeeze=False)


def draw(
    run: str | Path,
    psnr: pd.DataFrame,
    rows: Sequence[Row],
    variants: Sequence[str],
    remark: str = "",
    below: float = 0.0,
    headings: Sequence[str] | None = None,
) -> tuple[Figure, NDArray]:
    """Draw the measurement and some fits side by side, with the PSNR in the lower left corner.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the tone-mapped pictures.
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    rows, variants : sequences
        Rows and columns; the measurement is the first column.
    remark : str
        Stands under the pictures.
    below : float
        Inches to leave under the pictures, besides the remark.
    headings : sequence of str, optional
        What stands over the variants, if not their names.

    Returns
    -------
    figure : Figure
    axes : ndarray of Axes, shape (rows, 1 + variants)

    Raises
    ------
    NpfmError
        If a picture is missing.
    """
    columns = [MEASURED, *variants]
    decibels = renderings(psnr, list(variants))
    lines = textwrap.wrap(remark, int(width(len(columns)) * REMARK_LETTERS))
    headings = [MEASURED, *(headings or variants)]
    over = HEADING + LINE * max(heading.count("\n") for heading in headings)
    figure, axes = sheet(len(rows), len(columns), below + LINE * len(lines), over)
    for line, row in zip(axes, rows, strict=True):
        for ax, variant in zip(line, columns, strict=True):
            show(ax, picture(run, row, variant))
            if variant != MEASURED:
                value = decibels[variant][row.material, row.scene]
                corner_label(ax, decibels_label(value))
        row_label(line[0], row)
    for ax, heading in zip(axes[0], headings, strict=True):
        ax.set_title(heading, pad=3)
    for k, line in enumerate(lines):
        y = (below + LINE * (len(lines) - k - 0.7)) / figure.get_figheight()
        figure.text(0.01, y, line, fontsize=6)
    return figure, axes


def picture(run: str | Path, row: Row, variant: str) -> NDArray[np.float32]:
    """Return a tone-mapped picture of a run, values 0 to 1.

    Raises
    ------
    NpfmError
        If it is missing.
    """
    path = Path(run) / "renders" / row.scene / row.material / f"{variant}.png"
    if not path.is_file():
        raise NpfmError(f"{path}: no such picture; make it with npfm render")
    return imread(path)


def foreground(run: str | Path, row: Row) -> NDArray[np.bool_]:
    """Where the objects are in the pictures of a row."""
    path = Path(run) / "renders" / row.scene / row.material / f"{MEASURED}.exr"
    return read_reference(path)[1]


def show(ax: Axes, pixels: NDArray, **settings: Any) -> None:
    """Show a picture with nothing but a thin line around it.

    Colours are smoothed where they are enlarged a little or made smaller, which would double some
    pixels or drop some; pixels of a map of numbers are shown as they are.
    """
    ax.imshow(pixels, interpolation="auto" if pixels.ndim == 3 else "nearest", **settings)
    ax.set(xticks=[], yticks=[])
    ax.spines[:].set(color="0.7", linewidth=0.3)  # some lights are as white as the paper


def row_label(ax: Axes, row: Row) -> None:
    """Write left of a row what it shows."""
    lines = textwrap.wrap(row.material, LABEL_LETTERS)
    ax.set_ylabel("\n".join([*lines, f"scene {row.scene}"]), labelpad=2, linespacing=1.1)


def decibels_label(value: float) -> str:
    """PSNR as it stands beside a picture."""
    return "no PSNR" if np.isnan(value) else f"{value:.1f} dB"


def corner_label(ax: Axes, text: str) -> None:
    """Write into the lower left corner of a picture, readable on any."""
    ax.annotate(
        text,
        xy=(0, 0),
        xycoords="axes fraction",
        xytext=(2, 2.5),
        textcoords="offset points",
        fontsize=6,
        color="white",
        bbox={"facecolor": "black", "alpha": 0.6, "linewidth": 0, "pad": 1},
    )
