"""Pictures of animations for talks: a light turned around a material, and a fit converging."""

from collections.abc import Iterator, Mapping, Sequence
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from numpy.typing import NDArray

from npfm.figures import style
from npfm.figures.figure06 import LABELS, LARGEST_ANGLE
from npfm.figures.slice_axes import TICKS_H

#: Inches, and dots an inch: 960 x 400 pixels, the upper part of a slide.
SIZE, DPI = (9.6, 4.0), 100
FONT = 13.0  # points, to be read from the last row
THIN, THICK = 1.2, 3.0
LEAST_SHOWN = 1e-4  # of G and F; D goes on to the clamp


def light(
    title: str,
    degrees: Sequence[float],
    names: Sequence[str],
    pictures: NDArray[np.uint8],
    psnr: NDArray[np.float64],
) -> Iterator[NDArray[np.uint8]]:
    """Draw the measurement and the fits side by side, turn by turn.

    Parameters
    ----------
    title : str
        What is shown.
    degrees, names : sequences
        Turns of the light; the measurement and the fits.
    pictures : ndarray of uint8, shape (turns, names, h, w, 3)
        Display values.
    psnr : ndarray, shape (turns, fits)
        In dB.

    Yields
    ------
    ndarray of uint8, shape (height, width, 3)
    """
    with style.context():
        figure, axes, heading = _begun(title, len(names))
        images = [
            ax.imshow(p, interpolation="bicubic") for ax, p in zip(axes, pictures[0], strict=True)
        ]
        for ax in axes:
            ax.set_axis_off()
        for turn, row, values in zip(degrees, pictures, psnr, strict=True):
            heading.set_text(f"{title}, light turned by {turn:g}°")
            said = [names[0], *(f"{n}, {v:.1f} dB" for n, v in zip(names[1:], values, strict=True))]
            for ax, image, picture, text in zip(axes, images, row, said, strict=True):
                image.set_data(picture)
                ax.set_title(text, fontsize=FONT, parse_math=False)
            yield _drawn(figure)


def starts(
    title: str,
    angles: Mapping[str, NDArray],
    states: Sequence[Mapping[str, NDArray]],
    looks: Sequence[Mapping[str, str | None]],
    best: int,
) -> Iterator[NDArray[np.uint8]]:
    """Draw the factors of all starts, iteration by iteration.

    Parameters
    ----------
    title : str
        What is shown.
    angles : mapping of str to ndarray, shape (bins,)
        In degrees, by factor.
    states : sequence of mapping of str to ndarray, shape (iterations, bins)
        Of each start; one that ends earlier stays where it is.
    looks : sequence of mapping
        ``color`` and ``dashes`` of each start.
    best : int
        The start that led to the fit.

    Yields
    ------
    ndarray of uint8, shape (height, width, 3)
    """
    last = max(len(next(iter(start.values()))) for start in states) - 1
    with style.context():
        figure, axes, heading = _begun(title, len(angles))
        for ax, (name, at) in zip(axes, angles.items(), strict=True):
            _finish(ax, name, at, [start[name][-1] for start in states])
        lines = [[_line(ax, look, k == best) for k, look in enumerate(looks)] for ax in axes]
        for iteration in range(last + 1):
            heading.set_text(f"{title}, iteration {iteration} of {last}")
            for of_factor, (name, at) in zip(lines, angles.items(), strict=True):
                for line, start in zip(of_factor, states, strict=True):
                    line.set_data(at, start[name][min(iteration, len(start[name]) - 1)])
            yield _drawn(figure)


def _begun(title: str, columns: int) -> tuple[Figure, Sequence[Axes], Text]:
    """Return a figure with so many panels in a row, and its heading."""
    figure = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    # Names are text, whatever dollars they have.
    heading = figure.suptitle(title, fontsize=FONT, fontweight="bold", parse_math=False)
    return figure, list(figure.subplots(1, columns, squeeze=False)[0]), heading


def _drawn(figure: Figure) -> NDArray[np.uint8]:
    canvas = cast(FigureCanvasAgg, figure.canvas)
    canvas.draw()
    figure.set_layout_engine("none")  # which is in place, and takes longer than the drawing
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _line(ax: Axes, look: Mapping[str, str | None], is_best: bool) -> Line2D:
    dashes = (0, (4, 1.5)) if look["dashes"] else "-"
    width, order = (THICK, 3) if is_best else (THIN, 2)
    [line] = ax.plot([], [], color=look["color"], linestyle=dashes, linewidth=width, zorder=order)
    return line


def _finish(ax: Axes, name: str, angles: NDArray, ends: Sequence[NDArray]) -> None:
    """Axes as in Figure 6, with room for what the starts end in."""
    ax.set_title(f"{name}, relative", fontsize=FONT)
    ax.set(yscale="log", xlim=(0, 90))
    ax.set_xlabel(LABELS[name], fontsize=FONT)
    ax.tick_params(labelsize=FONT - 3)
    if name == "D":
        ax.set_ylim(5e-7, 3)
        ax.set_xscale("function", functions=(np.sqrt, np.square))
        ax.set_xticks(TICKS_H)
    else:
        least = min(values[angles <= LARGEST_ANGLE].min() for values in ends)
        ax.set_ylim(max(LEAST_SHOWN, min(0.5, least) / 1.3), 1.6)
        ax.set_xticks(range(0, 91, 30))
    ax.grid(True)
    ax.set_axisbelow(True)
