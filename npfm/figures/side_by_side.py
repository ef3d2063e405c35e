"""Figure 6 of Dupuy et al. 2015: a few materials, measured and by each model, side by side."""

import argparse
import textwrap
from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.image import imread
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.figures import style
from npfm.figures.renderings import HEADING, LINE, MEASURED, corner_label, sheet, show
from npfm.storage.names import named

#: Of a name over a column, and beside a row.
LETTERS = 15


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    add = parser.add_argument
    add("--measured", required=True, help="folder of the pictures of a scene")
    add("--fits", nargs="+", required=True, metavar="VARIANT=FOLDER", help="the same, of fits")
    add("--materials", nargs="+", required=True, help="rows")
    add("--table", required=True, help="CSV made by power-iterations delta-e")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    folders = {MEASURED: a.measured} | named(a.fits, "ggx=renders/A", taken=[MEASURED])
    table = tables.read(a.table, ["material", "variant"], ["delta_e"])
    return draw(folders, a.materials, table)


def draw(
    folders: Mapping[str, str | Path], materials: Sequence[str], table: pd.DataFrame
) -> Figure:
    """Draw a row of pictures for each material, with the colour difference in a corner.

    Parameters
    ----------
    folders : mapping of str to (str or Path)
        By column, the folder that holds ``<material>/<column>.png``.
    materials : sequence of str
        Rows.
    table : DataFrame
        Columns material, variant, delta_e.

    Returns
    -------
    Figure

    Raises
    ------
    NpfmError
        If a picture is missing.
    """
    differences = table.set_index(["material", "variant"]).delta_e
    with style.context():
        figure, axes = sheet(len(materials), len(folders), 0.0, HEADING + LINE)
        for line, material in zip(axes, materials, strict=True):
            for ax, (column, folder) in zip(line, folders.items(), strict=True):
                show(ax, _picture(Path(folder) / material / f"{column}.png"))
                if (material, column) in differences.index:
                    corner_label(ax, f"$\\Delta$E {differences[material, column]:.1f}")
            line[0].set_ylabel(textwrap.fill(material, LETTERS), labelpad=2)
        for ax, column in zip(axes[0], folders, strict=True):
            ax.set_title(textwrap.fill(column, LETTERS), pad=3)
    return figure


def _picture(path: Path) -> NDArray:
    if not path.is_file():
        raise NpfmError(f"{path}: no such picture; make it with npfm render")
    return imread(path)
