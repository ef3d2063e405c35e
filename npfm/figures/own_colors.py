"""Colours that the user gives variants; apart from what draws, which asks for nothing of it."""

import argparse
import re

from npfm.errors import NpfmError


def add_colors(parser: argparse.ArgumentParser) -> None:
    """Declare ``--colors``, which `colors` reads."""
    parser.add_argument(
        "--colors",
        nargs="+",
        default=[],
        metavar="NAME=#RRGGBB",
        help="colours of variants, in place of the project's",
    )


def colors(arguments: argparse.Namespace) -> dict[str, str]:
    """Return the colours that ``--colors`` names, by variant.

    Raises
    ------
    NpfmError
        If one is not written NAME=#RRGGBB.
    """
    for given in arguments.colors:
        if not re.fullmatch("[^=]+=#[0-9A-Fa-f]{6}", given):
            raise NpfmError(f"--colors: '{given}' is not written NAME=#RRGGBB")
    return dict(given.split("=") for given in arguments.colors)
