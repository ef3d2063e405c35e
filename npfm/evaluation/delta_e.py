"""Mean colour-difference images over the materials of a run (Dupuy et al. 2015, Figure 3)."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation.comparison import read_reference
from npfm.evaluation.metrics import delta_e
from npfm.storage.pictures import read_png

#: The variant that all others are compared with.
MEASURED = "measured"


def mean_images(
    measured: str | Path, folders: Mapping[str, str | Path], materials: Sequence[str]
) -> tuple[dict[str, NDArray[np.float64]], pd.DataFrame]:
    """Compare tone-mapped pictures of fits with those of the measurements.

    Parameters
    ----------
    measured : str or Path
        Folder of a scene: it holds ``<material>/measured.exr`` and ``.png``.
    folders : mapping of str to (str or Path)
        For each variant the folder that holds ``<material>/<variant>.png``. A material that has
        no such picture has no fit, and is left out of the variant's mean.
    materials : sequence of str
        What counts.

    Returns
    -------
    images : dict of str to ndarray, shape (height, width)
        CIEDE2000 in the mean over the materials; NaN outside the objects.
    table : DataFrame
        Columns material, variant, delta_e: the mean over the objects' pixels of each picture.

    Raises
    ------
    NpfmError
        If a picture of a measurement is missing, or no picture of a variant is there.
    """
    references = {name: _reference(Path(measured) / name) for name in materials}
    images, rows = {}, []
    for variant, folder in folders.items():
        paths = {name: Path(folder) / name / f"{variant}.png" for name in materials}
        found = {name: path for name, path in paths.items() if path.is_file()}
        if not found:
            raise NpfmError(f"{folder}: no picture of '{variant}'; make them with npfm render")
        differences = [_difference(path, *references[name]) for name, path in found.items()]
        images[variant] = np.mean(differences, axis=0)
        means = [float(np.nanmean(difference)) for difference in differences]
        rows += [(name, variant, mean) for name, mean in zip(found, means, strict=True)]
    return images, pd.DataFrame(rows, columns=["material", "variant", "delta_e"])


def _reference(folder: Path) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """Display values of a measurement, and where the objects are."""
    _, foreground = read_reference(folder / f"{MEASURED}.exr")
    return read_png(folder / f"{MEASURED}.png"), foreground


def _difference(path: Path, measured: NDArray, foreground: NDArray) -> NDArray[np.float64]:
    pixels = read_png(path)
    if pixels.shape != measured.shape:
        raise NpfmError(f"{path}: of another size than the measurement's picture; render it again")
    return np.where(foreground, delta_e(pixels, measured), np.nan)
