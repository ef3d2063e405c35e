"""A material and its fits in a light that is turned around them, picture by picture.

The supplemental video of Bagher et al. 2016 compares renderings "when the light or view rotate
continuously" (section 6). A turn of the light is a scene of its own, built once for all materials.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation.metrics import psnr_or_gap
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.transport import columns, pictures
from npfm.storage.pictures import read_exr_parts, write_exr_parts

MEASURED = "measured"
AGAIN = "make it again with npfm video frames"


@dataclass(frozen=True)
class Turned:
    """Pictures of a material and of fits of it, by the turn of the light.

    Parameters
    ----------
    degrees : tuple of float
        By which the light is turned.
    names : tuple of str
        The measurement, and the fits.
    radiance : ndarray, shape (turns, names, h, w, 3)
        Linear radiance.
    coverage : ndarray, shape (h, w)
        Share of a pixel that objects cover.
    """

    degrees: tuple[float, ...]
    names: tuple[str, ...]
    radiance: NDArray[np.float32]
    coverage: NDArray[np.float32]

    def psnr(self) -> NDArray[np.float64]:
        """PSNR of each fit against the measurement in the same light, shape (turns, fits)."""
        inside = self.coverage == 1
        return np.array(
            [
                [psnr_or_gap(picture, measured, inside)[0] for picture in others]
                for measured, *others in self.radiance
            ]
        )


def render(measured: Table, fits: Mapping[str, Table], scenes: Sequence[str | Path]) -> Turned:
    """Render a measurement and fits of it in every turn.

    Parameters
    ----------
    measured : Table
    fits : mapping of str to Table
        By variant; where there is no measurement they reflect nothing, as in other pictures.
    scenes : sequence of str or Path
        Folders of scenes that differ in the turn of the light, named by its degrees.

    Raises
    ------
    NpfmError
        If a scene is not named so or is none, differs in its objects, or a table is on another
        grid.
    """
    values = columns([measured, *(fit.where_measured(measured) for fit in fits.values())])
    degrees = tuple(_degrees(Path(scene).name, scene) for scene in scenes)
    coverage, made = np.array(transport.load(scenes[0]).coverage), []
    for scene in scenes:
        matrix = transport.load(scene)
        if not np.array_equal(coverage, matrix.coverage):
            raise NpfmError(f"{scene}: other objects than in {scenes[0]}; build both of the same")
        made.append(pictures(matrix, values))
    return Turned(degrees, (MEASURED, *fits), np.stack(made), coverage)


def write(path: str | Path, turned: Turned) -> None:
    """Write the pictures as parts of one OpenEXR file, the coverage as their alpha."""
    parts = {
        f"{degrees:g} {name}": np.dstack([picture, turned.coverage])
        for degrees, pictures in zip(turned.degrees, turned.radiance, strict=True)
        for name, picture in zip(turned.names, pictures, strict=True)
    }
    write_exr_parts(path, parts)


def read(path: str | Path) -> Turned:
    """Read what `write` wrote.

    Raises
    ------
    NpfmError
        If the file is absent or damaged, or has other pictures.
    """
    parts = read_exr_parts(path)
    heads = [name.partition(" ") for name in parts]
    degrees = tuple(dict.fromkeys(_degrees(turn, path) for turn, _, _ in heads))
    names = tuple(dict.fromkeys(name for _, _, name in heads))
    wanted = [f"{turn:g} {name}" for turn in degrees for name in names]
    shapes = {picture.shape for picture in parts.values()}
    if wanted != list(parts) or names[:1] != (MEASURED,) or len(shapes) > 1:
        raise NpfmError(f"{path}: not pictures of every fit in every turn of a light; {AGAIN}")
    stacked = np.stack(list(parts.values())).reshape(len(degrees), len(names), *shapes.pop())
    if stacked.shape[-1] != 4:
        raise NpfmError(f"{path}: pictures without alpha; {AGAIN}")
    return Turned(degrees, names, stacked[..., :3], stacked[0, 0, ..., 3])


def _degrees(text: str, path: str | Path) -> float:
    try:
        degrees = float(text)
    except ValueError:
        degrees = float("nan")
    if not -360 <= degrees <= 360:
        raise NpfmError(f"{path}: '{text}' is no turn of a light in degrees; name the scene by it")
    return degrees
