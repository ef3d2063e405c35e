"""The first page: Figure 8 of Bagher et al. 2016, of which everything can be asked."""

import operator
from collections.abc import Mapping, Sequence
from functools import reduce
from pathlib import Path
from typing import Any

import pandas as pd

from npfm.errors import NpfmError
from npfm.evaluation import quality
from npfm.exports.gallery import looks, page, pixels

#: What the metric is at first: the nearest to people's opinions (docs/quality.md).
FIRST = "ssim"
MEAN = "mean"
#: What is known of fits beside the metrics; of a fit, all its channels together.
OF_FITS = {
    "seconds": quality.Metric("seconds of a fit", "s", "lower"),
    "objective": quality.Metric("objective, mean of the channels", "1", "lower"),
}
#: Digits of what is computed here, as `tables.write` keeps.
DIGITS = 6


def write(
    path: str | Path,
    name: str,
    values: pd.DataFrame,
    fits: pd.DataFrame,
    sizes: Mapping[str, int],
    diffuseness: Mapping[str, float],
    colors: Mapping[str, str],
    *,
    demo: bool = False,
    videos: Sequence[str] = (),
) -> None:
    """Write the first page; the pages of the materials are in ``materials/`` beside it.

    Parameters
    ----------
    path : str or Path
        The file to write.
    name : str
        Of the run.
    values : DataFrame
        Columns `quality.COLUMNS`: of every material and variant that is shown, in their order.
    fits : DataFrame
        Columns material, variant, seconds, objective; a row each channel.
    sizes : mapping of str to int
        Bytes of a fit, by variant.
    diffuseness : mapping of str to float
        By material; empty where it is not known.
    colors : mapping of str to str
        Of some variants, in place of the project's.
    demo : bool
        Whether the gallery has one, to link to.
    videos : sequence of str
        Materials with a page in ``video/`` as well.

    Raises
    ------
    NpfmError
        If a fit that was compared is not in `fits`.
    """
    scenes = [scene for scene in values.scene.unique() if scene != quality.ALL]
    shown = looks.variants(values.variant.unique(), colors)
    data = {
        "run": name,
        "scenes": scenes,
        "thumbnail": pixels.THUMBNAIL,
        "variants": [{**look, "bytes": sizes.get(look["name"])} for look in shown],
        "materials": _materials(values, diffuseness),
        "quantities": [*_metrics(values), *_of_fits(values, fits)],
        "first": FIRST,
        "demo": demo,
        "videos": list(videos),
    }
    page.write(path, "overview", f"Gallery of the run {name}", data)


def _materials(values: pd.DataFrame, diffuseness: Mapping[str, float]) -> list[dict[str, Any]]:
    """Each with the variants that its small pictures show, in their order."""
    return [
        {
            "name": name,
            "diffuseness": page.number(diffuseness.get(str(name), float("nan"))),
            "variants": rows.variant.unique().tolist(),
        }
        for name, rows in values.groupby("material", sort=False)
    ]


def _metrics(values: pd.DataFrame) -> list[dict[str, Any]]:
    made = []
    for name, rows in values.groupby("metric", sort=False):
        scenes = {str(scene): some for scene, some in rows.groupby("scene", sort=False)}
        made.append(_quantity(str(name), quality.metric(str(name)), scenes))
    return made


def _of_fits(values: pd.DataFrame, fits: pd.DataFrame) -> list[dict[str, Any]]:
    found = fits.groupby(["material", "variant"], sort=False, as_index=False).agg(
        seconds=("seconds", "sum"), objective=("objective", "mean")
    )
    pairs = values[["material", "variant"]].drop_duplicates()
    known = pairs.merge(found, how="left", indicator=True)
    if (lacking := known[known["_merge"] != "both"]).size:
        row = lacking.iloc[0]
        raise NpfmError(f"no fit of {row.material} by {row.variant}; give the tables of one run")
    return [
        _quantity(name, metric, {quality.ALL: known.assign(value=known[name])})
        for name, metric in OF_FITS.items()
    ]


def _quantity(
    name: str, metric: quality.Metric, scenes: Mapping[str, pd.DataFrame]
) -> dict[str, Any]:
    """Values by scene, material and variant; of several scenes the mean as well.

    As in Figure 8, a mean is missing where the value of any scene is.
    """
    tables = {
        scene: rows.pivot(index="material", columns="variant", values="value")
        for scene, rows in scenes.items()
    }
    if quality.ALL not in tables:
        tables = {MEAN: reduce(operator.add, tables.values()) / len(tables), **tables}
    return {"name": name, **vars(metric), "values": {s: _nested(t) for s, t in tables.items()}}


def _nested(table: pd.DataFrame) -> dict[str, dict[str, Any]]:
    """By material and variant, what is there."""
    return {
        str(material): {
            str(variant): page.number(float(f"{value:.{DIGITS}g}"))
            for variant, value in row.items()
            if pd.notna(value)
        }
        for material, row in table.iterrows()
    }
