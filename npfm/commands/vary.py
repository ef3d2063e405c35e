"""``npfm vary``."""

import argparse
from pathlib import Path

import numpy as np

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.fitting.sources import table
from npfm.rendering import scenes, textures, transport
from npfm.storage import pictures

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.rendering.textures",
    "npfm.storage.pictures",
)
EXAMPLE = """\
example:
  python -m npfm vary scene-a smoother.npz chrome.npz rougher.npz --objects sphere -o worn.exr
renders an object that is of the first material where the texture is black, of the last where it is
white, and in between of those between; and a tone-mapped PNG beside it. Without --texture it wears
the project's own pattern.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("scene", help="folder made by npfm scene")
    parser.add_argument(
        "sources", nargs="+", help="MERL .binary or UTIA .bin files, or fits (.npz)"
    )
    parser.add_argument("--texture", help="picture whose brightness counts, wrapped around y")
    parser.add_argument("--objects", nargs="+", required=True, help="as the scene has them")
    parser.add_argument("--mesh", type=Path, help="PLY file of the figure, if the scene has one")
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
    matrix = transport.load(arguments.scene)
    objects = scenes.place(scenes.Scene(tuple(arguments.objects), (), arguments.mesh))
    places = textures.coordinates(objects, len(matrix.coverage))
    if np.isnan(places[matrix.coverage == 1]).any():
        raise NpfmError(f"{arguments.scene}: made of other objects; give those that it has")
    texture = _texture(arguments.texture) if arguments.texture else textures.own_texture()
    parts = textures.shares(texture, places, len(arguments.sources))
    tables = [table(source) for source in arguments.sources]
    picture = textures.render_varying(matrix, tables, parts)
    pictures.write_exr(arguments.output, picture)
    png = pictures.tone_map(picture[..., :3], arguments.exposure, arguments.gamma)
    pictures.write_png(Path(arguments.output).with_suffix(".png"), png)


def _texture(path: str) -> np.ndarray:
    """Brightness of a picture, from 0 to 1."""
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("L"), dtype=float) / 255
    except (OSError, UnidentifiedImageError) as error:
        raise NpfmError(f"{path}: cannot be read as a picture ({error}); give a PNG") from error
