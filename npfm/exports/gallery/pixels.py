"""Pictures of linear radiance, packed into a page, and small ones beside it."""

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from npfm.exports.gallery.kinds import COMMENT, THUMBNAILS
from npfm.storage.files import replacing

#: Half-precision floats end at 65504; a power of two below it loses no digit of what is scaled.
LARGEST = 2.0**15
THUMBNAIL = 96  # pixels along one side of a small picture
QUALITY = 85  # of JPEG


@dataclass(frozen=True)
class Packed:
    """The pictures of a scene.

    Parameters
    ----------
    content : bytes
        A zlib stream: a byte each pixel, whether any picture differs there from the first; the
        high and then the low bytes of the first picture, channel by channel; those of the
        others at the pixels that differ, as differences from the first, modulo 2^16, of the
        words of half-precision floats.
    scale : float
        What the floats were divided by, a power of two.
    height, width : int
    """

    content: bytes
    scale: float
    height: int
    width: int


def pack(pictures: Sequence[NDArray[np.float32]]) -> Packed:
    """Pack pictures that are flipped in one place, the measurement first.

    Half precision keeps a value to 0.05 %. Behind the objects all pictures are the same and are
    kept once; where they are alike, so are their words.

    Parameters
    ----------
    pictures : sequence of ndarray, shape (height, width, 3)
        Linear radiance, all of one size.
    """
    stacked = np.stack(pictures)
    finite = np.abs(stacked[np.isfinite(stacked)])
    scale = 2.0 ** max(0, math.ceil(math.log2(finite.max(initial=1.0) / LARGEST)))
    words = (stacked / np.float32(scale)).astype("<f2").view("<u2")
    words = words.reshape(len(words), -1, 3)
    differs = (words[1:] != words[0]).any(axis=(0, 2))
    changes = (words[1:, differs] - words[0, differs]).astype("<u2")
    parts = [differs.astype(np.uint8).tobytes(), _planes(words[:1]), _planes(changes)]
    height, width = stacked.shape[1:3]
    return Packed(zlib.compress(b"".join(parts), 9), scale, height, width)


def _planes(words: NDArray[np.uint16]) -> bytes:
    """High bytes and then low bytes of pictures, shape (pictures, pixels, 3), by channel."""
    by_channel = np.moveaxis(words, -1, 1)
    return b"".join(part.astype(np.uint8).tobytes() for part in (by_channel >> 8, by_channel & 255))


def write_thumbnails(path: str | Path, rows: Sequence[Sequence[NDArray[np.uint8]]]) -> None:
    """Write small pictures side by side as one JPEG file.

    Parameters
    ----------
    path : str or Path
        The file to write.
    rows : sequence of sequence of ndarray of uint8, shape (height, width, 3)
        Display values.
    """
    sheet = Image.new("RGB", (THUMBNAIL * max(map(len, rows)), THUMBNAIL * len(rows)))
    for y, row in enumerate(rows):
        for x, pixels in enumerate(row):
            sheet.paste(_small(pixels), (x * THUMBNAIL, y * THUMBNAIL))
    with replacing(path, THUMBNAILS) as temporary:
        sheet.save(temporary, format="JPEG", quality=QUALITY, comment=COMMENT)


def _small(pixels: NDArray[np.uint8]) -> Image.Image:
    finer = min(pixels.shape[:2]) >= THUMBNAIL
    sampling = Image.Resampling.LANCZOS if finer else Image.Resampling.NEAREST
    return Image.fromarray(pixels).resize((THUMBNAIL, THUMBNAIL), sampling)
