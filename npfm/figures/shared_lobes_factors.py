"""Figure 5 of Peng et al. 2017: the lobes' D and G, and the channels' F, of some materials."""

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.figures import style
from npfm.figures.figure06 import COLORS, LABELS
from npfm.figures.slice_axes import factor_axis
from npfm.fitting import fits
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.fits import Fit
from npfm.storage.names import distinct

PANEL_HEIGHT, LEGEND_HEIGHT = 1.5, 0.4  # inches
FACTORS = ("D", "F", "G")
#: Of lobes, from the narrowest to the widest: told apart in print as well.
DASHES = ("-", (0, (4, 1.2)), (0, (1, 1)), (0, (4, 1, 1, 1)), (0, (6, 2)))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--fits", nargs="+", required=True, help="fits (.npz) of shared-lobes")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the fits that the arguments name."""
    paths = arguments.fits
    return draw(dict(zip(distinct(Path(p).stem for p in paths), map(_fit, paths), strict=True)))


def _fit(path: str) -> Fit:
    fit = fits.load(path)
    if fit.model != "shared-lobes" or len(fit.parameters["D"]) != 1 or fit.grid.anisotropic:
        raise NpfmError(
            f"{path}: no fit of lobes of theta_h that the channels share; give one of shared-lobes"
        )
    return fit


def draw(found: Mapping[str, Fit]) -> Figure:
    """Draw D, F and G, a row each material, each curve with its largest value at 1.

    Parameters
    ----------
    found : mapping of str to Fit
        Fits of shared-lobes by material.
    """
    size = style.PAGE_WIDTH, PANEL_HEIGHT * len(found) + LEGEND_HEIGHT
    with style.context():
        figure = Figure(figsize=size, layout="constrained")
        rows = figure.subplots(len(found), 3, sharex="col", sharey="col", squeeze=False)
        for axes, (material, fit) in zip(rows, found.items(), strict=True):
            _draw_row(axes, fit)
            axes[0].set_ylabel(f"{material}\nrelative")
        for ax, name in zip(rows[0], FACTORS, strict=True):
            ax.set_title(name)
        for ax, name in zip(rows[-1], FACTORS, strict=True):
            ax.set_xlabel(LABELS[name])
        handles = [*rows[0][0].get_lines(), *rows[0][1].get_lines()]
        figure.legend(
            handles=handles, loc="outside upper center", ncols=len(handles), frameon=False
        )
    return figure


def _draw_row(axes: NDArray, fit: Fit) -> None:
    D, G = (fit.parameters[name][0].astype(float) for name in ("D", "G"))
    for k, (of_D, of_G) in enumerate(zip(D, G, strict=True)):
        for ax, angles, values in ((axes[0], fit.grid.theta_h, of_D), (axes[2], G_THETA, of_G)):
            ax.plot(np.degrees(angles), values, "k", linestyle=DASHES[k], label=f"lobe {k + 1}")
    for F, (channel, color) in zip(fit.parameters["F"], COLORS.items(), strict=True):
        axes[1].plot(np.degrees(fit.grid.theta_d), F, color=color, label=channel)
    for ax, name in zip(axes, FACTORS, strict=True):
        factor_axis(ax, name)
        ax.set_ylim(5e-7, 3)
