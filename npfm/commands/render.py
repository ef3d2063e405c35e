"""``npfm render``."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.commands.sources import table
from npfm.errors import NpfmError
from npfm.reflectance.table_files import read_table
from npfm.rendering import transport
from npfm.storage import pictures

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.commands.sources",
    "npfm.rendering.transport",
    "npfm.storage.pictures",
)
EXAMPLE = """\
examples:
  python -m npfm render scene-a chrome.binary -o measured.exr
  python -m npfm render scene-a chrome.npz --measured chrome.binary -o independent-g.exr
  python -m npfm render scene-b chrome.binary --bounced chrome-bounced.exr -o measured.exr
writes linear radiance (RGB, and the coverage by objects as alpha) as measured.exr, and tone-mapped
as measured.png. Where a file of either name is there that npfm did not write, nothing is written.
With --bounced, the light that npfm interreflect found to come over other objects is added.
With --measured, cells without a measurement are black, as they are in the picture of the
measurement: they count neither for nor against the fit.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("scene", help="folder made by npfm scene")
    parser.add_argument("source", help="MERL .binary or UTIA .bin file, or fit (.npz)")
    parser.add_argument("--measured", help="file that the fit was made from")
    parser.add_argument("--bounced", help="EXR made by npfm interreflect, to be added")
    parser.add_argument(
        "--exposure", type=positive, default=0.02, help="of the PNG, factor (default: %(default)s)"
    )
    parser.add_argument(
        "--gamma", type=positive, default=2.2, help="of the PNG, exponent (default: %(default)s)"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output(pictures.EXR, beside=pictures.PNG),
        required=True,
        help="EXR to write",
    )


def run(arguments: argparse.Namespace) -> None:
    """Render."""
    material = table(arguments.source)
    if arguments.measured:
        material = material.where_measured(read_table(arguments.measured))
    picture = transport.render(transport.load(arguments.scene), material)
    if arguments.bounced:
        picture[..., :3] += _bounced(arguments.bounced, picture.shape[:2])
    pictures.write_exr(arguments.output, picture)
    png = pictures.tone_map(picture[..., :3], arguments.exposure, arguments.gamma)
    pictures.write_png(Path(arguments.output).with_suffix(".png"), png)


def _bounced(path: str, shape: tuple[int, ...]) -> NDArray[np.float32]:
    added = pictures.read_exr(path)[..., :3]
    if added.shape[:2] != shape:
        rows, columns = added.shape[:2]
        raise NpfmError(
            f"{path}: {columns} x {rows} pixels, and the scene has {shape[1]} x {shape[0]}; "
            "render it again with npfm interreflect"
        )
    return added
