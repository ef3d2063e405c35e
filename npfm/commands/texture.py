"""``npfm texture``."""

import argparse
from pathlib import Path

from npfm.exports.texture import labels, texture
from npfm.fitting import fits
from npfm.storage.pictures import write_exr

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
    parser.add_argument("-o", "--output", required=True, help="picture to write (.exr)")


def run(arguments: argparse.Namespace) -> None:
    """Write the texture."""
    loaded = {Path(path).stem: fits.load(path) for path in arguments.fits}
    write_exr(arguments.output, texture(loaded), labels(loaded))
