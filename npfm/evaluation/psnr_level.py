"""How the level of a PSNR hangs on what is compared: foreground, resolution, turn of the light.

The paper takes PSNR over "all foreground pixels, meaning pixels directly covered by an object"
(Bagher et al. 2016, section 5), and says nothing of pixels that objects cover in part. Here the
same fits are compared by several readings of that, and in scenes that are built in other ways.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.transport import Transport, columns, pictures

#: Builds of a scene that are read in more ways than one; others have their name for a setting.
CONFIGURED, ANTIALIASED = "configured", "antialiased"
#: The reading of every other table: pixels that objects cover entirely, in the scene as it is.
STANDARD = "as-configured"
#: The angle of view, in degrees, beyond which pixels are left out in one of the settings.
GRAZING = 80
LEFT_OUT = f"to-{GRAZING}-degrees"
COVERED_HALF, TOUCHED = "covered-half", "touched"
#: What stands for a scene in the averages over all of them.
ALL = "all"
MEASURED = "setting", "scene", "material", "variant", "psnr_db", "peak", "grazing_share"
LEVELS = "setting", "scene", "variant", "pictures", "psnr_db", "paper_db", "grazing_share"


@dataclass(frozen=True)
class Build:
    """A scene built in some way.

    Parameters
    ----------
    scene, way : str
        Its name, and how it is built: `CONFIGURED`, `ANTIALIASED`, or another name.
    folder : str
        Where ``npfm scene`` wrote it.
    angles : ndarray, shape (h, w), optional
        As `npfm.rendering.view_angles` gives them.
    """

    scene: str
    way: str
    folder: str
    angles: NDArray | None = None

    def foregrounds(self, matrix: Transport) -> dict[str, NDArray[np.bool_]]:
        """Which pixels are compared in each setting, shape (h, w)."""
        coverage = matrix.coverage
        if self.way == ANTIALIASED:
            return {
                ANTIALIASED: matrix.foreground,
                COVERED_HALF: coverage >= 0.5,
                TOUCHED: coverage > 0,
            }
        if self.way != CONFIGURED:
            return {self.way: matrix.foreground}
        if self.angles is None:
            return {STANDARD: matrix.foreground}
        if self.angles.shape != coverage.shape:
            raise NpfmError(
                f"{self.folder}: {coverage.shape[0]} pixels along one side, and the angles of view "
                f"are of {self.angles.shape[0]}; make those of this scene"
            )
        return {
            STANDARD: matrix.foreground,
            LEFT_OUT: matrix.foreground & (self.angles <= GRAZING),
        }


def measure(
    material: str, measured: Table, fits: Mapping[str, Table], builds: Sequence[Build]
) -> pd.DataFrame:
    """Compare the fits of a material with its measurement in every setting.

    Parameters
    ----------
    material : str
        Its name.
    measured : Table
    fits : mapping of str to Table
        By variant. As in ``npfm render``, cells of a fit without a measurement are black.
    builds : sequence of Build

    Returns
    -------
    DataFrame
        Columns `MEASURED`: `peak` is the largest radiance of the measurement's foreground, in the
        unit of the light; `grazing_share` the share of the squared error that is seen under more
        than `GRAZING` degrees, in the setting `STANDARD` of a scene whose angles are known.

    Raises
    ------
    NpfmError
        If a scene cannot be read, or is of another grid or size.
    """
    shown = columns([measured, *(fit.where_measured(measured) for fit in fits.values())])
    rows = []
    for build in builds:
        matrix = transport.load(build.folder)
        reference, *compared = pictures(matrix, shown)
        for setting, inside in build.foregrounds(matrix).items():
            if not inside.any():
                raise NpfmError(
                    f"{build.folder}: no pixel is foreground in the setting {setting}; build the "
                    "scene with more pixels"
                )
            peak = float(reference[inside].max())
            angles = build.angles if setting == STANDARD else None
            for variant, picture in zip(fits, compared, strict=True):
                level, _ = psnr_or_gap(picture, reference, inside)
                share = _grazing_share(picture - reference, inside, angles)
                rows.append((setting, build.scene, material, variant, level, peak, share))
    return pd.DataFrame(rows, columns=MEASURED)


def _grazing_share(
    error: NDArray[np.float32], inside: NDArray[np.bool_], angles: NDArray | None
) -> float:
    """Share of a squared error beyond `GRAZING`; NaN if nothing is known or nothing is wrong."""
    squared = np.where(inside, (error.astype(float) ** 2).sum(axis=-1), 0.0)
    total = squared.sum()
    if angles is None or not total > 0:
        return float("nan")
    return float(squared[angles > GRAZING].sum() / total)


def read(paths: Sequence[str]) -> pd.DataFrame:
    """Read what `measure` found of several materials; errors are those of `tables.read`."""
    found = [tables.read(path, MEASURED[:4], MEASURED[4:]) for path in paths]
    return pd.concat(found, ignore_index=True)


def read_levels(path: str) -> pd.DataFrame:
    """Read a table of `levels`; errors are those of `tables.read`."""
    return tables.read(path, LEVELS[:3], LEVELS[3:])


def levels(measured: pd.DataFrame, printed: Mapping[str, float]) -> pd.DataFrame:
    """Average over the materials, and over the scenes as well.

    Parameters
    ----------
    measured : DataFrame
        As `measure` makes it, of all materials.
    printed : mapping of str to float
        The paper's averages in dB by variant, over 100 materials and four scenes.

    Returns
    -------
    DataFrame
        Columns `LEVELS`, settings in their order, the scene ``all`` first: the number of pictures
        that have a finite PSNR, its mean, what the paper printed for that model in rows of ``all``,
        and the mean share of the squared error at grazing angles.
    """
    rows = []
    for setting, of_setting in measured.groupby("setting", sort=False):
        for scene, of_scene in _scenes(of_setting):
            for variant, found in of_scene.groupby("variant", sort=False):
                level, share = found["psnr_db"], found["grazing_share"]
                paper = printed.get(str(variant), np.nan) if scene == ALL else np.nan
                count = int(np.isfinite(level).sum())
                rows.append((setting, scene, variant, count, mean_db(level), paper, share.mean()))
    return pd.DataFrame(rows, columns=LEVELS)


def _scenes(measured: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    yield ALL, measured
    for scene, rows in measured.groupby("scene", sort=False):
        yield str(scene), rows
