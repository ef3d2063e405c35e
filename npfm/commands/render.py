"""``npfm render``."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.fitting.sources import table
from npfm.reflectance.table_files import read_table
from npfm.rendering import transport
from npfm.storage import pictures

T = TypeVar("T")
#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.rendering.transport",
    "npfm.storage.pictures",
)
EXAMPLE = """\
examples:
  python -m npfm render scene-a chrome.binary -o measured.exr
  python -m npfm render scene-a chrome.npz --measured chrome.binary -o independent-g.exr
  python -m npfm render scene-a scene-b chrome.npz -o in-a.exr in-b.exr --exposure 0.02 1
  python -m npfm render scene-b chrome.binary --bounced chrome-bounced.exr -o measured.exr
writes linear radiance (RGB, and the coverage by objects as alpha) as measured.exr, and tone-mapped
as measured.png. Where a file of either name is there that npfm did not write, nothing is written.
Of several scenes, each has an output; the table is read, or made from the fit, only once.
With --bounced, the light that npfm interreflect found to come over other objects is added; of
several scenes, SCENE=EXR says to which, as in --bounced scene-b=chrome-bounced.exr.
With --measured, cells without a measurement are black, as they are in the picture of the
measurement: they count neither for nor against the fit.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("scenes", nargs="+", metavar="scene", help="folder made by npfm scene")
    parser.add_argument("source", help="MERL .binary or UTIA .bin file, or fit (.npz)")
    parser.add_argument("--measured", help="file that the fit was made from")
    parser.add_argument(
        "--bounced", nargs="+", default=[], help="EXR made by npfm interreflect, to be added"
    )
    parser.add_argument(
        "--exposure",
        type=positive,
        nargs="+",
        default=[0.02],
        help="of the PNG, factor: one for all scenes, or one for each (default: 0.02)",
    )
    parser.add_argument(
        "--gamma",
        type=positive,
        nargs="+",
        default=[2.2],
        help="of the PNG, exponent: one for all scenes, or one for each (default: 2.2)",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output(pictures.EXR, beside=pictures.PNG),
        nargs="+",
        required=True,
        help="EXR to write, one for each scene",
    )


def run(arguments: argparse.Namespace) -> None:
    """Render in one scene after another."""
    scenes = arguments.scenes
    outputs = _for_each(scenes, "--output", arguments.output)
    exposures = _for_each(scenes, "--exposure", arguments.exposure, one_for_all=True)
    gammas = _for_each(scenes, "--gamma", arguments.gamma, one_for_all=True)
    added = _added(scenes, arguments.bounced)
    material = table(arguments.source)
    if arguments.measured:
        material = material.where_measured(read_table(arguments.measured))
    for scene, out, exposure, gamma in zip(scenes, outputs, exposures, gammas, strict=True):
        matrix = transport.load(scene)
        light = transport.reflected(matrix, material)
        if scene in added:
            light += _bounced(added[scene], light.shape[:2])
        pictures.write_exr(out, transport.over_backdrop(matrix, light))
        layers = [(light, matrix.coverage), (matrix.backdrop, 1 - matrix.coverage)]
        png = pictures.tone_map_layers(layers, exposure, gamma)
        pictures.write_png(Path(out).with_suffix(".png"), png)


def _for_each(
    scenes: Sequence[str], name: str, given: Sequence[T], one_for_all: bool = False
) -> Sequence[T]:
    """What was given for each of the scenes, in order."""
    if one_for_all and len(given) == 1:
        return [*given] * len(scenes)
    if len(given) != len(scenes):
        raise NpfmError(f"{name}: {len(given)} for {len(scenes)} scenes; give one for each scene")
    return given


def _added(scenes: Sequence[str], given: Sequence[str]) -> dict[str, str]:
    """Light that bounces, as a file, by the scene that it is added in."""
    if len(scenes) == 1 == len(given):
        return {scenes[0]: given[0].removeprefix(f"{scenes[0]}=")}
    found: dict[str, str] = {}
    for word in given:
        scene = next((name for name in scenes if word.startswith(f"{name}=")), None)
        if scene is None or scene in found:
            raise NpfmError(f"--bounced: {word}: give SCENE=EXR, once for any of the scenes")
        found[scene] = word.removeprefix(f"{scene}=")
    return found


def _bounced(path: str, shape: tuple[int, ...]) -> NDArray[np.float32]:
    added = pictures.read_exr(path)[..., :3]
    if added.shape[:2] != shape:
        rows, columns = added.shape[:2]
        raise NpfmError(
            f"{path}: {columns} x {rows} pixels, and the scene has {shape[1]} x {shape[0]}; "
            "render it again with npfm interreflect"
        )
    return added
