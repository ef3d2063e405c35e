"""``npfm scene``."""

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

from npfm.commands.numbers import positive, whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.reflectance import grids
from npfm.reflectance.half_difference import MERL
from npfm.rendering import assembly, effects, scenes, transport
from npfm.rendering.lights import environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.storage.bounds import check_size
from npfm.storage.files import Kind, marked, replacing

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.rendering.assembly",
    "npfm.rendering.transport",
    "npfm.rendering.lights.environment",
    "npfm.rendering.sampling.registry",
)
EXAMPLE = """\
example:
  python -m npfm scene --light grace.exr --objects sphere -o scene-a
  python -m npfm scene --light ennis.exr --objects figure sphere --mesh buddha.ply \\
      --effects visibility antialiasing -o scene-b
writes a folder with the transport matrix: for every pixel, the weight (radiance per BRDF, the BRDF
in 1/sr) of each cell of a MERL table. Rendering is then one product a material.
  python -m npfm scene --light grace.exr --turn 90 --objects sphere -o scene-a-90
stands in the same light, turned: what the camera saw behind the sphere is to the right of it.
  python -m npfm scene --light grace.exr --objects cloth --grid directional -o hanging
is for UTIA .bin files; with a shape, --grid directional 12x96x12x96, for finer ones.
"""

BUILT = [name for name, effect in effects.EFFECTS.items() if not effect.bounces]
RECORD = Kind("a record of a scene", ".json", marked(b'"effects"', b'"rays"', b'"nonzeros"'))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("--light", required=True, help="lat-long EXR, made by npfm light")
    parser.add_argument(
        "--turn",
        type=_degrees,
        default=0.0,
        metavar="DEGREES",
        help="turn the light about the vertical, clockwise as seen from above (default: 0)",
    )
    parser.add_argument("--objects", nargs="+", required=True, help=" and ".join(scenes.OBJECTS))
    parser.add_argument(
        "--grid",
        nargs="+",
        default=[MERL.kind],
        metavar="WORD",
        help="of the tables to be rendered: half-difference (MERL's) or directional (UTIA's), "
        "and its shape if that is not theirs (default: half-difference)",
    )
    parser.add_argument("--effects", nargs="+", default=[], help=" and ".join(BUILT))
    parser.add_argument(
        "--mesh", type=Path, help="mesh of the figure: PLY, OBJ, STL, glTF (default: ours)"
    )
    parser.add_argument(
        "--resolution",
        type=whole(1),
        default=128,
        help="pixels along one side (default: %(default)s)",
    )
    parser.add_argument(
        "--samples",
        type=whole(1),
        default=4096,
        help="light directions a pixel (default: %(default)s)",
    )
    parser.add_argument(
        "--sampling",
        nargs="+",
        default=list(scenes.STRATEGIES),
        metavar="STRATEGY",
        help="how light directions are chosen, several combined: "
        f"{', '.join(registry.for_any_material())} (default: {' '.join(scenes.STRATEGIES)})",
    )
    parser.add_argument(
        "--power",
        type=positive,
        default=1,
        help="power of the heuristic that combines them; 1 is the balance heuristic (default: 1)",
    )
    parser.add_argument(
        "--seed", type=whole(0), default=1, help="seed of the sampling (default: 1)"
    )
    parser.add_argument(
        "--record",
        type=output(RECORD),
        help="JSON to write: what was built, and its CPU seconds, shadow rays, non-zeros and bytes",
    )
    parser.add_argument(
        "-o", "--output", type=output(transport.SCENE), required=True, help="folder to write"
    )


def _degrees(text: str) -> float:
    """Type of an angle."""
    try:
        angle = float(text)
    except ValueError:
        angle = float("nan")
    if not -360 <= angle <= 360:
        raise argparse.ArgumentTypeError(f"'{text}': give a number from -360 to 360")
    return angle


def run(arguments: argparse.Namespace) -> str:
    """Build the transport matrix; what it came to, in a line."""
    scene = scenes.Scene(tuple(arguments.objects), tuple(arguments.effects), arguments.mesh)
    for warning in scene.warnings:
        print(f"npfm scene: warning: {warning}", file=sys.stderr)
    if scene.bounces:
        raise NpfmError(
            "'interreflection' is no part of a matrix; leave it out here, "
            "and add it to each picture by npfm interreflect and npfm render --bounced"
        )
    grid = grids.parse(arguments.grid)
    registry.check_scene(arguments.sampling)
    check_size(arguments.output, arguments.resolution, arguments.resolution)
    light = environment.read(arguments.light)
    if arguments.turn:
        light = environment.turned(light, arguments.turn)
    counts = Counter(rays=0)
    # CPU time: one thread builds, and other jobs beside it do not make it cost more.
    began = time.process_time()
    matrix = assembly.build(
        scene,
        light,
        grid,
        arguments.resolution,
        arguments.samples,
        arguments.seed,
        registry.make(arguments.sampling, Given(light, grid)),
        arguments.power,
        counts,
    )
    record = {
        "effects": scene.simulated,
        "grid": grid.name,
        "sampling": arguments.sampling,
        "power": arguments.power,
        "samples": arguments.samples,
        "resolution": arguments.resolution,
        "seconds": time.process_time() - began,
        "rays": counts["rays"],
        "nonzeros": matrix.indices.size,
        "bytes": sum(array.nbytes for array in matrix.arrays.values()),
    }
    transport.save(arguments.output, matrix)
    if arguments.record:
        with replacing(arguments.record, RECORD) as temporary:
            temporary.write_text(json.dumps(record, indent=1) + "\n")
    return (
        f"{record['rays']} shadow rays, {record['nonzeros']} entries, "
        f"{record['bytes'] / 1e6:.0f} MB, {record['seconds']:.1f} s"
    )
