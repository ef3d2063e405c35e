"""Materials made smoother and rougher: slopes stretched, all else as it was fitted."""

import argparse
from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.image import imread

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.figures import style
from npfm.figures.renderings import corner_label, sheet, show

#: Name of the pictures on which roughness varies, in place of a factor.
TEXTURED = "textured"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    add = parser.add_argument
    add("--pictures", required=True, help="folder with <material>/<factor>.png")
    add("--materials", nargs="+", required=True, help="rows")
    add(
        "--factors",
        nargs="+",
        required=True,
        help=f"columns, as their files are named; {TEXTURED}: roughness varies",
    )
    add("--surfaces", required=True, help="CSV made by power-iterations surfaces")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the pictures and the table that the arguments name."""
    a = arguments
    return draw(a.pictures, a.materials, a.factors, _surfaces(a.surfaces))


def _surfaces(path: str) -> pd.DataFrame:
    """Roughness by material, of either kind of surface."""
    try:
        return tables.read(path, ["material", "resolved"], ["alpha_ggx"])
    except NpfmError:
        return tables.read(path, ["material"], ["alpha_x", "alpha_y"])


def draw(
    pictures: str | Path, materials: Sequence[str], factors: Sequence[str], surfaces: pd.DataFrame
) -> Figure:
    """Draw a row of pictures for each material, with its roughness in a corner if that is known.

    Parameters
    ----------
    pictures : str or Path
        Folder with ``<material>/<factor>.png``.
    materials, factors : sequence of str
        Rows and columns.
    surfaces : DataFrame
        Columns material, alpha_ggx and resolved, which is ``True`` or ``False``; or material,
        alpha_x and alpha_y.

    Returns
    -------
    Figure

    Raises
    ------
    NpfmError
        If a picture is missing.
    """
    rows = surfaces.set_index("material").to_dict("index")
    with style.context():
        figure, axes = sheet(len(materials), len(factors), 0.0)
        for line, material in zip(axes, materials, strict=True):
            for ax, factor in zip(line, factors, strict=True):
                path = Path(pictures) / material / f"{factor}.png"
                if not path.is_file():
                    raise NpfmError(f"{path}: no such picture; make it with npfm render")
                show(ax, imread(path))
                if factor != TEXTURED:
                    corner_label(ax, _roughness(rows[material], float(factor)))
            line[0].set_ylabel(material, labelpad=2)
        for ax, factor in zip(axes[0], factors, strict=True):
            heading = {"1": "as fitted", TEXTURED: "by a texture"}.get(factor, f"slopes x {factor}")
            ax.set_title(heading, pad=3)
    return figure


def _roughness(surface: Mapping[Hashable, Any], factor: float) -> str:
    if "alpha_x" in surface:
        return f"$\\alpha$ {surface['alpha_x'] * factor:.2g}, {surface['alpha_y'] * factor:.2g}"
    if surface["resolved"] != "True":
        return "$\\alpha$ not resolved"
    return f"$\\alpha$ {surface['alpha_ggx'] * factor:.2g}"
