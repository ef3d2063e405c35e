"""Figure 5 of Lawrence et al. 2004: surfaces in the light of one direction, and by their factors.

The paper shows a vase; here it is a sphere, seen from afar, whose tangent runs along its circles
of latitude. Both pictures of a pair have one exposure.
"""

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from npfm.datasets.analytic import brdf
from npfm.errors import NpfmError
from npfm.figures import style
from npfm.fitting import fits
from npfm.fitting.factorisation.matrix import Brdf
from npfm.reflectance.factored import read, reflectance

Array = NDArray[np.float64]

PIXELS, ROW = 300, 2.0  # along the side of a picture, and inches of one
#: Direction of the light; the view is along z.
LIGHT = np.array([-0.45, 0.55, 0.705])
#: Share of the pixels that may be white, and exponent of the display.
WHITE, GAMMA = 0.01, 2.2


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare what the figure is made from."""
    parser.add_argument("--brdfs", nargs="+", required=True, help="tables, or names of formulas")
    parser.add_argument("--factors", nargs="+", required=True, help="factors of each, in order")
    parser.add_argument("--names", nargs="+", required=True, help="what each is called")


def make(arguments: argparse.Namespace) -> Figure:
    """Draw the figure from the files that the arguments name.

    Raises
    ------
    NpfmError
        If there are not as many factors and names as BRDFs.
    """
    if not len(arguments.brdfs) == len(arguments.factors) == len(arguments.names):
        raise NpfmError("--brdfs, --factors and --names differ in number; give one of each")
    shown = []
    for path in arguments.factors:
        factors = read(fits.load(path).parameters)
        shown.append(lambda light, view, factors=factors: reflectance(factors, light, view))
    return draw([brdf(source) for source in arguments.brdfs], shown, arguments.names)


def draw(brdfs: Sequence[Brdf], models: Sequence[Brdf], names: Sequence[str]) -> Figure:
    """Draw two pictures of each material, side by side, and where they differ."""
    disc = (_normals()[..., 2] > 0)[..., None]
    with style.context():
        size = (style.PAGE_WIDTH, ROW * len(names))
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots(len(names), 3, squeeze=False)
        for row, reflected, model, name in zip(axes, brdfs, models, names, strict=True):
            measured, shown = picture(reflected), picture(model)
            error = np.abs(shown - measured).mean() / (measured.mean() or 1.0)
            white = np.quantile(measured.max(axis=-1), 1 - WHITE) or 1.0
            pictures = (measured, shown, np.abs(shown - measured))
            titles = (name, "by its factors", f"difference, {100 * error:.1f} % of the mean")
            for ax, image, title in zip(row, pictures, titles, strict=True):
                tones = np.where(disc, np.clip(image / white, 0, 1) ** (1 / GAMMA), 1)
                ax.imshow(tones, interpolation="nearest")
                ax.set_title(title)
                ax.set_axis_off()
    return figure


def picture(reflected: Brdf) -> Array:
    """Radiance of a sphere in a light of irradiance 1 across it, (PIXELS, PIXELS, 3)."""
    normals = _normals()
    inside = normals[..., 2] > 0
    normal = normals[inside]
    tangent = np.cross([0.0, 1.0, 0.0], normal)
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    frame = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    light, view = frame @ (LIGHT / np.linalg.norm(LIGHT)), frame @ np.array([0.0, 0.0, 1.0])
    lit = (light[:, 2] > 0) & (view[:, 2] > 0)
    radiance = np.zeros((len(normal), 3))
    radiance[lit] = (reflected(light[lit], view[lit]) * light[lit, 2]).T
    image = np.zeros((PIXELS, PIXELS, 3))
    image[inside] = radiance
    return image


def _normals() -> Array:
    """Normals of a sphere at the pixels, (PIXELS, PIXELS, 3), with z 0 beside it."""
    place = (np.arange(PIXELS) + 0.5) / PIXELS * 2 - 1
    x, y = np.meshgrid(place, -place)
    return np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1)
