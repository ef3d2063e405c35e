"""``npfm interreflect``."""

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.exports.mitsuba import engine
from npfm.fitting.sources import table
from npfm.reflectance.table_files import read_table
from npfm.rendering import scenes
from npfm.rendering.lights import environment
from npfm.storage import pictures
from npfm.storage.bounds import check_size
from npfm.storage.files import Kind, marked, replacing

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.exports.mitsuba.engine",
    "npfm.exports.mitsuba.interreflection",
    "npfm.rendering.lights.environment",
    "npfm.reflectance.table_files",
    "npfm.rendering.sampling.per_view",
    "npfm.storage.pictures",
)
EXAMPLE = """\
examples:
  python -m npfm interreflect chrome.binary --light ennis.exr --objects figure sphere \\
      --mesh buddha.ply --effects antialiasing -o chrome-bounced.exr
  python -m npfm interreflect chrome.npz --measured chrome.binary --light ennis.exr \\
      --objects figure sphere -o fitted-bounced.exr
writes the radiance of light that comes to what the camera sees over other points of the objects,
without that which comes there straight from the environment. npfm render --bounced adds it to a
picture of the same scene. Needs Mitsuba 3: pip install 'npfm[mitsuba]'.
With --measured, cells without a measurement are black, and the fit is rendered along the paths of
the measurement, so that a perfect fit makes the same picture.
"""
RECORD = Kind("a record of light that bounces", ".json", marked(b'"paths"', b'"error"'))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("source", help="MERL .binary file, or fit (.npz)")
    parser.add_argument("--measured", help="MERL .binary file that the fit was made from")
    parser.add_argument("--light", required=True, help="lat-long EXR, made by npfm light")
    parser.add_argument("--objects", nargs="+", required=True, help=" and ".join(scenes.OBJECTS))
    parser.add_argument("--mesh", type=Path, help="mesh of the figure, if it is not ours")
    parser.add_argument(
        "--effects", nargs="+", default=[], help="as the scene has them; antialiasing counts"
    )
    parser.add_argument(
        "--resolution", type=whole(1), default=128, help="pixels along one side (default: 128)"
    )
    parser.add_argument(
        "--paths", type=whole(1), default=256, help="of light, a pixel (default: %(default)s)"
    )
    parser.add_argument("--seed", type=whole(0), default=1, help="of the paths (default: 1)")
    parser.add_argument("--record", type=output(RECORD), help="JSON to write: cost and noise")
    parser.add_argument(
        "-o", "--output", type=output(pictures.EXR), required=True, help="EXR to write"
    )


def run(arguments: argparse.Namespace) -> str:
    """Follow the paths; what they came to, in a line."""
    scene = scenes.Scene(tuple(arguments.objects), tuple(arguments.effects), arguments.mesh)
    check_size(arguments.output, arguments.resolution, arguments.resolution)
    engine.start()
    if advice := engine.advice():
        print(f"npfm interreflect: warning: {advice}", file=sys.stderr)
    from npfm.exports.mitsuba import interreflection, plugin

    measured = read_table(arguments.measured) if arguments.measured else None
    material = table(arguments.source)
    if measured:
        material = material.where_measured(measured)
    light = environment.read(arguments.light)
    began = time.process_time()
    found = interreflection.bounced(
        scene,
        light,
        material,
        plugin.sampler(measured or material),
        arguments.resolution,
        arguments.paths,
        arguments.seed,
    )
    record = {
        "paths": found.paths,
        "lost": found.lost,
        "depth": interreflection.DEPTH,
        "seconds": time.process_time() - began,
        "error": float(np.sqrt(np.mean(found.error**2))),
        "mean": float(found.radiance.mean()),
    }
    pictures.write_exr(arguments.output, found.radiance)
    if arguments.record:
        with replacing(arguments.record, RECORD) as temporary:
            temporary.write_text(json.dumps(record, indent=1) + "\n")
    share = record["error"] / (record["mean"] or 1.0)
    return f"{found.paths} paths, noise {share:.1%} of the mean, {record['seconds']:.1f} s"
