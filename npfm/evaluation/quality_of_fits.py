"""Fits compared with the measurement by every metric of `npfm.evaluation.quality`."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import perceived, quality
from npfm.evaluation.comparison import check_windows, read_reference
from npfm.evaluation.metrics import NoPSNR, psnr
from npfm.evaluation.table_distances import distances
from npfm.reflectance.table import Table
from npfm.storage.pictures import read_exr, read_png


def compare(reference: str | Path, pictures: Sequence[str | Path]) -> list[dict[str, float]]:
    """Compare pictures on disk with one reference, by every metric of pictures.

    Parameters
    ----------
    reference : str or Path
        EXR of linear radiance, its tone-mapped PNG beside it, as ``npfm render`` writes them.
    pictures : sequence of str or Path
        Of the same size.

    Returns
    -------
    list of dict of str to float
        By the names in `quality.PICTURES`; NaN where the values of a picture have no such number.

    Raises
    ------
    NpfmError
        If a file is missing, cannot be read or cannot be compared.
    """
    measured, foreground = read_reference(reference)
    if not foreground.any():
        raise NpfmError(f"{reference}: no pixel that an object covers; nothing can be compared")
    wanted = _shown(reference, measured.shape)
    found = []
    for path in pictures:
        check_windows(reference, path)
        radiance, displayed = read_exr(path)[..., :3], _shown(path, measured.shape)
        seen = perceived.shown(displayed, wanted, foreground)
        for name, function in (("psnr", psnr), ("hdr-flip", perceived.hdr_flip)):
            seen[name] = _or_gap(function, radiance, measured, foreground)
        # Where radiance is not finite the display values are made up.
        sound = np.isfinite(radiance[foreground]).all() and np.isfinite(measured[foreground]).all()
        found.append({name: seen[name] if sound else float("nan") for name in quality.PICTURES})
    return found


def _shown(path: str | Path, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """The tone-mapped picture beside one of radiance, of `shape`."""
    beside = Path(path).with_suffix(".png")
    picture = read_png(beside)
    if picture.shape != shape:
        raise NpfmError(f"{beside}: of another size than the measurement's; render it again")
    return picture


def _or_gap(function: Callable[..., float], *pictures: NDArray) -> float:
    try:
        return function(*pictures)
    except NoPSNR:
        return float("nan")


def material(
    run: str | Path,
    scenes: Sequence[str],
    measured: str | Path,
    variants: Sequence[str],
    tabulate: Callable[[str | Path], Table],
) -> pd.DataFrame:
    """Compare all fits of one material with its measurement, by every metric.

    Parameters
    ----------
    run : str or Path
        Folder that holds ``renders/<scene>/<material>/<variant>.exr`` and ``.png``, those of
        ``measured``, and ``fits/<variant>/<material>.npz``.
    scenes, variants : sequence of str
        What counts.
    measured : str or Path
        File of the measured table; its name without the suffix is the material's.
    tabulate : callable
        Gives the table in a file.

    Returns
    -------
    DataFrame
        Columns `quality.COLUMNS`; the scene of a distance of tables is `quality.ALL`.

    Raises
    ------
    NpfmError
        If a file is missing, cannot be read or cannot be compared.
    """
    rows, name = [], Path(measured).stem
    for scene in scenes:
        folder = Path(run) / "renders" / scene / name
        found = compare(folder / "measured.exr", [folder / f"{v}.exr" for v in variants])
        for variant, values in zip(variants, found, strict=True):
            rows += _rows((scene, name, variant), values)
    table = tabulate(measured)
    for variant in variants:
        fitted = tabulate(Path(run) / "fits" / variant / f"{name}.npz")
        rows += _rows((quality.ALL, name, variant), distances(fitted, table))
    return pd.DataFrame(rows, columns=quality.COLUMNS)


def _rows(head: tuple[str, ...], values: Mapping[str, float]) -> list[tuple]:
    found = ((name, value, quality.METRICS[name]) for name, value in values.items())
    return [(*head, name, value, metric.unit, metric.better) for name, value, metric in found]
