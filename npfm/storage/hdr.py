"""Radiance pictures (``.hdr``, ``.pic``), read as their format says.

G. Ward, "Radiance File Formats", https://radsite.lbl.gov/radiance/refer/filefmts.pdf: a header of
lines, a line that tells size and orientation, and scanlines of pixels of four bytes, the mantissas
of red, green and blue and their common exponent, in one of three encodings.
"""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.bounds import check_size

#: How a Radiance picture begins, whichever program wrote it.
MAGIC = b"#?"
FORMAT = "32-bit_rle_rgbe"
#: No line of a header is longer, nor has a header more bytes: views and commands are short.
LINE_BYTES, HEADER_BYTES = 2**12, 2**16
RESOLUTION = re.compile(r"([-+])([XY]) +(\d{1,10}) +([-+])(?!\2)([XY]) +(\d{1,10})")
#: Lengths of scanlines that may have run lengths channel by channel.
SHORTEST, LONGEST = 8, 0x7FFF
#: Mantissas have eight bits, and exponents an excess of 128.
EXCESS = 128 + 8


class _Damaged(Exception):
    """The scanlines end too early, or are none."""


def read(path: Path) -> NDArray[np.float32]:
    """Read a Radiance picture.

    Stored values are divided by all ``EXPOSURE`` and ``COLORCORR`` of the header, which gives
    radiance back; the picture is turned to stand upright.

    Parameters
    ----------
    path : Path
        The file.

    Returns
    -------
    ndarray of float32, shape (height, width, 3)
        Linear RGB; row 0 is the top.

    Raises
    ------
    NpfmError
        If the file is damaged, too large, or holds something else than linear RGB.
    """
    with path.open("rb") as file:
        factor = _factor(path, _header(path, file))
        line = _line(file)
        found = RESOLUTION.fullmatch(line)
        if not found:
            raise NpfmError(f"{path}: '{line[:40]}' where its size belongs; copy the file again")
        sizes = int(found[3]), int(found[6])
        extent = {found[2]: sizes[0], found[5]: sizes[1]}
        check_size(path, extent["X"], extent["Y"])
        # No encoding is longer than a length before every value.
        body = file.read(sizes[0] * (8 * sizes[1] + 4))
    try:
        stored = _scanlines(body, *sizes)
    except _Damaged:
        raise NpfmError(f"{path}: cut off or damaged; copy or make the file again") from None
    exponent = stored[..., 3:].astype(np.int32) - EXCESS
    scale = np.where(stored[..., 3:] > 0, np.ldexp(np.float32(1), exponent), np.float32(0))
    upright = _upright(stored[..., :3] * scale, {found[2]: found[1], found[5]: found[4]})
    return upright if (factor == 1).all() else (upright / factor).astype(np.float32)


def _header(path: Path, file: BinaryIO) -> list[tuple[str, str]]:
    """Variables of the header, in order; lines of pictures that went into it are indented."""
    variables = []
    while line := _line(file):
        name, _, value = line.partition("=")
        variables.append((name, value.strip()))
        if file.tell() > HEADER_BYTES:
            raise NpfmError(f"{path}: the header has no end; copy or make the file again")
    return variables


def _line(file: BinaryIO) -> str:
    return file.readline(LINE_BYTES).decode("latin-1").rstrip("\r\n")


def _factor(path: Path, header: Iterable[tuple[str, str]]) -> NDArray[np.float64]:
    """What radiance was multiplied by, shape (3,); refuse values that are no linear RGB."""
    factor = np.ones(3)
    for name, value in header:
        if name == "FORMAT" and value != FORMAT:
            raise NpfmError(
                f"{path}: FORMAT={value}; only {FORMAT} holds red, green and blue: convert the "
                "picture (from XYZ with Radiance's ra_xyze -r)"
            )
        if name in ("EXPOSURE", "COLORCORR", "GAMMA"):
            numbers = _numbers(value)
            if len(numbers) not in ((3,) if name == "COLORCORR" else (1,)):
                raise NpfmError(f"{path}: {name}={value} has no meaning; mend the header")
            if name == "GAMMA" and (numbers != 1).any():
                raise NpfmError(f"{path}: GAMMA={value}; values must be linear: convert it")
            factor *= numbers
    return factor


def _numbers(text: str) -> NDArray[np.float64]:
    """The numbers in a line, all above 0 and finite, or none."""
    try:
        numbers = np.array([float(word) for word in text.split()])
    except ValueError:
        return np.empty(0)
    return numbers if ((numbers > 0) & np.isfinite(numbers)).all() else np.empty(0)


def _upright(pixels: NDArray, signs: dict[str, str]) -> NDArray:
    """Turn scanlines into rows from the top; the axis named first runs over the scanlines."""
    if next(iter(signs)) == "X":
        pixels = pixels.swapaxes(0, 1)
    rows = slice(None, None, -1 if signs["Y"] == "+" else 1)
    columns = slice(None, None, -1 if signs["X"] == "-" else 1)
    return np.ascontiguousarray(pixels[rows, columns])


def _scanlines(body: bytes, count: int, length: int) -> NDArray[np.uint8]:
    """Decode the scanlines, shape (count, length, 4)."""
    pixels, at = np.empty((count, length, 4), dtype=np.uint8), 0
    start = bytes([2, 2, length >> 8, length & 255]) if SHORTEST <= length <= LONGEST else None
    for row in pixels:
        if start and body[at : at + 4] == start:
            at = _runs_by_channel(body, at + 4, row)
        else:
            at = _runs_of_pixels(body, at, row)
    return pixels


def _runs_by_channel(body: bytes, at: int, row: NDArray[np.uint8]) -> int:
    """Decode a scanline of one channel after the other; return where the next begins."""
    for channel in range(4):
        values, filled = bytearray(), 0
        while filled < len(row):
            if at + 1 >= len(body):
                raise _Damaged
            count = body[at]
            if count > 128:
                count -= 128
                values += body[at + 1 : at + 2] * count
                at += 2
            else:
                values += body[at + 1 : at + 1 + count]
                at += 1 + count
            filled += count
            if count == 0 or len(values) != filled or filled > len(row):
                raise _Damaged
        row[:, channel] = np.frombuffer(values, dtype=np.uint8)
    return at


def _runs_of_pixels(body: bytes, at: int, row: NDArray[np.uint8]) -> int:
    """Decode a scanline of pixels, where (1, 1, 1, n) repeats the one before n times.

    Repetitions in a row are the digits of a larger count, the lowest first.
    """
    there = min(len(row), (len(body) - at) // 4)
    flat = np.frombuffer(body, dtype=np.uint8, count=4 * there, offset=at).reshape(-1, 4)
    if there == len(row) and not (flat[:, :3] == 1).all(axis=1).any():
        row[:] = flat
        return at + 4 * there
    filled = shift = 0
    while filled < len(row):
        pixel = body[at : at + 4]
        at += 4
        repeats = pixel[:3] == b"\1\1\1"
        count = pixel[3] << shift if repeats and len(pixel) == 4 else 1
        if len(pixel) < 4 or filled + count > len(row) or (repeats and not filled):
            raise _Damaged
        row[filled : filled + count] = row[filled - 1] if repeats else tuple(pixel)
        filled += count
        shift = shift + 8 if repeats else 0
    return at
