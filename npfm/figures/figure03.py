"""Figure 3 of Bagher et al. 2016: the objective's weights over the three angles."""

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.figures import slice_axes, style
from npfm.fitting.objective import Objective, channel_samples, counted, importance, volume_form
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.reflectance.table_files import read_table

CHANNEL = 1  # green
PHI_D = (0, 45, 90)  # degrees, of the slices
HEIGHT = 4.75  # inches
COLORS = "cividis"  # told apart in all common forms of colour blindness


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--table", required=True, help="MERL .binary file of a material")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the table that the arguments name."""
    table = read_table(arguments.table)
    if not isinstance(table.grid, HalfDifference):
        raise NpfmError(
            f"{arguments.table}: the weights are shown over theta_h, theta_d and phi_d; "
            "give a MERL .binary file"
        )
    return draw(weights(table, Objective()), table.grid, Path(arguments.table).stem)


def weights(table: Table, objective: Objective) -> dict[str, NDArray[np.float64]]:
    """Weights of the samples of the green channel, by what stands over them.

    Each is a share of its largest, and NaN where a sample does not count.

    Parameters
    ----------
    table : Table
        Measured BRDF in 1/sr.
    objective : Objective
        With the compressive weight.
    """
    grid = table.grid
    geometric = volume_form(grid) * importance(grid)
    whole = channel_samples(table, CHANNEL, objective).weight
    usable = counted(grid, objective.max_angle) & (whole > 0)
    shares = {
        "volume form $w_V$": volume_form(grid),
        "importance $w_I$": importance(grid),
        "compressive $w_C$": whole / np.where(usable, geometric, 1.0),
        "product $w$": whole,
    }
    return {name: np.where(usable, w / w[usable].max(), np.nan) for name, w in shares.items()}


def draw(weights: Mapping[str, NDArray], grid: HalfDifference, material: str) -> Figure:
    """Draw slices of weights, a column each, at some phi_d from top to bottom.

    Parameters
    ----------
    weights : mapping of str to ndarray of shape grid.shape
        Shares of the largest, NaN where there is none.
    grid : HalfDifference
    material : str
        Whose compressive weight it is.
    """
    rows = {phi: phi * grid.phi_d_bins // 180 for phi in PHI_D}
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        axes = figure.subplots(len(rows), len(weights), sharex=True, sharey=True, squeeze=False)
        for line, (phi, k) in zip(axes, rows.items(), strict=True):
            for ax, values in zip(line, weights.values(), strict=True):
                image = slice_axes.show(ax, values[..., k], cmap=COLORS, vmin=0, vmax=1)
            line[0].set_ylabel(rf"$\phi_d = {phi}\degree$")
        for ax, name in zip(axes[0], weights, strict=True):
            ax.set_title(name)
        slice_axes.label(axes)
        bar = figure.colorbar(image, ax=axes, shrink=0.5, aspect=30, pad=0.01)
        bar.set_label(f"share of the largest ({material}, green channel)")
    return figure
