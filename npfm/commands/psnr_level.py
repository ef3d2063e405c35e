"""``npfm psnr-level``."""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import psnr_level as study
from npfm.evaluation import tables
from npfm.fitting.sources import table
from npfm.reflectance.table_files import read_table
from npfm.storage.bounds import check_size
from npfm.storage.names import named
from npfm.storage.pictures import EXR, read_exr, write_exr

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.evaluation.psnr_level",
    "npfm.evaluation.tables",
    "npfm.storage.bounds",
    "npfm.storage.names",
    "npfm.storage.pictures",
)
#: And what it covers for some of the kinds.
CODE_OF_KIND = {
    "angles": ("npfm.rendering.view_angles",),
    "table": ("npfm.papers.bagher2016",),
}
EXAMPLE = """\
examples:
  python -m npfm psnr-level angles --objects figure sphere --mesh buddha.ply \\
      --effects visibility antialiasing --resolution 128 -o angles/B.exr
  python -m npfm psnr-level measure chrome.binary --fits naive=fits/naive/chrome.npz \\
      --scenes configured/B=scenes/B turned-180/B=turned/B --angles B=angles/B.exr -o chrome.csv
  python -m npfm psnr-level table chrome.csv nylon.csv -o psnr_level.csv
angles writes how many degrees from the normal each pixel is seen under. Of a scene that is called
'antialiased', measure also compares pixels that objects cover by half, and those that they touch;
of one that is 'configured', also those that are seen under no more than 80 degrees. PSNR is in dB.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="angles|measure|table")
    angles = kinds.add_parser("angles")
    for name, needed in (("--objects", True), ("--effects", False)):
        angles.add_argument(
            name, nargs="+", required=needed, default=[], help="as npfm scene takes them"
        )
    angles.add_argument("--mesh", type=Path, help="mesh of the figure (default: ours)")
    angles.add_argument(
        "--resolution", type=whole(1), default=128, help="pixels along one side (default: 128)"
    )
    measure = kinds.add_parser("measure")
    measure.add_argument("table", help="MERL .binary or UTIA .bin file of the material")
    measure.add_argument("--fits", nargs="+", required=True, metavar="VARIANT=FIT")
    measure.add_argument(
        "--scenes", nargs="+", required=True, metavar="WAY/SCENE=FOLDER", help="made by npfm scene"
    )
    measure.add_argument(
        "--angles",
        nargs="*",
        default=[],
        metavar="SCENE=EXR",
        help="made by npfm psnr-level angles",
    )
    gather = kinds.add_parser("table")
    gather.add_argument("found", nargs="+", help="CSVs made by npfm psnr-level measure")
    for kind, chosen in kinds.choices.items():
        what = EXR if kind == "angles" else tables.TABLE
        chosen.add_argument("-o", "--output", type=output(what), required=True, help="to write")


def run(arguments: argparse.Namespace) -> None:
    """Make the picture of angles or the table, and write it."""
    if arguments.kind == "angles":
        write_exr(arguments.output, _angles(arguments))
    elif arguments.kind == "measure":
        tables.write(arguments.output, _measured(arguments))
    else:
        from npfm.papers.bagher2016 import MEAN_PSNR_DB

        levels = study.levels(study.read(arguments.found), MEAN_PSNR_DB)
        tables.write(arguments.output, levels)


def _angles(arguments: argparse.Namespace) -> NDArray[np.float64]:
    """Angles of view, three times: a picture of radiance has three channels."""
    from npfm.rendering.scenes import Scene
    from npfm.rendering.view_angles import view_angles

    check_size(arguments.output, arguments.resolution, arguments.resolution)
    scene = Scene(tuple(arguments.objects), tuple(arguments.effects), arguments.mesh)
    return np.repeat(view_angles(scene, arguments.resolution)[..., None], 3, axis=2)


def _measured(arguments: argparse.Namespace) -> pd.DataFrame:
    material, measured = Path(arguments.table).stem, read_table(arguments.table)
    fits = {name: table(path) for name, path in named(arguments.fits, "naive=naive.npz").items()}
    return study.measure(material, measured, fits, _builds(arguments))


def _builds(arguments: argparse.Namespace) -> list[study.Build]:
    angles = {
        scene: read_exr(path)[..., 0]
        for scene, path in named(arguments.angles, "A=angles.exr").items()
    }
    builds = []
    for name, folder in named(arguments.scenes, "configured/A=folder").items():
        way, slash, scene = name.partition("/")
        if not slash:
            raise NpfmError(f"'{name}' has no '/'; name way and scene, as in configured/A=folder")
        builds.append(study.Build(scene, way, folder, angles.get(scene)))
    return builds
