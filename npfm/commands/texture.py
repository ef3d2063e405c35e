"""``npfm texture``."""

import argparse
from pathlib import Path

from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.exports.texture import labels, texture
from npfm.fitting import fits
from npfm.storage.names import distinct
from npfm.storage.pictures import EXR, write_exr

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.exports.texture",
    "npfm.storage.names",
    "npfm.storage.pictures",
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
        "-o", "--output", type=output(EXR), required=True, help="picture to write (.exr)"
    )


def run(arguments: argparse.Namespace) -> None:
    """Write the texture."""
    names = distinct(Path(path).stem for path in arguments.fits)
    if wrong := [name for name in names if name.split() != [name]]:
        raise NpfmError(f"'{wrong[0]}': blanks stand between names in the header; rename the fit")
    loaded = dict(zip(names, map(fits.load, arguments.fits), strict=True))
    write_exr(arguments.output, texture(loaded), labels(loaded))
