"""``npfm effects-cost``."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import effects_cost as costs
from npfm.evaluation import tables
from npfm.fitting.sources import table
from npfm.rendering.effects import EFFECTS
from npfm.storage.names import named
from npfm.storage.pictures import EXR, write_exr_parts

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.evaluation.effects_cost",
    "npfm.evaluation.tables",
    "npfm.storage.names",
    "npfm.storage.pictures",
)
EXAMPLE = """\
examples:
  python -m npfm effects-cost compare scenes/B --switched visibility=scenes/B-without-shadows \\
      --tables chrome.binary nylon.binary --fits chrome.npz nylon.npz -o B.csv --pictures B.exr
  python -m npfm effects-cost table B.csv C.csv -o effects.csv
Each scene needs the record that npfm scene --record writes, beside its folder (scenes/B.json).
psnr_change_db is what an effect adds to the PSNR of the fits, in dB; picture_db is the PSNR of the
measurement's picture against that without the effect.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="compare|table")
    compare = kinds.add_parser("compare")
    compare.add_argument("scene", help="folder made by npfm scene")
    compare.add_argument(
        "--switched",
        nargs="*",
        default=[],
        metavar="EFFECT=FOLDER",
        help="the scene with an effect on that it is without, or off that it has",
    )
    compare.add_argument(
        "--tables", nargs="+", required=True, help="MERL .binary or UTIA .bin files"
    )
    compare.add_argument("--fits", nargs="+", required=True, help="a fit (.npz) of each table")
    compare.add_argument(
        "--bounced-tables", nargs="*", default=[], help="EXRs of npfm interreflect, of each table"
    )
    compare.add_argument("--bounced-fits", nargs="*", default=[], help="the same of each fit")
    compare.add_argument(
        "--bounces", action="store_true", help="the scene is configured with that light"
    )
    compare.add_argument(
        "--pictures",
        type=output(EXR),
        required=True,
        help="EXR to write: the last table in each scene, as parts",
    )
    gather = kinds.add_parser("table")
    gather.add_argument("scenes", nargs="+", help="CSVs made by npfm effects-cost compare")
    for kind in (compare, gather):
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    if arguments.kind == "table":
        tables.write(arguments.output, costs.read(arguments.scenes))
        return
    if len(arguments.tables) != len(arguments.fits):
        raise NpfmError("--tables and --fits differ in number; name a fit of each table")
    lit = [arguments.bounced_tables, arguments.bounced_fits]
    if any(lit) and any(len(paths) != len(arguments.tables) for paths in lit):
        raise NpfmError("--bounced-tables and --bounced-fits need one picture of each material")
    pairs = zip(arguments.tables, arguments.fits, strict=True)
    materials = [(table(measured), table(fit)) for measured, fit in pairs]
    switched = named(arguments.switched, "visibility=folder", taken=["scene"])
    folders = {"scene": arguments.scene, **switched}
    shown = {name: costs.show(folder, materials) for name, folder in folders.items()}
    parts = {
        name: np.dstack([scene.measured[-1], scene.matrix.coverage])
        for name, scene in shown.items()
    }
    own = shown.pop("scene")
    bounced = costs.bounced(*lit) if any(lit) else None
    if bounced:
        parts = _with_bounced(parts, bounced.measured[-1], arguments.bounces)
    name = Path(arguments.scene).name
    tables.write(
        arguments.output, costs.compare(name, own, shown, bounced, bounces=arguments.bounces)
    )
    write_exr_parts(arguments.pictures, parts)


def _with_bounced(parts: dict[str, NDArray], light: NDArray, bounces: bool) -> dict[str, NDArray]:
    """Add the picture with light that bounces switched, and that light to all, if it is on."""
    added = np.dstack([light, np.zeros(light.shape[:2])])
    name = next(name for name, effect in EFFECTS.items() if effect.bounces)
    if not bounces:
        return parts | {name: parts["scene"] + added}
    return {key: part + added for key, part in parts.items()} | {name: parts["scene"]}
