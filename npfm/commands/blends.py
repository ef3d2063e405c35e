"""``npfm blends``."""

import argparse
from pathlib import Path

import numpy as np

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import blends, tables
from npfm.fitting.registry import tabulated
from npfm.reflectance.table_files import read_table
from npfm.rendering import scenes, textures, transport
from npfm.storage.pictures import EXR, write_exr_parts

#: Steps of weights: those of a texture of 8 bits, beyond which each texel has a table of its own.
MOST_STEPS = 255
#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.evaluation.blends",
    "npfm.evaluation.tables",
    "npfm.fitting.registry",
    "npfm.reflectance.table_files",
    "npfm.rendering.product_kernel",
    "npfm.rendering.scenes",
    "npfm.rendering.textures",
    "npfm.rendering.transport",
    "npfm.storage.pictures",
)
EXAMPLE = """\
example:
  python -m npfm blends scene-a --objects sphere --measured brass.binary cloth.binary \\
      paint.binary nylon.binary --fits brass.npz cloth.npz paint.npz nylon.npz \\
      --pictures blends.exr --half-way half_way.csv -o blends.csv
renders an object that changes between four materials by a texture of weights, blended in tables, in
logarithms of factors and, with --factors, in a basis of them; and the mixtures half way between
neighbours. Seconds are CPU time. Without --weights it wears the project's own texture.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    count = textures.COUNT
    parser.add_argument("scene", help="folder made by npfm scene")
    parser.add_argument("--objects", nargs="+", required=True, help="as the scene has them")
    parser.add_argument("--mesh", type=Path, help="mesh of the figure, if the scene has one")
    parser.add_argument(
        "--measured", nargs=count, required=True, metavar="TABLE", help="MERL .binary files"
    )
    parser.add_argument(
        "--fits",
        nargs=count,
        required=True,
        metavar="FIT",
        help="of these, by independent-g (.npz)",
    )
    parser.add_argument("--weights", help="PNG with the weights, as npfm vary takes it")
    parser.add_argument(
        "--steps",
        nargs="*",
        type=whole(1, MOST_STEPS),
        default=[],
        help="steps of weights where a table is made for each mixture instead",
    )
    parser.add_argument("--factors", help="of many materials, made by npfm basis gather")
    parser.add_argument(
        "--curves", type=whole(1), default=5, help="of a basis of these (default: %(default)s)"
    )
    parser.add_argument("--name", default="scene", help="of the scene, in the table")
    for names, kind, what in (
        (["--pictures"], EXR, "pictures, as the parts of an EXR"),
        (["--half-way"], blends.HALF_WAY_TABLE, "table of the mixtures half way (CSV)"),
        (["-o", "--output"], tables.TABLE, "table of what each way costs (CSV)"),
    ):
        parser.add_argument(*names, type=output(kind), required=True, help=f"{what} to write")


def run(arguments: argparse.Namespace) -> None:
    """Blend, render and measure."""
    names = [Path(path).stem for path in arguments.measured]
    measured = [read_table(path) for path in arguments.measured]
    chosen = blends.ways(arguments.fits)
    if arguments.factors:
        chosen |= blends.in_basis(arguments.fits, arguments.factors, arguments.curves)
    matrix = transport.load(arguments.scene)
    grids = [table.grid for table in measured] + [way.palette.grid for way in chosen.values()]
    if any(grid != matrix.grid for grid in grids):
        raise NpfmError(
            f"{arguments.scene}: of another grid than the materials; build it for theirs"
        )
    matrix = blends.where_measured(matrix, measured)
    shares = _shares(arguments, matrix)
    parts = shares.reshape(len(names), -1).T
    fits = arguments.fits
    made = blends.render_all(matrix, parts, measured, fits, chosen, arguments.steps)
    costs = blends.costs(arguments.name, made, matrix.foreground, len(names))
    fitted = [tabulated(path) for path in fits]
    between, ends = blends.half_way(names, matrix, fitted, chosen)
    tables.write(arguments.output, costs)
    tables.write(arguments.half_way, between)
    worn = np.moveaxis(shares * (matrix.coverage > 0), 0, -1)
    shown = {blends.WEIGHTS: worn, **{way: one.picture for way, one in made.items()}, **ends}
    write_exr_parts(arguments.pictures, shown)


def _shares(arguments: argparse.Namespace, matrix: transport.Transport) -> np.ndarray:
    """Share of each material at each pixel, shape (materials, h, w)."""
    scene = scenes.Scene(tuple(arguments.objects), (), arguments.mesh)
    places = textures.coordinates(scenes.place(scene), len(matrix.coverage))
    if np.isnan(places[matrix.coverage == 1]).any():
        raise NpfmError(f"{arguments.scene}: made of other objects; give those that it has")
    given = arguments.weights
    weights = textures.read_weights(given) if given else textures.own_weights()
    return textures.shares_of_weights(weights, places)
