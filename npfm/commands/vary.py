"""``npfm vary``."""

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import blended
from npfm.fitting.sources import table
from npfm.rendering import products, scenes, textures, transport
from npfm.storage import pictures
from npfm.storage.bounds import check_size

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.evaluation.blended",
    "npfm.fitting.sources",
    "npfm.rendering.products",
    "npfm.rendering.textures",
    "npfm.storage.bounds",
    "npfm.storage.pictures",
)
#: Formats of textures, which are all pictures: PostScript, which could be opened too, is a program.
FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "WEBP")
#: What is blended as tables are.
TABLES = "tables"
EXAMPLE = """\
examples:
  python -m npfm vary scene-a smoother.npz chrome.npz rougher.npz --objects sphere -o worn.exr
  python -m npfm vary scene-a brass.npz cloth.npz paint.npz nylon.npz --objects sphere \\
      --weights weights.png --blend same-albedo -o patched.exr
renders an object that is of the first material where the texture is black, of the last where it is
white, and in between of those between; and a tone-mapped PNG beside it. Without --texture it wears
the project's own pattern. With --weights, red, green, blue and alpha are how much there is of each
of four materials; without alpha, the last has what is left. In between, pictures are averaged, or,
with --blend, factors of fits in their logarithms.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("scene", help="folder made by npfm scene")
    parser.add_argument(
        "sources", nargs="+", help="MERL .binary or UTIA .bin files, or fits (.npz)"
    )
    textured = parser.add_mutually_exclusive_group()
    textured.add_argument("--texture", help="picture whose brightness counts, wrapped around y")
    textured.add_argument("--weights", help="PNG with the weights of four materials, wrapped too")
    parser.add_argument(
        "--blend",
        choices=[TABLES, *blended.BLENDS],
        default=TABLES,
        help="what is in between: tables, factors in logarithms, or these with the specular albedo "
        "at normal incidence averaged (default: %(default)s)",
    )
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
    parts = _parts(arguments, places)
    picture: NDArray[np.floating]
    if arguments.blend == TABLES:
        tables = [table(source) for source in arguments.sources]
        picture = textures.render_varying(matrix, tables, parts)
    else:
        picture = _blended(arguments, matrix, parts.reshape(len(parts), -1).T)
    pictures.write_exr(arguments.output, picture)
    layers = [
        (picture[..., :3] - matrix.backdrop, matrix.coverage),
        (matrix.backdrop, 1 - matrix.coverage),
    ]
    png = pictures.tone_map_layers(layers, arguments.exposure, arguments.gamma)
    pictures.write_png(Path(arguments.output).with_suffix(".png"), png)


def _parts(arguments: argparse.Namespace, places: NDArray) -> NDArray:
    """Share of each source at each pixel, shape (sources, h, w)."""
    count = len(arguments.sources)
    if arguments.weights:
        if count != textures.COUNT:
            raise NpfmError(
                f"--weights are of {textures.COUNT} materials; give so many, not {count}"
            )
        return textures.shares_of_weights(textures.read_weights(arguments.weights), places)
    texture = _texture(arguments.texture) if arguments.texture else textures.own_texture()
    return textures.shares(texture, places, count)


def _blended(
    arguments: argparse.Namespace, matrix: transport.Transport, parts: NDArray
) -> NDArray[np.float32]:
    """Picture of factors that are blended, by the parts of the sources at each pixel."""
    if wrong := [name for name in arguments.sources if Path(name).suffix != ".npz"]:
        raise NpfmError(
            f"{wrong[0]}: no fit, and a table has no factors; --blend {TABLES} takes it"
        )
    palette = blended.palette(arguments.sources)
    if palette.grid != matrix.grid:
        raise NpfmError(
            f"{arguments.scene}: built for the grid {matrix.grid.name}, and the fits are on "
            f"{palette.grid.name}; build it for theirs"
        )
    chosen = blended.BLENDS[arguments.blend]
    at = blended.reading(palette.grid)
    return products.render_products(matrix, at, lambda pixels: chosen(palette, parts[pixels]))


def _texture(path: str) -> np.ndarray:
    """Brightness of a picture, from 0 to 1."""
    from PIL import Image

    try:
        with Image.open(path, formats=FORMATS) as image:
            check_size(path, *image.size)
            if image.mode[0] in "IF":  # more than 8 bits, which would be cut off and not scaled
                raise NpfmError(f"{path}: a picture of mode {image.mode}; give one of 8 bits")
            return np.asarray(image.convert("L"), dtype=float) / 255
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise NpfmError(f"{path}: cannot be read as a picture ({error}); give a PNG") from error
