"""``npfm tabulate``."""

import argparse

from npfm.commands.outputs import output
from npfm.fitting.registry import tabulated
from npfm.reflectance.table_files import KINDS, write_table

EXAMPLE = """\
example:
  python -m npfm tabulate chrome.npz -o chrome-fitted.binary
writes the fit's values at all cells of the MERL grid, a BRDF in 1/sr in MERL's own scaling, for any
program that reads MERL files; and a fit of a UTIA .bin file as such, a BRDF in 1/sr as it is.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("fit", help="fit (.npz)")
    parser.add_argument(
        "-o",
        "--output",
        type=output(*KINDS),
        required=True,
        help="MERL .binary file to write, or UTIA .bin file",
    )


def run(arguments: argparse.Namespace) -> None:
    """Tabulate the fit."""
    write_table(arguments.output, tabulated(arguments.fit))
