"""``npfm light``."""

import argparse

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.rendering.lights import environment
from npfm.storage.bounds import check_size
from npfm.storage.pictures import EXR

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.rendering.lights.environment",
)
#: And what it covers for some of the kinds.
CODE_OF_KIND = {
    "generate": ("npfm.rendering.lights.generated",),
    "file": ("npfm.rendering.lights.formats",),
}
EXAMPLE = """\
examples:
  python -m npfm light grace_probe.hdr --layout angular-map --height 512 -o grace.exr
  python -m npfm light --generate grove --height 512 -o grove.exr
The result is a lat-long map of HEIGHT x 2 HEIGHT texels of linear radiance; its centre is the
direction the camera looks in. What is read of .hdr and .exr files, and what is refused, is told in
docs/data.md.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("probe", nargs="?", help="light probe, .hdr or .exr")
    source.add_argument("--generate", metavar="NAME", help="a light that the project makes")
    parser.add_argument("--layout", help="angular-map, vertical-cross or lat-long")
    parser.add_argument("--height", type=whole(1), default=512, help="rows (default: 512)")
    parser.add_argument(
        "-o", "--output", type=output(EXR), required=True, help="lat-long EXR to write"
    )


def run(arguments: argparse.Namespace) -> None:
    """Convert or generate."""
    check_size(arguments.output, 2 * arguments.height, arguments.height)
    if arguments.generate:
        from npfm.rendering.lights.generated import generate

        light = generate(arguments.generate, arguments.height)
    else:
        from npfm.rendering.lights.formats import LAYOUTS, load_probe

        if not arguments.layout:
            raise NpfmError(
                f"{arguments.probe}: how it maps directions to pixels is not known; give --layout "
                f"{' or '.join(sorted(LAYOUTS))}"
            )

        light = load_probe(arguments.probe, arguments.layout, arguments.height)
    environment.write(arguments.output, light)
