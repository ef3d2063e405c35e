"""What effects cost and change: a table from records of scenes, and from pictures in them.

Switching most effects gives another transport matrix. Light that bounces is in none: it is added to
the pictures of the scene as it is, for each material anew.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.effects import EFFECTS
from npfm.rendering.transport import Transport, columns, pictures
from npfm.storage.pictures import read_exr

COLUMNS = (
    "scene", "effect", "on", "build_seconds", "rays", "nonzeros", "picture_seconds",
    "psnr_change_db", "picture_db",
)  # fmt: skip


@dataclass(frozen=True)
class Shown:
    """Pictures in one scene, float32: of measurements and of fits, shape (materials, h, w, 3).

    What is added to those of the matrix took `picture_seconds` of CPU time for each.
    """

    record: Mapping
    matrix: Transport
    measured: NDArray[np.float32]
    fitted: NDArray[np.float32]
    picture_seconds: float = 0.0

    def brighter(self, bounced: "Bounced") -> "Shown":
        """Return the scene with the light that bounces in it."""
        return replace(
            self,
            measured=self.measured + bounced.measured,
            fitted=self.fitted + bounced.fitted,
            picture_seconds=bounced.seconds,
        )

    @property
    def psnr_db(self) -> NDArray[np.float64]:
        """PSNR of each fit, NaN where it has none, shape (materials,)."""
        pairs = zip(self.fitted, self.measured, strict=True)
        return np.array([psnr_or_gap(*pair, self.matrix.foreground)[0] for pair in pairs])

    def against(self, other: "Shown") -> NDArray[np.float64]:
        """PSNR of each measurement's picture with that in another scene as the reference."""
        foreground = self.matrix.foreground & other.matrix.foreground
        pairs = zip(self.measured, other.measured, strict=True)
        return np.array([psnr_or_gap(*pair, foreground)[0] for pair in pairs])


@dataclass(frozen=True)
class Bounced:
    """Light that bounces: radiance as `Shown` has it, and mean CPU seconds of a picture."""

    measured: NDArray[np.float32]
    fitted: NDArray[np.float32]
    seconds: float


def read(paths: Sequence[str]) -> pd.DataFrame:
    """Read the table from the files it was written to; errors are those of `tables.read`."""
    found = [tables.read(path, COLUMNS[:2], COLUMNS[2:]) for path in paths]
    return pd.concat(found, ignore_index=True).astype({"on": int, "rays": int, "nonzeros": int})


def show(scene: str, materials: Sequence[tuple[Table, Table]]) -> Shown:
    """Render measurements and fits in a scene.

    Parameters
    ----------
    scene : str
        Folder of the scene; the record of its making is in a ``.json`` beside it.
    materials : sequence of (Table, Table)
        Measurement and fit of each material. As in ``npfm render``, cells of a fit without a
        measurement are black.

    Raises
    ------
    NpfmError
        If the scene or its record cannot be read.
    """
    shown = [m for m, _ in materials] + [fit.where_measured(m) for m, fit in materials]
    values = columns(shown)
    matrix = transport.load(scene)
    measured, fitted = np.split(pictures(matrix, values), 2)
    return Shown(_record(scene), matrix, measured, fitted)


def bounced(tables: Sequence[str], fits: Sequence[str]) -> Bounced:
    """Read light that bounces off measurements and off fits.

    Parameters
    ----------
    tables, fits : sequence of str
        Pictures of ``npfm interreflect``, of each material; the record of its making is in a
        ``.json`` beside each.

    Raises
    ------
    NpfmError
        If a picture or its record cannot be read.
    """
    measured, fitted = (np.stack([read_exr(p)[..., :3] for p in paths]) for paths in (tables, fits))
    verb = "render the light again with npfm interreflect --record"
    records = [_read(Path(path).with_suffix(".json"), ("seconds",), verb) for path in tables]
    return Bounced(measured, fitted, float(np.mean([record["seconds"] for record in records])))


def _record(scene: str) -> dict:
    verb = "build the scene again with npfm scene --record"
    return _read(Path(f"{scene}.json"), ("effects", "seconds", "rays", "nonzeros"), verb)


def _read(path: Path, keys: Sequence[str], verb: str) -> dict:
    try:
        record = json.loads(path.read_text())
        return {key: record[key] for key in keys}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NpfmError(f"{path}: cannot be read as the record of it ({error}); {verb}") from error


def compare(
    name: str,
    own: Shown,
    switched: Mapping[str, Shown],
    bounced: Bounced | None = None,
    *,
    bounces: bool = False,
) -> pd.DataFrame:
    """Compare a scene with itself, each effect switched off and on.

    Parameters
    ----------
    name : str
        Of the scene.
    own : Shown
        The scene as it is configured.
    switched : mapping of str to Shown
        The scene with one effect switched, by the effect. An effect that is not there changes
        nothing in this scene: off and on are the same scene.
    bounced : Bounced, optional
        Light that bounces in it; without it, that is an effect that changes nothing.
    bounces : bool
        Whether the scene is configured with that light: then it is in the pictures with any other
        effect switched, the same in all.

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, two rows an effect; other effects are as configured. picture_seconds is
        the CPU time of what is added to a picture. psnr_change_db is the PSNR of fits less that
        without the effect; picture_db is the PSNR of the measurement's picture with that without
        the effect as the reference, over the pixels that objects cover entirely in both. Both are
        means over the materials (`mean_db`).
    """
    lit = own.brighter(bounced) if bounced else own
    rows = []
    for effect, kind in EFFECTS.items():
        if kind.bounces:
            off, on = own, lit
        else:
            pair = [own, switched.get(effect, own)]
            if bounced and bounces:
                pair = [shown.brighter(bounced) for shown in pair]
            off, on = pair[::-1] if effect in own.record["effects"] else pair
        for is_on, shown in enumerate((off, on)):
            cost = (shown.record[key] for key in ("seconds", "rays", "nonzeros"))
            change = mean_db(_gain(shown.psnr_db, off.psnr_db)), mean_db(shown.against(off))
            rows.append((name, effect, is_on, *cost, shown.picture_seconds, *change))
    return pd.DataFrame(rows, columns=COLUMNS)


def _gain(after: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """Difference of decibels; 0 where both are infinite."""
    equal = after == before
    return np.where(equal, 0.0, after - np.where(equal, 0.0, before))
