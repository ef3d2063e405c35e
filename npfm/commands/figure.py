"""``npfm figure``."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager

from npfm import tables
from npfm.errors import NpfmError
from npfm.figures import figure08, style

EXAMPLE = """\
example:
  python -m npfm figure figure08 --psnr psnr.csv --materials materials.csv \\
      --order diffuseness -o figure08_by_diffuseness.pdf figure08_by_diffuseness.png
draws PSNR in dB; the same tables give the same bytes.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    figures = parser.add_subparsers(dest="figure", required=True, metavar="figure")
    contents = "PSNR (dB) of every material and variant, mean over the scenes and in each of them"
    chosen = figures.add_parser(
        "figure08",
        help=contents,
        description=f"{contents}.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    chosen.add_argument("--psnr", required=True, help="CSV made by npfm tables psnr")
    chosen.add_argument(
        "--order",
        required=True,
        choices=list(figure08.ORDERS),
        help="sort materials by increasing diffuseness, or by decreasing error of independent-g",
    )
    chosen.add_argument(
        "--materials", help="CSV made by npfm tables materials; needed for --order diffuseness"
    )
    chosen.add_argument(
        "-o",
        "--output",
        nargs="+",
        required=True,
        help="files to write, .pdf (vector) or .png (300 dpi)",
    )


def run(arguments: argparse.Namespace) -> None:
    """Draw the figure, and write it."""
    psnr = tables.read_psnr(arguments.psnr)
    if arguments.order == "error":
        with _naming(arguments.psnr):
            order = figure08.by_error(psnr)
    elif arguments.materials:
        materials = tables.read(arguments.materials, ["material"], ["diffuseness"])
        with _naming(arguments.materials):
            order = figure08.by_diffuseness(psnr, materials)
    else:
        raise NpfmError("--order diffuseness needs --materials; make it with npfm tables materials")
    style.save(figure08.draw(psnr, order, figure08.ORDERS[arguments.order]), arguments.output)


@contextmanager
def _naming(path: str) -> Iterator[None]:
    try:
        yield
    except NpfmError as error:
        raise NpfmError(f"{path}: {error}") from error
