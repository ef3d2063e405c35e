"""What effects cost and change: a table from records of scenes, and from pictures in them."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.accuracy_cost import columns, pictures
from npfm.evaluation.metrics import mean_db, psnr_or_gap
from npfm.reflectance.table import Table
from npfm.rendering import transport
from npfm.rendering.effects import EFFECTS
from npfm.rendering.transport import Transport

COLUMNS = (
    "scene", "effect", "on", "build_seconds", "rays", "nonzeros", "psnr_change_db", "picture_db"
)  # fmt: skip


@dataclass(frozen=True)
class Shown:
    """Pictures in one scene, float32: of measurements and of fits, shape (materials, h, w, 3)."""

    record: Mapping
    matrix: Transport
    measured: NDArray[np.float32]
    fitted: NDArray[np.float32]

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
    return Shown(_record(scene), matrix, *np.split(pictures(matrix, values), 2))


def _record(scene: str) -> dict:
    path = Path(f"{scene}.json")
    try:
        record = json.loads(path.read_text())
        return {key: record[key] for key in ("effects", "seconds", "rays", "nonzeros")}
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NpfmError(
            f"{path}: cannot be read as the record of a scene ({error}); "
            "build the scene again with npfm scene --record"
        ) from error


def compare(name: str, own: Shown, switched: Mapping[str, Shown]) -> pd.DataFrame:
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

    Returns
    -------
    DataFrame
        Columns `COLUMNS`, two rows an effect; other effects are as configured. psnr_change_db is
        the PSNR of fits less that without the effect; picture_db is the PSNR of the
        measurement's picture with that without the effect as the reference, over the pixels that
        objects cover entirely in both. Both are means over the materials (`mean_db`).
    """
    rows = []
    for effect in EFFECTS:
        pair = own, switched.get(effect, own)
        off, on = pair[::-1] if effect in own.record["effects"] else pair
        for is_on, shown in enumerate((off, on)):
            cost = (shown.record[key] for key in ("seconds", "rays", "nonzeros"))
            change = mean_db(_gain(shown.psnr_db, off.psnr_db)), mean_db(shown.against(off))
            rows.append((name, effect, is_on, *cost, *change))
    return pd.DataFrame(rows, columns=COLUMNS)


def _gain(after: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """Difference of decibels; 0 where both are infinite."""
    equal = after == before
    return np.where(equal, 0.0, after - np.where(equal, 0.0, before))
