"""The mean D, F and G of many materials, and how the first curves of a basis change them."""

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.figures import style
from npfm.figures.figure06 import LABELS
from npfm.figures.slice_axes import factor_axis
from npfm.fitting.basis import library
from npfm.fitting.basis.curves import coefficients, reconstruct
from npfm.fitting.basis.library import Library
from npfm.fitting.basis.lobes import FACTORS
from npfm.fitting.factors.microfacet import G_THETA

PANEL_HEIGHT, LEGEND_HEIGHT = 1.6, 0.4  # inches
#: Of the curves that are shown; Okabe and Ito's.
COLORS = ("#0072B2", "#D55E00", "#009E73")
#: A factor is drawn down to this share of its largest value.
LEAST = 5e-7


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--factors", nargs="+", required=True, help="made by npfm basis gather")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the factors that the arguments name."""
    return draw([library.load(path) for path in arguments.factors])


def draw(libraries: Sequence[Library]) -> Figure:
    """Draw D, F and G, a row each library.

    Parameters
    ----------
    libraries : sequence of Library
        The curves are those of all their materials.
    """
    size = style.PAGE_WIDTH, PANEL_HEIGHT * len(libraries) + LEGEND_HEIGHT
    with style.context():
        figure = Figure(figsize=size, layout="constrained")
        rows = figure.subplots(len(libraries), 3, sharex="col", sharey="col", squeeze=False)
        for axes, found in zip(rows, libraries, strict=True):
            _draw_row(axes, found)
            axes[0].set_ylabel(f"{found.model}\nrelative")
        for ax, name in zip(rows[0], FACTORS, strict=True):
            ax.set_title(name)
        for ax, name in zip(rows[-1], FACTORS, strict=True):
            ax.set_xlabel(LABELS[name])
        handles = rows[0][0].get_legend_handles_labels()
        figure.legend(*handles, loc="outside upper center", ncols=4, frameon=False)
    return figure


def _draw_row(axes: NDArray, found: Library) -> None:
    bases = found.bases(len(COLORS))
    angles = {"D": found.grid.theta_h, "F": found.grid.theta_d, "G": G_THETA}
    for ax, name in zip(axes, FACTORS, strict=True):
        basis, degrees = bases[name], np.degrees(angles[name])
        logs = found.logs[name].reshape(-1, degrees.size)
        spread = coefficients(basis, logs).std(0)
        for k in range(basis.count):
            for sign, dash in ((1, "-"), (-1, (0, (3, 1.5)))):
                moved = sign * spread * (np.arange(basis.count) == k)
                label = f"curve {k + 1}, {'plus' if sign > 0 else 'minus'} one deviation"
                factor = reconstruct(basis, moved)
                ax.plot(degrees, factor, color=COLORS[k], linestyle=dash, label=label)
        mean = reconstruct(basis, np.zeros(basis.count))
        ax.plot(degrees, mean, "k", linewidth=1.2, label="mean")
        factor_axis(ax, name)
        ax.set_ylim(LEAST, 3)
