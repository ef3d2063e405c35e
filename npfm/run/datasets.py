"""What the dataset of a configuration has: its materials, and the grid of their tables."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from npfm.datasets import (
    analytic,
    merl_folder,
    neural,
    rgl_folder,
    synthetic,
    synthetic_anisotropic,
    utia_folder,
)
from npfm.datasets.names import MERL_NAMES, select
from npfm.errors import NpfmError
from npfm.reflectance import grids
from npfm.reflectance.directional import UTIA
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.utia import check_bin
from npfm.run.names import check_names

#: Names of the materials that the project makes, by the kind of dataset.
MADE = {
    "formula": analytic.materials,
    "synthetic": synthetic.materials,
    "synthetic-anisotropic": synthetic_anisotropic.materials,
}

#: Names of the materials in a folder, by the kind of dataset.
FOLDERS = {"rgl": rgl_folder.materials, "utia": utia_folder.materials}
#: Kinds whose directional tables have a shape that may be chosen.
SHAPED = ("synthetic-anisotropic", "rgl")


def chosen(config: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the materials that a configuration names, sorted.

    Raises
    ------
    NpfmError
        If it names none that there is, or one whose name cannot be that of a file.
    """
    materials = tuple(select(config["dataset"]["materials"], available(config)))
    _check_materials(materials, config["dataset"], config["data"])
    return materials


def grid(config: Mapping[str, Any], materials: Iterable[str]) -> Grid:
    """Return the grid that the tables of all materials are on.

    Raises
    ------
    NpfmError
        If they are on several, or the shape of the grid is none.
    """
    dataset = config["dataset"]
    if "shape" in dataset and dataset["kind"] not in SHAPED:
        raise NpfmError(f"config: dataset/shape: kind '{dataset['kind']}' has none; leave it out")
    shaped = _shaped(dataset)
    if dataset["kind"] == "synthetic-anisotropic":
        return shaped
    if dataset["kind"] not in ("utia", "rgl"):
        return MERL
    folder = Path(config["data"]) / dataset["path"]
    found: dict[Grid, str] = {}
    for name in materials:
        # A file that is no table is told by the job that reads it; the others go on.
        with suppress(NpfmError):
            if dataset["kind"] == "utia":
                measured: Grid = check_bin(utia_folder.path(folder, name))
            else:
                measured = shaped if rgl_folder.anisotropic(folder, name) else MERL
            found.setdefault(measured, name)
    if len(found) > 1:
        (one, first), (other, second) = list(found.items())[:2]
        raise NpfmError(
            f"config: dataset/materials: {first} is on the grid {one.name} and {second} on "
            f"{other.name}; choose materials that are on one"
        )
    if "shape" in dataset and shaped not in found:
        raise NpfmError("config: dataset/shape: the materials are isotropic; leave it out")
    return next(iter(found), UTIA if dataset["kind"] == "utia" else MERL)


def _shaped(dataset: Mapping[str, Any]) -> Grid:
    """Return the directional grid of the shape that a dataset names, or the usual one."""
    try:
        return grids.parse([UTIA.kind, *([dataset["shape"]] if "shape" in dataset else [])])
    except NpfmError as error:
        raise NpfmError(f"config: dataset/shape: {error}") from error


def _check_materials(names: Iterable[str], dataset: Mapping[str, Any], folder: str) -> None:
    """Refuse names of materials that cannot be names of files."""
    suffix = {"merl": ".binary", "utia": ".bin", "rgl": ".bsdf", "neural": ".h5"}.get(
        dataset["kind"], ""
    )
    source = Path(folder) / dataset.get("path", "")
    for name in names:
        check_names([name], "material", f"{f'{name}{suffix}'!r} in {source}")


def available(config: Mapping[str, Any]) -> list[str]:
    """Return the materials that the dataset of a configuration has, sorted.

    Raises
    ------
    NpfmError
        If its folder or archive is not named, or cannot be read.
    """
    dataset = config["dataset"]
    if dataset["kind"] in MADE:
        return MADE[dataset["kind"]]()
    if "path" not in dataset:
        raise NpfmError(f"config: dataset: kind '{dataset['kind']}' needs a 'path'")
    path = Path(config["data"]) / dataset["path"]
    if dataset["kind"] == "neural":
        return neural.materials(path)
    if dataset["kind"] in FOLDERS:
        return FOLDERS[dataset["kind"]](path)
    if "url" in dataset:
        here = merl_folder.materials(path) if path.is_dir() else []
        return sorted({*MERL_NAMES, *here})
    return merl_folder.materials(path)
