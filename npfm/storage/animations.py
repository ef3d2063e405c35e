"""Animations that any program for slides plays: GIF, each picture with a palette of its own."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from npfm.storage.files import Kind, marked, replacing

COMMENT = b"npfm animation"
GIF = Kind("an animation", ".gif", marked(b"GIF89a", COMMENT))
COLORS = 255  # of a palette; one more stands for what stays as it is


def write_gif(
    path: str | Path,
    frames: Sequence[NDArray[np.uint8]],
    milliseconds: Sequence[int],
    dithered: bool,
) -> None:
    """Write display values as an animation that begins again when it ends.

    Parameters
    ----------
    path : str or Path
        The file to write.
    frames : sequence of ndarray of uint8, shape (height, width, 3)
        All of one size.
    milliseconds : sequence of int
        How long each is shown; the format has hundredths of a second.
    dithered : bool
        Whether colours that a palette lacks are mixed from its own: for pictures, whose shades
        would break into bands, and not for drawings.
    """
    first, *others = (_with_palette(frame, dithered) for frame in frames)
    with replacing(path, GIF) as temporary:
        first.save(
            temporary,
            format="GIF",
            save_all=True,
            append_images=others,
            duration=list(milliseconds),
            loop=0,
            comment=COMMENT,
        )


def _with_palette(frame: NDArray[np.uint8], dithered: bool) -> Image.Image:
    whole = Image.fromarray(frame)
    # The other methods lose rare bright colours, of highlights.
    chosen = whole.quantize(COLORS, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    if not dithered:
        return chosen
    return whole.quantize(COLORS, palette=chosen, dither=Image.Dither.FLOYDSTEINBERG)
