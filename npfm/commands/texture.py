"""``npfm texture``."""

import argparse

from npfm.commands.outputs import output
from npfm.exports.sources import Source
from npfm.exports.texture import KIND, write

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.exports.texture",
)
EXAMPLE = """\
example:
  python -m npfm texture chrome.npz nylon.npz -o texture.exr
writes float32 RGB: a column each fit, and from top to bottom rho_d and rho_s (1/sr), D by the bins
of theta_h, G by degrees and F by the bins of theta_d. The header tells the names and rows.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("fits", nargs="+", help="fits (.npz) of independent-g")
    parser.add_argument(
        "-o", "--output", type=output(KIND), required=True, help="picture to write (.exr)"
    )


def run(arguments: argparse.Namespace) -> None:
    """Write the texture."""
    write(arguments.output, [Source(path) for path in arguments.fits])
