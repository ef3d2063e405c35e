"""Figure 5 of Bagher et al. 2016: measured and fitted slices at phi_d = 90 degrees."""

import argparse
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.figures import slice_axes, style
from npfm.fitting import registry
from npfm.fitting.objective import (
    COMPRESSION_ALPHA,
    Objective,
    compressed,
    counted,
    importance,
    volume_form,
    weighted_median,
)
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table

HEADING, PITCH = 0.45, 1.62  # inches


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--run", required=True, help="folder of the run")
    parser.add_argument("--materials", nargs="+", required=True, help="rows")
    parser.add_argument("--variants", nargs="+", required=True, help="columns")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the tables and fits that the arguments name."""
    a = arguments
    return draw({name: _row(a.run, name, a.variants) for name in a.materials})


def _row(run: str, material: str, variants: Sequence[str]) -> dict[str, NDArray]:
    measured = read_binary(f"{run}/materials/{material}.binary")
    tables = {"measured": measured}
    tables |= {v: registry.tabulated(f"{run}/fits/{v}/{material}.npz") for v in variants}
    scale = median(measured)
    return {name: shown(table, scale) for name, table in tables.items()}


def median(table: Table) -> float:
    """Weighted median (1/sr) of all channels together, so that colours keep their hue."""
    grid = table.grid
    counts = counted(grid, Objective().max_angle) & table.valid
    weight = np.where(counts, volume_form(grid) * importance(grid), 0.0)
    return weighted_median(table.values, weight) or 1.0


def shown(table: Table, scale: float) -> NDArray[np.float64]:
    """Colours of the slice at phi_d = 90 degrees.

    Parameters
    ----------
    table : Table
        BRDF in 1/sr.
    scale : float
        The BRDF (1/sr) that becomes half of the brightest value.

    Returns
    -------
    ndarray, shape (theta_h, theta_d, 4)
        RGB by the compressive function, from 0 to 1; transparent where there is no measurement.
    """
    values = table.values[..., table.grid.phi_d_bins // 2]
    colors = COMPRESSION_ALPHA * compressed(np.maximum(values, 0) / scale)
    return np.stack([*colors, (values >= 0).all(axis=0)], axis=-1)


def draw(rows: Mapping[str, Mapping[str, NDArray]]) -> Figure:
    """Draw slices, a row each material.

    Parameters
    ----------
    rows : mapping of str to mapping of str to ndarray of shape (theta_h, theta_d, 4)
        RGBA from 0 to 1, by material and by what stands over the column.
    """
    columns = list(next(iter(rows.values())))
    with style.context():
        size = style.PAGE_WIDTH, HEADING + PITCH * len(rows)
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
        for line, (material, row) in zip(axes, rows.items(), strict=True):
            for ax, name in zip(line, columns, strict=True):
                slice_axes.show(ax, row[name])
            line[0].set_ylabel(material)
        for ax, name in zip(axes[0], columns, strict=True):
            ax.set_title(name)
        slice_axes.label(axes)
    return figure
