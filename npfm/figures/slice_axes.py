"""Axes of slices of a table at one phi_d, over theta_h and theta_d, and of factors of one angle."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.image import AxesImage
from numpy.typing import NDArray

#: Degrees with a tick; the axis of theta_h is uniform in its root, as the bins are.
TICKS_H, TICKS_D = (0, 5, 20, 45, 90), (0, 30, 60, 90)


def show(ax: Axes, values: NDArray, **settings: Any) -> AxesImage:
    """Draw a slice, theta_h to the right and theta_d upwards, hatched where there is nothing.

    Parameters
    ----------
    ax : Axes
    values : ndarray, shape (theta_h, theta_d) or (theta_h, theta_d, 4)
        Numbers, or RGBA from 0 to 1.
    **settings
        Of `Axes.imshow`.
    """
    ax.patch.set(hatch="/" * 6, edgecolor="0.8", linewidth=0)
    image = ax.imshow(
        np.swapaxes(values, 0, 1),
        origin="lower",
        extent=(0, 1, 0, 90),
        aspect=1 / 90,
        interpolation="nearest",
        **settings,
    )
    ax.set_xticks(np.sqrt(np.array(TICKS_H) / 90), map(str, TICKS_H))
    ax.set_yticks(TICKS_D)
    return image


def label(axes: NDArray) -> None:
    """Label the outer axes of a grid of slices; what is left of a row is kept as its first line."""
    for ax in axes[-1]:
        ax.set_xlabel(r"$\theta_h$ (degrees)")
    for ax in axes[:, 0]:
        ax.set_ylabel("\n".join(filter(None, (ax.get_ylabel(), r"$\theta_d$ (degrees)"))))


def factor_axis(ax: Axes, name: str) -> None:
    """Prepare the axes of a factor in degrees, its values on a logarithmic scale.

    Parameters
    ----------
    ax : Axes
    name : str
        Of the factor; the axis of a D is uniform in the root of theta_h, as the bins are.
    """
    ax.set(yscale="log", xlim=(0, 90))
    if name == "D":
        ax.set_xscale("function", functions=(np.sqrt, np.square))
        ax.set_xticks(TICKS_H)
    else:
        ax.set_xticks(range(0, 91, 15))
    ax.grid(True)
    ax.set_axisbelow(True)
