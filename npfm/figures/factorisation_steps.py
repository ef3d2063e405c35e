"""Figures 2 and 3 of Lawrence et al. 2004: the steps of a factorisation.

Brightness is the cube root of the share of the largest value, so that tails are seen.
"""

import argparse

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.datasets.analytic import brdf
from npfm.figures import style
from npfm.fitting import fits
from npfm.fitting.factorisation.matrix import Brdf, sampled
from npfm.reflectance.factored import TWO_PI, Angles, Factors, read

Array = NDArray[np.float64]

HEIGHT = 8.2  # inches
#: Elevations of the views that are shown, in degrees, and pixels along the side of a slice.
SHOWN, PIXELS = (5, 25, 45, 65), 160
#: Azimuth of these views.
AZIMUTH = np.pi / 4
COLORS = ("#0077BB", "#CC3311", "#009988", "#EE7733")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--brdf", required=True, help="MERL .binary file, or a formula's name")
    parser.add_argument("--factors", required=True, help="its factors, made by npfm factor")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the files that the arguments name."""
    return draw(brdf(arguments.brdf), read(fits.load(arguments.factors).parameters))


def draw(reflected: Brdf, factors: Factors) -> Figure:
    """Draw slices, the matrix of all slices, and what it is factored into.

    Parameters
    ----------
    reflected : callable
        The BRDF.
    factors : Factors
        Of that BRDF.
    """
    angles = factors.angles
    with style.context():
        figure = Figure(figsize=(style.PAGE_WIDTH, HEIGHT), layout="constrained")
        rows = np.asarray(figure.subfigures(3, 1, height_ratios=(4, 3.2, 3)))
        slices, matrices, columns = rows
        _slices(slices.subplots(2, len(SHOWN)), reflected, angles)
        _matrices(matrices.subplots(1, 3, width_ratios=(4, 1, 3)), reflected, factors)
        _columns(columns.subplots(1, 3), factors)
    return figure


def _shown(values: Array) -> Array:
    return np.cbrt(values / (values.max() or 1.0))


def _image(ax: Axes, values: Array, title: str) -> None:
    ax.imshow(_shown(values), cmap="gray", aspect="auto", interpolation="nearest")
    ax.set_title(title)
    ax.set_xticks([])
    ax.set_yticks([])


def _slices(axes: NDArray, reflected: Brdf, angles: Angles) -> None:
    """Light and half vectors of a few views, seen from above."""
    place = (np.arange(PIXELS) + 0.5) / PIXELS * 2 - 1
    x, y = np.meshgrid(place, -place)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    p = np.stack([x, y, z], axis=-1)[inside]
    for column, degrees in enumerate(SHOWN):
        theta = np.radians(degrees)
        across = np.sin(theta) * np.array([np.cos(AZIMUTH), np.sin(AZIMUTH)])
        view = np.array([*across, np.cos(theta)])
        lights = {"light": p, "half vector": 2 * (p @ view)[:, None] * p - view}
        for row, (name, light) in enumerate(lights.items()):
            above = light[:, 2] > 0
            value = np.zeros(len(p))
            pairs = light[above], np.broadcast_to(view, light[above].shape)
            value[above] = reflected(*pairs).mean(axis=0) * light[above, 2]
            image = np.ones((PIXELS, PIXELS))
            image[inside] = _shown(value)
            ax = axes[row, column]
            ax.imshow(image, cmap="gray", vmin=0, vmax=1)
            ax.set_axis_off()
            ax.set_title(f"by the {name}, view {degrees}\N{DEGREE SIGN}")


def _matrices(axes: NDArray, reflected: Brdf, factors: Factors) -> None:
    """The matrix of the first factorisation, and what it is factored into."""
    angles = factors.angles
    samples = sampled(reflected, angles)
    Y = np.maximum(samples.value - factors.rho_d[:, None, None], 0).mean(axis=0) * samples.cos_i
    if angles.jacobian:
        Y = Y * samples.jacobian
    views = "views" if angles.relative else "views, by azimuth and elevation"
    _image(axes[0], Y, "matrix Y")
    axes[0].set_xlabel(views)
    axes[0].set_ylabel(r"$\theta_p$, $\phi_p$")
    _image(axes[1], _second(factors).reshape(len(factors.u), -1).T, "G")
    axes[1].set_xlabel("terms")
    F = factors.F_o.reshape(len(factors.F_o), -1)
    for j, row in enumerate(F):
        axes[2].plot(row / F.max(), color=COLORS[j % len(COLORS)], label=f"$F_{j + 1}$")
    axes[2].set_title("F, share of its maximum")
    axes[2].set_xlabel(views)
    axes[2].legend(frameon=False)


def _second(factors: Factors) -> Array:
    """G as densities, shape (J, theta_p, phi_p)."""
    product = np.einsum("jkn,jkm->jnm", factors.u, factors.v)
    return product / factors.angles.bands[:, None]


def _columns(axes: NDArray, factors: Factors) -> None:
    """The first column of G as a matrix, and its factors."""
    angles = factors.angles
    _image(axes[0], _second(factors)[0], "first column of G, as a matrix")
    axes[0].set_xlabel(r"$\phi_p$")
    axes[0].set_ylabel(r"$\theta_p$")
    u, v = factors.u[0] / angles.bands, factors.v[0]
    for k in range(len(u)):
        color = COLORS[k % len(COLORS)]
        if u[k].max() > 0:
            axes[1].plot(np.degrees(angles.theta_p), u[k] / u[k].max(), color=color)
        axes[2].plot(np.degrees(angles.phi_p), v[k] / v.max(), color=color, label=f"k = {k + 1}")
    axes[1].set_title("u, each a share of its maximum")
    axes[1].set_xlabel(r"$\theta_p$ (degrees)")
    axes[2].set_title("v, share of the maximum of all")
    axes[2].set_xlabel(r"$\phi_p$ (degrees)")
    axes[2].set_xlim(0, np.degrees(TWO_PI))
    axes[2].set_xticks(range(0, 361, 90))
    axes[2].legend(frameon=False)
