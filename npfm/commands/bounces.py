"""``npfm bounces``."""

import argparse
import json
import sys

from npfm.commands.numbers import positive, whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import bounces, tables
from npfm.exports.mitsuba import engine
from npfm.fitting.sources import table
from npfm.storage.bounds import check_size
from npfm.storage.files import replacing
from npfm.storage.pictures import EXR, write_exr_parts

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.evaluation.bounces",
    "npfm.evaluation.tables",
)
CODE_OF_KIND = {
    "render": (
        "npfm.fitting.sources",
        "npfm.exports.mitsuba.engine",
        "npfm.exports.mitsuba.study",
    ),
}
EXAMPLE = """\
examples:
  python -m npfm bounces render --sampling factored --tables a.binary b.binary c.binary d.binary \\
      e.binary --fits a.npz b.npz c.npz d.npz e.npz -o factored.exr --record factored.json
  python -m npfm bounces render --reference --paths 4096 --tables ... -o reference.exr \\
      --record reference.json
  python -m npfm bounces table reference.exr cosine.exr factored.exr -o bounces.csv
renders the project's still life, of five materials (cove, bowl, figure, balls, vase), by paths that
meet its lamps by chance, as many as --paths a pixel and as many as take --seconds; and compares.
Needs Mitsuba 3: pip install 'npfm[mitsuba]'.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="render|table")
    render = kinds.add_parser("render")
    render.add_argument("--tables", nargs=5, required=True, help="of each part: files, or fits")
    render.add_argument("--fits", nargs=5, help="fits that the directions follow")
    render.add_argument("--sampling", default="per-view", help="what chooses directions")
    render.add_argument(
        "--reference", action="store_true", help="look for the lamps at every point as well"
    )
    render.add_argument("--resolution", type=whole(1), default=96, help="pixels along a side")
    render.add_argument("--paths", type=whole(2), default=64, help="a pixel")
    render.add_argument("--seconds", type=positive, help="CPU time of a second picture")
    render.add_argument("--seed", type=whole(0), default=1, help="of the paths (default: 1)")
    render.add_argument("--record", type=output(bounces.RECORD), required=True, help="JSON")
    render.add_argument(
        "-o", "--output", type=output(EXR), required=True, help="EXR: pictures, as parts"
    )
    gather = kinds.add_parser("table")
    gather.add_argument("reference", help="EXR made with --reference; its record is beside it")
    gather.add_argument("pictures", nargs="+", help="EXRs of samplers; their records beside them")
    gather.add_argument(
        "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
    )


def run(arguments: argparse.Namespace) -> str | None:
    """Render, or compare."""
    if arguments.kind == "table":
        tables.write(arguments.output, bounces.table(arguments.reference, arguments.pictures))
        return None
    check_size(arguments.output, arguments.resolution, arguments.resolution)
    engine.start()
    if advice := engine.advice():
        print(f"npfm bounces: warning: {advice}", file=sys.stderr)
    from npfm.exports.mitsuba import plugin, study

    materials = [table(path) for path in arguments.tables]
    fits = arguments.fits or [None] * len(materials)
    samplers = [
        plugin.sampler(material, arguments.sampling, fit)
        for material, fit in zip(materials, fits, strict=True)
    ]
    world = study.world(materials, samplers, lamps_sampled=arguments.reference)
    # The first paths are compiled for.
    study.render(world, arguments.resolution, 2, arguments.seed)
    made = study.render(world, arguments.resolution, arguments.paths, arguments.seed)
    if not made.mean.any():
        raise NpfmError("no path has met a lamp; use more --paths")
    parts = {"samples": made.mean, "variance": made.variance}
    record = {"paths": made.paths, "seconds": made.seconds, "seconds_paths": 0}
    if arguments.seconds:
        number = max(2, round(arguments.seconds / made.seconds * made.paths))
        timed = study.render(world, arguments.resolution, number, arguments.seed + 1)
        parts["seconds"] = timed.mean
        record |= {"seconds_paths": timed.paths}
    write_exr_parts(arguments.output, parts)
    with replacing(arguments.record, bounces.RECORD) as temporary:
        temporary.write_text(json.dumps(record, indent=1) + "\n")
    return f"{made.paths} paths a pixel, {made.seconds:.1f} s"
