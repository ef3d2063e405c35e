"""Measured materials of Mitsuba 3, for its variants with three channels."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.exports.measured_material import Measured, measured
from npfm.exports.sources import Source
from npfm.storage.files import Kind, marked
from npfm.storage.tensor_files import MAGIC, write_arrays

NAME = "bsdf"
ABOUT = "a measured material of Mitsuba 3, for its variants *_rgb"
SUFFIX = ".bsdf"
TABLES = True
SETTINGS = {
    "views": "elevations of the view (default: 16)",
    "size": "points along theta_h and phi_h for each (default: 64)",
}
#: What stands in the description of every file of npfm.
MARK = "written by npfm"
KIND = Kind("a measured material", SUFFIX, marked(MAGIC, MARK.encode()))
VIEWS, SIZE = 16, 64
#: From a file of 20 kB to one of 280 MB.
LEAST, MOST_VIEWS, MOST_SIZE = 4, 90, 512


def write(path: str, sources: Sequence[Source], views: int = VIEWS, size: int = SIZE) -> str:
    """Write a material with the field `rgb`; what is written, in a line.

    Parameters
    ----------
    path : str
        Ends in ``.bsdf``.
    sources : sequence of Source
        One, on a half-difference grid.
    views, size : int
        Elevations of the view, and points along a side of the square of each.
    """
    [source] = sources
    found = resampled(source, views, size)
    made = fields(found, source.name)
    write_arrays(path, KIND, made | {"rgb": found.reflected.astype(np.float32)[None]})
    return said(views, size)


def resampled(source: Source, views: int, size: int) -> Measured:
    """Resample what a source says.

    Raises
    ------
    NpfmError
        If there are fewer views or points than make sense, or more.
    """
    for name, number, most in (("views", views, MOST_VIEWS), ("size", size, MOST_SIZE)):
        if not LEAST <= number <= most:
            raise NpfmError(f"--{name} {number}: give a number from {LEAST} to {most}")
    return measured(source.table, views, size)


def fields(found: Measured, name: str) -> dict[str, NDArray]:
    """Fields but for the colours, as Mitsuba and pbrt want them."""
    text = f"{name}, {MARK}"
    return {
        "description": np.frombuffer(text.encode(), dtype=np.uint8),
        "phi_i": np.zeros(1, dtype=np.float32),
        "theta_i": found.theta_i.astype(np.float32),
        "ndf": found.ndf.astype(np.float32),
        "sigma": found.sigma.astype(np.float32),
        "vndf": found.vndf.astype(np.float32)[None],
        "luminance": found.luminance.astype(np.float32)[None],
        "jacobian": np.ones(1, dtype=np.uint8),
    }


def said(views: int, size: int) -> str:
    """What was written, in a line."""
    return f"{views} views of {size} x {size} points"
