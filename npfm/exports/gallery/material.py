"""The page of a material: the measurement and every fit in one place, and what is known of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.evaluation import quality, tables
from npfm.evaluation.comparison import check_windows
from npfm.exports.gallery import curves, looks, page, pixels
from npfm.exports.gallery.kinds import THUMBNAILS
from npfm.fitting import fits
from npfm.storage.pictures import read_exr, read_png

MEASURED = "measured"
#: Perceptually uniform, and told apart without colour as well.
ERROR_COLORS = "magma"
#: The share of the range of display values that has the brightest colour of the map of errors.
LARGEST_ERROR = 0.2


@dataclass(frozen=True)
class Scene:
    """A scene of the run, and how its pictures are shown at first (`pictures.tone_map`)."""

    name: str
    exposure: float
    gamma: float


def write(
    path: str | Path,
    run: str | Path,
    material: str,
    scenes: Sequence[Scene],
    variants: Sequence[str],
    values: pd.DataFrame,
    published: Mapping[str, NDArray],
    colors: Mapping[str, str],
    *,
    demo: bool = False,
    video: bool = False,
) -> None:
    """Write the page of a material, and beside it the small pictures of the overview.

    Parameters
    ----------
    path : str or Path
        The page; the small pictures have its name with the suffix ``.jpg``.
    run : str or Path
        Folder that holds ``renders/<scene>/<material>/<variant>.exr`` and ``.png``, those of
        ``measured``, and ``fits/<variant>/<material>.npz`` with their records.
    material : str
    scenes, variants : sequences
        What is shown, in this order.
    values : DataFrame
        Columns `quality.COLUMNS`.
    published : mapping of str to ndarray
        Published factors of the material, if there are any.
    colors : mapping of str to str
        Of some variants, in place of the project's.
    demo, video : bool
        Whether the gallery has a demo and the material a page in ``video/``, to link to.

    Raises
    ------
    NpfmError
        If a file is missing, cannot be read, or is of another size than the measurement.
    """
    names = [MEASURED, *variants]
    folders = [Path(run) / "renders" / scene.name / material for scene in scenes]
    packed = [pixels.pack(_pictures([f / f"{n}.exr" for n in names])) for f in folders]
    small = [[read_png(folder / f"{name}.png") for name in names] for folder in folders]
    data = {
        "run": Path(run).absolute().name,
        "material": material,
        "scenes": [
            {**vars(scene), "scale": p.scale, "height": p.height, "width": p.width}
            for scene, p in zip(scenes, packed, strict=True)
        ],
        "variants": _variants(run, material, variants, published, colors),
        "metrics": metrics(values[values.material == material]),
        "errors": {"largest": LARGEST_ERROR, "colors": color_map()},
        "demo": demo,
        "video": video,
    }
    pixels.write_thumbnails(Path(path).with_suffix(THUMBNAILS.suffix), small)
    page.write(path, "material", material, data, [p.content for p in packed])


def _pictures(paths: Sequence[Path]) -> list[NDArray[np.float32]]:
    made = [read_exr(path)[..., :3] for path in paths]
    for path in paths[1:]:
        check_windows(paths[0], path)
    return made


def _variants(
    run: str | Path,
    material: str,
    names: Sequence[str],
    published: Mapping[str, NDArray],
    colors: Mapping[str, str],
) -> list[dict[str, Any]]:
    """What there is to say of each fit, beside its pictures."""
    described = []
    for look in looks.variants(names, colors):
        path = Path(run) / "fits" / look["name"] / f"{material}.npz"
        fit, record = fits.load(path), fits.load_record(path)
        described.append(
            {
                **look,
                "model": record["model"],
                "bytes": record["bytes"],
                "channels": _channels(record["channels"]),
                "curves": curves.curves(fit, published),
                "parameters": curves.parameters(fit),
            }
        )
    return described


def _channels(records: Sequence[fits.ChannelRecord]) -> list[dict[str, Any]]:
    """What ``tables/fits.csv`` says of each channel, numbers as they are there."""
    return [
        {
            "channel": record.channel,
            "seconds": as_in_table(record.seconds),
            "objective": as_in_table(record.objective),
            "start": record.best_start,
            "status": record.status,
        }
        for record in records
    ]


def as_in_table(value: float) -> float | str | None:
    """Return a number with the digits that `tables.write` keeps."""
    return page.number(float(tables.FLOAT_FORMAT % value))


def metrics(values: pd.DataFrame) -> list[dict[str, Any]]:
    """Metrics in their order, with `values` by scene and variant."""
    made = []
    for name, rows in values.groupby("metric", sort=False):
        known = quality.metric(str(name))
        by_scene: dict[str, dict[str, Any]] = {}
        for scene, variant, value in zip(rows.scene, rows.variant, rows.value, strict=True):
            by_scene.setdefault(scene, {})[variant] = page.number(value)
        made.append({"name": name, **vars(known), "values": by_scene})
    return made


def color_map() -> str:
    """Return the colours of the map of errors: 256 as hexadecimal digits, six each."""
    rgb = matplotlib.colormaps[ERROR_COLORS](np.arange(256), bytes=True)[:, :3]
    return rgb.tobytes().hex()
