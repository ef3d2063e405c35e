"""``npfm figure``."""

import argparse
from types import ModuleType

from npfm.figures import style

EXAMPLE = """\
examples:
  python -m npfm figure figure08 --psnr psnr.csv --materials materials.csv \\
      --order diffuseness -o figure08_by_diffuseness.pdf figure08_by_diffuseness.png
  python -m npfm figure page --run results/smoke --psnr psnr.csv --material car-paint \\
      --scenes A B --variants independent-g naive -o car-paint.png
  python -m npfm figure convergence --traces traces.csv -o convergence.pdf
PSNR is in dB; the same tables and pictures give the same bytes.
"""
FIGURES = {
    "figure08": "PSNR (dB) of every material and variant, mean over the scenes and in each of them",
    "page": "pictures of one material, measured and fitted, one row a scene",
    "figure09": "renderings of the non-parametric fits, with PSNR (dB) and close-ups",
    "figure10": "renderings of the materials that the first variant fits worst",
    "figure11": "renderings where the bivariate model gains most, and where it loses most",
    "figure12": "renderings against the models of Loew, and how many of them ours wins",
    "figure13": "renderings against the factorisation of Bilgili, and how many of them ours wins",
    "figure14": "error of the radiance at every pixel, as a share of the largest of ours",
    "convergence": "objective against seconds, every start by both solvers",
    "pareto": "mean PSNR (dB) against mean seconds of a fit, and against its bytes",
    "settings": "PSNR (dB) and seconds against the number of starts and the tolerance",
    "sampling": "error of pictures (dB) against samples a pixel and seconds",
}


def _figure(name: str) -> ModuleType:
    """Return the module of a figure: `add_arguments`, and `make` from what they say."""
    match name:
        case "figure08":
            from npfm.figures import figure08 as module
        case "page":
            from npfm.figures import page as module
        case "figure09":
            from npfm.figures import figure09 as module
        case "figure10":
            from npfm.figures import figure10 as module
        case "figure11":
            from npfm.figures import figure11 as module
        case "figure12":
            from npfm.figures import figure12 as module
        case "figure13":
            from npfm.figures import figure13 as module
        case "figure14":
            from npfm.figures import figure14 as module
        case "convergence":
            from npfm.figures import convergence as module
        case "pareto":
            from npfm.figures import pareto as module
        case "settings":
            from npfm.figures import settings as module
        case "sampling":
            from npfm.figures import sampling as module
    return module


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    figures = parser.add_subparsers(dest="figure", required=True, metavar="figure")
    for name, contents in FIGURES.items():
        chosen = figures.add_parser(
            name,
            help=contents,
            description=f"{contents[0].upper()}{contents[1:]}.",
            epilog=EXAMPLE,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        _figure(name).add_arguments(chosen)
        chosen.add_argument(
            "-o",
            "--output",
            nargs="+",
            required=True,
            help="files to write, .pdf (vector) or .png (300 dpi)",
        )


def run(arguments: argparse.Namespace) -> None:
    """Draw the figure, and write it."""
    style.save(_figure(arguments.figure).make(arguments), arguments.output)
