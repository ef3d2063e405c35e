"""A page of renderings of one material, as in the supplement of Bagher et al. 2016."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import imread

from npfm import tables
from npfm.errors import NpfmError
from npfm.figures import style

CELL = 1.35  # inches, side of a picture


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--psnr", required=True, help="CSV made by npfm tables psnr")
    parser.add_argument("--run", required=True, help="folder of the run")
    parser.add_argument("--material", required=True, help="the material")
    parser.add_argument("--scenes", nargs="+", required=True, help="rows")
    parser.add_argument("--variants", nargs="+", required=True, help="columns")


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
    """Draw the measurement and the fits of a material side by side, one row a scene.

    Parameters
    ----------
    run : str or Path
        Folder of the run, with the tone-mapped pictures.
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    material : str
        The material.
    scenes, variants : sequence of str
        Rows and columns; the measurement comes first.

    Returns
    -------
    Figure

    Raises
    ------
    NpfmError
        If a picture is missing.
    """
    decibels = psnr[psnr.material == material].set_index(["scene", "variant"]).psnr_db
    columns = ["measured", *variants]
    with style.context():
        size = CELL * len(columns), (CELL + 0.12) * len(scenes) + 0.4
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.subplots(len(scenes), len(columns), squeeze=False)
        for axes, scene in zip(grid, scenes, strict=True):
            for ax, variant in zip(axes, columns, strict=True):
                _picture(ax, Path(run) / "renders" / scene / material / f"{variant}.png")
                if (scene, variant) in decibels.index:
                    ax.set_xlabel(f"{decibels[scene, variant]:.1f} dB", labelpad=2)
            axes[0].set_ylabel(f"scene {scene}")
        for ax, variant in zip(grid[0], columns, strict=True):
            ax.set_title(variant)
        figure.suptitle(material, fontsize=9)
    return figure


def _picture(ax: Axes, path: Path) -> None:
    if not path.is_file():
        raise NpfmError(f"{path}: no such picture; make it with npfm render")
    ax.imshow(imread(path), interpolation="nearest")
    ax.set(xticks=[], yticks=[])
    ax.spines[:].set_visible(False)
