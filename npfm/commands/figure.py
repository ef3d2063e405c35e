"""``npfm figure``."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager

from npfm import tables
from npfm.errors import NpfmError
from npfm.figures import figure08, page, style

EXAMPLE = """\
examples:
  python -m npfm figure figure08 --psnr psnr.csv --materials materials.csv \\
      --order diffuseness -o figure08_by_diffuseness.pdf figure08_by_diffuseness.png
  python -m npfm figure page --run results/smoke --psnr psnr.csv --material car-paint \\
      --scenes A B --variants independent-g naive -o car-paint.png
PSNR is in dB; the same tables and pictures give the same bytes.
"""
FIGURES = {
    "figure08": "PSNR (dB) of every material and variant, mean over the scenes and in each of them",
    "page": "pictures of one material, measured and fitted, one row a scene",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    figures = parser.add_subparsers(dest="figure", required=True, metavar="figure")
    chosen = {}
    for name, contents in FIGURES.items():
        chosen[name] = figures.add_parser(
            name,
            help=contents,
            description=f"{contents[0].upper()}{contents[1:]}.",
            epilog=EXAMPLE,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        chosen[name].add_argument("--psnr", required=True, help="CSV made by npfm tables psnr")
        chosen[name].add_argument(
            "-o",
            "--output",
            nargs="+",
            required=True,
            help="files to write, .pdf (vector) or .png (300 dpi)",
        )
    chosen["figure08"].add_argument(
        "--order",
        required=True,
        choices=list(figure08.ORDERS),
        help="sort materials by increasing diffuseness, or by decreasing error of independent-g",
    )
    chosen["figure08"].add_argument(
        "--materials", help="CSV made by npfm tables materials; needed for --order diffuseness"
    )
    chosen["page"].add_argument("--run", required=True, help="folder of the run")
    chosen["page"].add_argument("--material", required=True, help="the material")
    chosen["page"].add_argument("--scenes", nargs="+", required=True, help="rows")
    chosen["page"].add_argument("--variants", nargs="+", required=True, help="columns")


def run(arguments: argparse.Namespace) -> None:
    """Draw the figure, and write it."""
    a = arguments
    psnr = tables.read_psnr(a.psnr)
    if a.figure == "page":
        figure = page.draw(a.run, psnr, a.material, a.scenes, a.variants)
    elif a.order == "error":
        with _naming(a.psnr):
            order = figure08.by_error(psnr)
        figure = figure08.draw(psnr, order, figure08.ORDERS[a.order])
    elif a.materials:
        materials = tables.read(a.materials, ["material"], ["diffuseness"])
        with _naming(a.materials):
            order = figure08.by_diffuseness(psnr, materials)
        figure = figure08.draw(psnr, order, figure08.ORDERS[a.order])
    else:
        raise NpfmError("--order diffuseness needs --materials; make it with npfm tables materials")
    style.save(figure, a.output)


@contextmanager
def _naming(path: str) -> Iterator[None]:
    try:
        yield
    except NpfmError as error:
        raise NpfmError(f"{path}: {error}") from error
