"""Figure 6 of Bagher et al. 2016: the factors of some materials, beside those it published."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from npfm.datasets import published_factors
from npfm.errors import NpfmError
from npfm.figures import style
from npfm.figures.slice_axes import factor_axis
from npfm.fitting import fits
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import CHANNELS
from npfm.storage.names import distinct

PANEL_HEIGHT, LEGEND_HEIGHT = 1.35, 0.4  # inches
#: Okabe and Ito's colours nearest to the channels' own.
COLORS = dict(zip(CHANNELS, ("#D55E00", "#009E73", "#0072B2"), strict=True))
OURS: dict[str, Any] = {"linewidth": 0.9}
PUBLISHED: dict[str, Any] = {"linewidth": 0.9, "linestyle": (0, (2.5, 1.2)), "alpha": 0.7}
#: The scale of a curve is told from these: at greater angles next to no sample counts, and
#: factors are clamped at 1e-6.
LARGEST_ANGLE, LEAST = 80.0, 2e-6  # degrees; of the largest
#: Angles of each row of ours, in degrees. Where D is narrow, theta_i and theta_o are next to
#: theta_d, and only the product of F and the square of G can be told from the measurement.
ANGLES = {
    "D": np.degrees(MERL.theta_h),
    "G": np.degrees(MERL.theta_d),  # whose bins have the nodes of G at their centres
    "F": np.degrees(MERL.theta_d),
    "F G²": np.degrees(MERL.theta_d),
}
PUBLISHED_ANGLES = ANGLES | {"G": np.degrees(published_factors.G_THETA)}
LABELS = {
    "D": r"$\theta_h$ (degrees)",
    "G": r"$\theta_i$ or $\theta_o$ (degrees)",
    "F": r"$\theta_d$ (degrees)",
    "F G²": r"$\theta_d = \theta_i = \theta_o$ (degrees)",
}

Curves = Mapping[str, NDArray[np.float64]]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--fits", nargs="+", required=True, help="fits (.npz) of independent-g")
    parser.add_argument("--published", help="published factors (.npz), to be drawn dashed")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the fits that the arguments name."""
    a = arguments
    names = distinct(Path(path).stem for path in a.fits)
    ours = dict(zip(names, map(_factors, a.fits), strict=True))
    return draw(ours, published_factors.read(a.published) if a.published else {})


def _factors(path: str) -> Curves:
    parameters = fits.load(path).parameters
    if missing := {"D", "G", "F"} - set(parameters):
        raise NpfmError(
            f"{path}: a fit without {', '.join(sorted(missing))}; give one of independent-g"
        )
    return {name: parameters[name].astype(float) for name in ("D", "G", "F")}


def scaled(ours: NDArray, angles: NDArray) -> NDArray[np.float64]:
    """Return a factor with its largest value, up to `LARGEST_ANGLE`, at 1."""
    return ours / ours[..., angles <= LARGEST_ANGLE].max()


def scale_to(published: NDArray, ours: NDArray, angles: NDArray) -> float:
    """Return what brings a published factor to the scale of ours, which the model leaves free.

    Parameters
    ----------
    published, ours : ndarray, shape (bins,)
        NaN where a factor is not known.
    angles : ndarray, shape (bins,)
        In degrees.

    Returns
    -------
    float
        The median of ours / published.
    """
    counts = (angles <= LARGEST_ANGLE) & (ours > LEAST * ours.max())
    counts &= published > LEAST * np.nanmax(published)
    return float(np.median(ours[counts] / published[counts]))


def draw(ours: Mapping[str, Curves], published: Mapping[str, Curves]) -> Figure:
    """Draw the factors, a column each material.

    Parameters
    ----------
    ours, published : mapping of str to mapping of str to ndarray of shape (3, 90)
        D, G and F of the channels by material, in any scale; published ones, as
        `npfm.datasets.published_factors.read` returns them, are drawn for the materials that have
        them.
    """
    size = style.PAGE_WIDTH, PANEL_HEIGHT * len(ANGLES) + LEGEND_HEIGHT
    with style.context():
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(ANGLES), len(ours), sharex="row", sharey="row", squeeze=False)
        for column, (material, factors) in zip(axes.T, ours.items(), strict=True):
            column[0].set_title(material)
            _draw_column(column, _curves(factors), published_curves(published.get(material, {})))
        for line, name in zip(axes, ANGLES, strict=True):
            line[0].set_ylabel(f"{name}, relative")
            for ax in line:
                _finish(ax, name)
        figure.legend(
            handles=_legend(any(name in published for name in ours)),
            loc="outside upper center",
            ncols=5,
            frameon=False,
        )
    return figure


def _curves(factors: Curves) -> dict[str, NDArray]:
    return {**factors, "F G²": factors["F"] * factors["G"] ** 2} if factors else {}


def published_curves(factors: Curves) -> dict[str, NDArray]:
    """Curves of published factors, whose G has nodes of its own."""
    if not factors:
        return {}
    at_bins = [np.interp(ANGLES["F"], PUBLISHED_ANGLES["G"], G) for G in factors["G"]]
    return {**factors, "F G²": factors["F"] * np.square(at_bins)}


def _draw_column(
    column: NDArray, ours: Mapping[str, NDArray], published: Mapping[str, NDArray]
) -> None:
    for ax, (name, angles) in zip(column, ANGLES.items(), strict=True):
        for k, color in enumerate(COLORS.values()):
            values = scaled(ours[name][k], angles)
            ax.plot(angles, values, color=color, **OURS)
            if published:
                nodes, theirs = PUBLISHED_ANGLES[name], published[name][k]
                scale = scale_to(np.interp(angles, nodes, theirs), values, angles)
                ax.plot(nodes, scale * theirs, color=color, **PUBLISHED)


def _finish(ax: Axes, name: str) -> None:
    factor_axis(ax, name)
    ax.set_xlabel(LABELS[name])
    if name == "D":
        ax.set_ylim(5e-7, 3)


def _legend(dashed: bool) -> list[Line2D]:
    handles = [Line2D([], [], color=color, label=name, **OURS) for name, color in COLORS.items()]
    if dashed:
        handles.append(Line2D([], [], color="0.3", label="published, in our scale", **PUBLISHED))
    return handles
