"""The demo: materials of a run in its lights, rendered by the browser itself.

Figure 16 of Bagher et al. 2016: light directions are chosen by multiple importance sampling, and
the BRDF is evaluated from its factors, which are a texture. The functions of GLSL are those that
``npfm export --to glsl`` writes (`npfm.exports.shaders`).
"""

import json
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.exports.gallery import page
from npfm.exports.gallery.kinds import TABLE, TABLE_START
from npfm.exports.gallery.lights import coarse
from npfm.exports.gallery.material import Scene
from npfm.exports.shaders.shader import FOLDER, MODELS, Shader, shader
from npfm.fitting import fits
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering.lights import environment
from npfm.rendering.scenes import CAMERA
from npfm.storage.files import replacing

#: More would make a page of tens of megabytes.
MOST_MATERIALS = 200
#: Models whose roughness the page can edit, as ``npfm edit`` does.
EDITABLE = ("power-iteration", "ggx", "ggx-fitted")
#: Half-precision floats end at 65504; a power of two below it loses no digit of what is scaled.
LARGEST = 2.0**15


@dataclass(frozen=True)
class _Variant:
    """Fits of a variant: their rows, and what all of them are compiled with."""

    materials: list[str]
    shaders: list[Shader]
    model: str


def write(
    path: str | Path,
    name: str,
    run: str | Path,
    scenes: Sequence[tuple[Scene, str]],
    made: pd.DataFrame,
    measured: Sequence[str],
    *,
    figure: bool = False,
) -> None:
    """Write the page.

    Parameters
    ----------
    path : str or Path
        The file to write.
    name : str
        Of the run.
    run : str or Path
        Folder that holds ``fits/<variant>/<material>.npz``.
    scenes : sequence of (Scene, str)
        Each with the file of its light.
    made : DataFrame
        Columns material and variant: the fits that there are, in the order in which they are
        shown. Fits of models that have no function of GLSL are left out.
    measured : sequence of str
        Materials whose tables lie in ``tables/`` beside the page (`write_table`).
    figure : bool
        Whether there is one beside the page (`npfm.exports.gallery.figure`).

    Raises
    ------
    NpfmError
        If a file is missing or cannot be read.
    """
    first = made.material.unique()[:MOST_MATERIALS]
    variants = _variants(Path(run), made[made.material.isin(first)])
    shown = {material for variant in variants.values() for material in variant.materials}
    materials = [material for material in first if material in shown]
    files = list(dict.fromkeys(file for _, file in scenes))
    maps = [coarse(environment.read(file)) for file in files]
    data = {
        "run": name,
        "materials": materials,
        "left_out": int(made.material.nunique()) - len(first),
        "measured": [material for material in materials if material in set(measured)],
        "scenes": [{**vars(scene), "light": files.index(file)} for scene, file in scenes],
        "lights": [{"rows": m.shape[0], "columns": m.shape[1]} for m in maps],
        "variants": [{"name": key, **_described(one)} for key, one in variants.items()],
        "figure": figure,
        "camera": {"distance": CAMERA.distance, "field": CAMERA.field},
        "shaders": {
            "angles": (FOLDER / "angles.glsl").read_text(),
            **{each: page.text(f"demo_{each}.glsl") for each in ("table", "trace", "show")},
        },
    }
    content = [packed(each) for each in maps]
    for variant in variants.values():
        content.append(packed(np.stack([each.rows for each in variant.shaders])))
    page.write(path, "demo", f"Demo of the run {name}", data, content, scripts_beside=True)


def _variants(run: Path, made: pd.DataFrame) -> dict[str, _Variant]:
    """Fits that can be shown, by variant: all of a variant are of one model, on one grid."""
    found: dict[str, _Variant] = {}
    for variant, rows in made.groupby("variant", sort=False):
        paths = {str(m): run / "fits" / str(variant) / f"{m}.npz" for m in rows.material.unique()}
        first = fits.load(next(iter(paths.values())))
        if first.model in MODELS and isinstance(first.grid, HalfDifference):
            shaders = [shader(fits.load(path)) for path in paths.values()]
            found[str(variant)] = _Variant(list(paths), shaders, first.model)
    return found


def _described(variant: _Variant) -> dict[str, Any]:
    first = variant.shaders[0]
    return {
        "editable": variant.model in EDITABLE,
        "materials": variant.materials,
        "source": first.source,
        "constants": first.constants,
        "rows": len(first.rows),
    }


def packed(values: NDArray) -> bytes:
    """Pack numbers as float32: a zlib stream of their lowest bytes, then the next, and so on."""
    content = values.astype("<f4").reshape(-1, 1).view(np.uint8)
    return zlib.compress(np.ascontiguousarray(content.T).tobytes(), 9)


def write_table(path: str | Path, table: Table[HalfDifference]) -> None:
    """Write a measured table as a script that the demo loads when it is asked for.

    It calls ``npfmTable`` with bins, scale and values: the base 64 of a zlib stream of half floats,
    channel by channel, as differences along phi_d modulo 2^16, all high bytes and then all low
    ones.

    Parameters
    ----------
    path : str or Path
        The file to write, with the suffix ``.js``.
    table : Table
        BRDF in 1/sr; what was not measured is 0.
    """
    values = np.maximum(table.values, 0)
    scale = 2.0 ** max(0, np.ceil(np.log2(max(values.max(), 1.0) / LARGEST)))
    words = (values / scale).astype("<f2").view("<u2")
    changes = np.diff(words, axis=-1, prepend=np.uint16(0)).astype("<u2")
    high, low = ((changes >> 8).astype(np.uint8), (changes & 255).astype(np.uint8))
    content = page.base64_of(zlib.compress(high.tobytes() + low.tobytes(), 9))
    given = ", ".join(json.dumps(each) for each in (table.grid.shape, scale, content))
    with replacing(path, TABLE) as temporary:
        temporary.write_text(f"{TABLE_START}{given});\n", encoding="ascii", newline="\n")
