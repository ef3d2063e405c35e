"""Figure 16 of Bagher et al. 2016: the fits of all materials in one texture."""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import NDArray

from npfm.exports.texture import rows, texture
from npfm.figures import style
from npfm.figures.slice_axes import TICKS_D, TICKS_H
from npfm.fitting import fits
from npfm.storage.names import distinct

COEFFICIENT_HEIGHT, FACTOR_HEIGHT = 0.16, 1.15  # inches
POINTS, LETTER = 72, 0.62  # points an inch; width of a letter, of its size
NAMES_WIDTH = 6.2  # inches
LEAST = 1e-6  # of a factor; darkest
LABELS = {
    "rho_d": r"$\rho_d$",
    "rho_s": r"$\rho_s$",
    "D": r"$D$: $\theta_h$ (degrees)",
    "G": r"$G$: $\theta_{i,o}$ (degrees)",
    "F": r"$F$: $\theta_d$ (degrees)",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--fits", nargs="+", required=True, help="fits (.npz) of independent-g")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the fits that the arguments name."""
    names = distinct(Path(path).stem for path in arguments.fits)
    loaded = dict(zip(names, map(fits.load, arguments.fits), strict=True))
    values, places = texture(loaded), rows(next(iter(loaded.values())))
    return draw({name: values[place] for name, place in places.items()}, list(loaded))


def brightness(values: NDArray, least: float, most: float) -> NDArray[np.float64]:
    """Place of the logarithm of values between those of two others, from 0 to 1."""
    least, most = np.log(least), np.log(most)
    with np.errstate(divide="ignore"):
        return np.clip((np.log(values) - least) / (most - least), 0, 1)


def draw(parts: Mapping[str, NDArray], materials: Sequence[str]) -> Figure:
    """Draw the texture, its parts with a height of their own.

    Parameters
    ----------
    parts : mapping of str to ndarray of shape (rows, materials, 3)
        The rows of each parameter.
    materials : sequence of str
        Columns.
    """
    heights = [COEFFICIENT_HEIGHT if len(p) == 1 else FACTOR_HEIGHT for p in parts.values()]
    name_size = min(style.SETTINGS["font.size"], 0.9 * NAMES_WIDTH * POINTS / len(materials))
    names_height = LETTER * name_size * max(map(len, materials)) / POINTS
    with style.context():
        size = style.PAGE_WIDTH, sum(heights) + 0.1 * len(heights) + names_height
        figure = Figure(figsize=size, layout=ConstrainedLayoutEngine(hspace=0, h_pad=0.04))
        axes = figure.subplots(len(parts), 1, sharex=True, height_ratios=heights)
        for ax, (name, values) in zip(axes, parts.items(), strict=True):
            _draw_part(ax, values, name)
        axes[-1].set_xticks(range(len(materials)), materials, rotation=90, fontsize=name_size)
    return figure


def _draw_part(ax: Axes, values: NDArray, name: str) -> None:
    coefficient = len(values) == 1
    positive = values[values > 0]
    ends = (positive.min(), positive.max()) if coefficient and positive.size else (LEAST, 1.0)
    colors = brightness(values, *ends)
    extent = (-0.5, values.shape[1] - 0.5, 90, 0)
    ax.imshow(colors, extent=extent, aspect="auto", interpolation="nearest")
    if coefficient:
        ax.set_yticks([])
        ax.set_ylabel(LABELS[name], rotation=0, ha="right", va="center")
        return
    # The bins of theta_h are uniform in its root.
    ticks = [(np.sqrt(90 * t), t) for t in TICKS_H] if name == "D" else [(t, t) for t in TICKS_D]
    ax.set_yticks([place for place, _ in ticks], [str(t) for _, t in ticks])
    ax.set_ylabel(LABELS[name])
