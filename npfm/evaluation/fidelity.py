"""How true fits are to tables and to pictures, under two peaks: Figure 4 of Peng et al. 2017.

That paper speaks of "the standard PSNR" and names no peak. Two are told here. One is the largest
value of the reference, as everywhere in this project. The other is 255 where the mean of the
reference is 1: what 8-bit pictures are compared by, on values that are not rounded.
"""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.evaluation.comparison import read_reference
from npfm.evaluation.metrics import mean_db
from npfm.reflectance.table import Table

#: The largest value of 8-bit pictures.
PEAK_8_BIT = 255.0
COLUMNS = (
    "material",
    "variant",
    "rendering_db",
    "rendering_8_bit_db",
    "numerical_db",
    "numerical_8_bit_db",
)


def numerical_psnr(table: Table, measured: Table) -> tuple[float, float]:
    """PSNR in dB of a table, over all channels and all cells that are measured, by both peaks.

    Infinite where nothing differs, NaN where the measurement is black.
    """
    inside = measured.valid
    wanted = measured.values[inside]
    error = np.mean((table.where_measured(measured).values[inside] - wanted) ** 2)
    largest, eight_bit = peaks(wanted)
    if largest <= 0:
        return float("nan"), float("nan")
    if error == 0:
        return float("inf"), float("inf")
    noise = 10 * np.log10(error)
    return float(20 * np.log10(largest) - noise), float(20 * np.log10(eight_bit) - noise)


def peaks(wanted: NDArray) -> tuple[float, float]:
    """The largest value of a reference, and 255 in units of its mean."""
    return float(wanted.max()), PEAK_8_BIT * float(wanted.mean())


def fidelity(
    run: str | Path,
    psnr: pd.DataFrame,
    measured: Mapping[str, str | Path],
    read: Callable[[str | Path], Table],
) -> pd.DataFrame:
    """Gather the PSNR of pictures and of tables.

    Parameters
    ----------
    run : str or Path
        Folder that holds ``renders/<scene>/<material>/measured.exr`` and
        ``fits/<variant>/<material>.npz``.
    psnr : DataFrame
        Columns scene, material, variant, psnr_db; what it lists counts.
    measured : mapping of str to (str or Path)
        Files of the measured tables, by material.
    read : callable
        Gives the table of a measurement or of a fit at a path.

    Returns
    -------
    DataFrame
        `COLUMNS`, in dB: renderings are the mean over the scenes.
    """
    rows = []
    for material, of_material in psnr.groupby("material", sort=False):
        table = read(measured[str(material)])
        higher = of_material["scene"].map(lambda scene, m=material: _headroom(run, scene, m))
        for variant, found in of_material.groupby("variant", sort=False):
            pictures = found["psnr_db"], found["psnr_db"] + higher[found.index]
            fit = read(Path(run) / "fits" / str(variant) / f"{material}.npz")
            numbers = *map(mean_db, pictures), *numerical_psnr(fit, table)
            rows.append((material, variant, *numbers))
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _headroom(run: str | Path, scene: str, material: str) -> float:
    """How many dB more a picture has by the other peak."""
    radiance, foreground = read_reference(Path(run) / "renders" / scene / material / "measured.exr")
    largest, eight_bit = peaks(radiance[foreground].astype(np.float64))
    # A black picture has a PSNR by neither.
    return float(20 * np.log10(eight_bit / largest)) if largest > 0 else float("nan")
