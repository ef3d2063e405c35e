"""Measured materials of pbrt-v4, and of Mitsuba 3 for its variants with wavelengths.

Neither reads the file of the other kind of variants (`npfm.exports.bsdf`). Tables have three
channels: their spectra are sums of three that are smooth, from 0 to 1, together 1, and red, green
and blue of linear sRGB in the light D65.
"""

from collections.abc import Sequence

import numpy as np

from npfm.exports import bsdf
from npfm.exports.bsdf import SIZE, VIEWS, fields, resampled, said
from npfm.exports.sources import Source
from npfm.storage.tensor_files import write_arrays

NAME = "bsdf-spectral"
ABOUT = "a measured material of pbrt-v4, and of Mitsuba 3 for its variants *_spectral"
SUFFIX = ".bsdf"
TABLES = True
SETTINGS = {
    "views": "elevations of the view (default: 16)",
    "size": "points along theta_h and phi_h for each (default: 64)",
}
KIND = bsdf.KIND
#: In nm; beyond the ends readers keep what is there.
WAVELENGTHS = np.arange(400, 701, 20)
#: Spectra of least squared second differences under which the CIE 1931 observer sees the primaries
#: of sRGB in D65, to four digits; blue is what is left.
RED = [
    *(0.1909, 0.0959, 0.0109, 0, 0, 0, 0, 0),
    *(0, 0.1378, 0.7939, 1, 1, 1, 1, 1),
]
GREEN = [
    *(0, 0, 0, 0, 0.2575, 0.7507, 1, 1),
    *(1, 0.7893, 0.2041, 0, 0, 0, 0, 0),
]
PRIMARIES = np.stack([RED, GREEN, 1 - np.array(RED) - np.array(GREEN)])


def write(path: str, sources: Sequence[Source], views: int = VIEWS, size: int = SIZE) -> str:
    """Write a material with the fields `spectra` and `wavelengths`; what is written, in a line.

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
    spectra = np.einsum("vcyx,cw->vwyx", found.reflected, PRIMARIES)
    made = fields(found, source.name)
    made["wavelengths"] = WAVELENGTHS.astype(np.float32)
    made["spectra"] = spectra.astype(np.float32)[None]
    write_arrays(path, KIND, made)
    return f"{said(views, size)}, {WAVELENGTHS.size} wavelengths"
