"""``npfm power-iterations``."""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import anisotropic_slopes as anisotropic
from npfm.evaluation import delta_e, tables
from npfm.evaluation import power_iterations as study
from npfm.fitting import fits
from npfm.papers import dupuy2015
from npfm.storage.names import distinct, named
from npfm.storage.pictures import EXR, write_exr_parts

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.evaluation.anisotropic_slopes",
    "npfm.evaluation.delta_e",
    "npfm.evaluation.power_iterations",
    "npfm.evaluation.tables",
    "npfm.fitting.fits",
    "npfm.papers.dupuy2015",
    "npfm.storage.names",
    "npfm.storage.pictures",
)
EXAMPLE = """\
examples:
  python -m npfm power-iterations recovery -o recovery.csv
  python -m npfm power-iterations timing -o timing.csv
  python -m npfm power-iterations timing --anisotropic -o timing.csv
  python -m npfm power-iterations surfaces chrome.npz nylon.npz -o surfaces.csv
  python -m npfm power-iterations delta-e --measured renders/A --fits ggx=renders/A \\
      --materials chrome nylon -o delta_e.csv --images delta_e.exr
recovery finds known surfaces again (Table 1 of Dupuy et al. 2015); timing tells processor seconds;
surfaces reads roughness and colour off fits of power-iteration, or of ggx for tables of both
directions; delta-e compares the tone-mapped
pictures of fits with those of measurements (CIEDE2000, of which 1 is just noticeable).
"""
#: As in the paper's table, and from mirrors to matte.
ROUGHNESS = (0.005, *dupuy2015.BACKSCATTER_ERROR, 0.3, 0.6)
NODES = (22, 45, 90, 180, 360)
#: Elevations and azimuths of anisotropic ones: those of the UTIA database, and the paper's.
ANISOTROPIC_NODES = ((6, 48), (12, 48), (45, 45), (45, 90), (90, 90), (90, 180))
#: Roughness along two axes, and turns in degrees, that are found again.
ANISOTROPIC_ROUGHNESS = ((0.05, 0.5), (0.1, 0.1), (0.15, 0.3), (0.3, 0.6), (0.6, 0.6))
TURNS = (0.0, 30.0, 45.0, 110.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(
        dest="kind", required=True, metavar="recovery|timing|surfaces|delta-e"
    )
    recovery, timing = kinds.add_parser("recovery"), kinds.add_parser("timing")
    timing.add_argument(
        "--repeats", type=whole(1), default=9, help="of which the median counts (default: 9)"
    )
    for kind in (recovery, timing):
        kind.add_argument(
            "--anisotropic",
            action="store_true",
            help="of surfaces that are turned about the normal",
        )
    surfaces = kinds.add_parser("surfaces")
    surfaces.add_argument(
        "fits",
        nargs="+",
        help="fits (.npz) of power-iteration, or of ggx for tables of both directions",
    )
    compare = kinds.add_parser("delta-e")
    compare.add_argument("--measured", required=True, help="folder of the pictures of a scene")
    compare.add_argument(
        "--fits",
        nargs="+",
        required=True,
        metavar="VARIANT=FOLDER",
        help="folder of the pictures of a scene that has those of the variant",
    )
    compare.add_argument("--materials", nargs="+", required=True, help="names")
    compare.add_argument(
        "--images", type=output(EXR), required=True, help="EXR to write: a part each variant"
    )
    for kind in (recovery, timing, surfaces, compare):
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    a = arguments
    match a.kind:
        case "recovery" if a.anisotropic:
            table = anisotropic.recovery(ANISOTROPIC_NODES[-2:-1], ANISOTROPIC_ROUGHNESS, TURNS)
        case "timing" if a.anisotropic:
            table = anisotropic.timing(ANISOTROPIC_NODES, a.repeats)
        case "recovery":
            nodes = dupuy2015.TABLE_1_NODES, dupuy2015.MERL_NODES
            table = study.recovery(nodes, ROUGHNESS)
            printed = (table.surface == "beckmann") & (table.nodes == dupuy2015.TABLE_1_NODES)
            table["published_error"] = table.alpha.map(dupuy2015.BACKSCATTER_ERROR).where(printed)
        case "timing":
            table = study.timing(NODES, a.repeats)
        case "surfaces":
            names = distinct(Path(path).stem for path in a.fits)
            table = study.surfaces(dict(zip(names, _fits(a.fits), strict=True)))
        case "delta-e":
            images, table = delta_e.mean_images(
                a.measured, named(a.fits, "ggx=renders/A"), a.materials
            )
    tables.write(a.output, table)
    if a.kind == "delta-e":
        write_exr_parts(a.images, {name: _part(image) for name, image in images.items()})


def _fits(paths: Sequence[str]) -> list[fits.Fit]:
    """Read fits that roughness can be read off: all of one kind of grid."""
    loaded = list(map(fits.load, paths))
    for path, fit in zip(paths, loaded, strict=True):
        wanted = "ggx" if fit.grid.anisotropic else "power-iteration"
        if fit.model != wanted:
            raise NpfmError(f"{path}: a fit of '{fit.model}'; give fits of {wanted}")
        if fit.grid.kind != loaded[0].grid.kind:
            raise NpfmError(f"{path}: on another kind of grid than {paths[0]}; give those of one")
    return loaded


def _part(image: np.ndarray) -> np.ndarray:
    """Return the image in all three channels, and where the objects are as alpha."""
    inside = np.isfinite(image)
    return np.dstack([np.where(inside, image, 0.0)] * 3 + [inside])
