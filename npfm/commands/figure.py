"""``npfm figure``."""

import argparse
import importlib
from collections.abc import Sequence
from types import ModuleType
from typing import Any

from npfm.commands.outputs import output
from npfm.figures import style

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.figures.style",
)
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
    "figure03": "weights of the objective (share of the largest) over the three angles",
    "figure04": "the compressive function",
    "figure05": "measured and fitted BRDF at phi_d = 90 degrees, tone-mapped",
    "figure06": "factors D, G and F (relative), beside the published ones",
    "figure07": "pictures of fits with and without the compressive weight, with PSNR (dB)",
    "figure08": "PSNR (dB) of every material and variant, mean over the scenes and in each of them",
    "figure09": "renderings of the non-parametric fits, with PSNR (dB) and close-ups",
    "figure10": "renderings of the materials that the first variant fits worst",
    "figure11": "renderings where the bivariate model gains most, and where it loses most",
    "figure12": "renderings against the models of Loew, and how many of them ours wins",
    "figure13": "renderings against the factorisation of Bilgili, and how many of them ours wins",
    "figure14": "error of the radiance at every pixel, as a share of the largest of ours",
    "figure15": "pictures of fits to the full and to a restricted range of angles, with PSNR (dB)",
    "figure16": "the texture of npfm texture, each parameter by its logarithm",
    "fidelity": "PSNR (dB) of every material's pictures and table, by two peaks",
    "where": "where the error of fits sits, by angles of the table and by the slant of a surface",
    "page": "pictures of one material, measured and fitted, one row a scene",
    "convergence": "objective against seconds, every start by both solvers",
    "pareto": "mean PSNR (dB) against mean seconds of a fit, and against its bytes",
    "settings": "PSNR (dB) and seconds against the number of starts and the tolerance",
    "blends": "a material that changes over an object, and mixtures half way, by ways of blending",
    "bounces": "a still life by paths, whose directions are chosen in several ways",
    "effects_cost": "what each effect costs in each scene, and where it changes the picture",
    "psnr_level": "PSNR (dB) by foreground, resolution and turn of the light, beside the paper's",
    "importance": "variance of every way of sampling, for every material, as maps",
    "improvement": "variance of ways of sampling over that of factored sampling, and as printed",
    "variance_samples": "variance of every way of sampling against samples a pixel",
    "variance_images": "variance of ways of sampling over the picture",
    "estimators": "what estimators of several strategies gain on the renderer's",
    "sampling": "error of pictures (dB) against samples a pixel and seconds",
    "delta_e": "colour differences (CIEDE2000) of each variant's pictures, mean over the materials",
    "extraction_time": "seconds of the power iterations against the number of samples",
    "shared_lobes_psnr": "PSNR (dB) of every material, sorted by independent-g, and the wins",
    "shared_lobes_factors": "D and G of shared lobes and F of the channels, against degrees",
    "shared_lobes_sampling": "error of pictures by cosine, by D and by both, against directions",
    "basis": "objective and PSNR (dB) of fits in curves of other materials, by their number",
    "basis_curves": "the mean D, F and G of many materials, and how the first curves change them",
    "uniqueness": "how far apart factors of equally good fits lie, and those of one material",
    "factorisation_steps": "how a BRDF is factored: slices, the matrix, and its factors",
    "factorisation_terms": "error of factors by the number of terms of both factorisations",
    "point_light": "spheres in the light of one direction, by a BRDF and by its factors",
    "side_by_side": "materials measured and by each variant, with colour differences",
    "perception": "how well every metric orders fits as people do (Spearman's correlation)",
    "roughness": "materials made smoother and rougher",
}


def _figure(name: str) -> ModuleType:
    """Return the module of a key of `FIGURES`: `add_arguments`, and `make` from what they say."""
    return importlib.import_module(f"npfm.figures.{name}")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE

    # Of the verb's own class, so that its complaints are told as the verb's are.
    class Figure(type(parser)):  # type: ignore[misc]
        """Knows the arguments of its figure once it is asked: only that figure is imported."""

        figure = ""

        def parse_known_args(
            self, args: Sequence[str] | None = None, namespace: Any = None
        ) -> tuple[Any, list[str]]:
            _figure(self.figure).add_arguments(self)
            return super().parse_known_args(args, namespace)

    figures = parser.add_subparsers(
        dest="figure", required=True, metavar="figure", parser_class=Figure
    )
    for name, contents in FIGURES.items():
        chosen = figures.add_parser(
            name,
            help=contents,
            description=f"{contents[0].upper()}{contents[1:]}.",
            epilog=EXAMPLE,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        chosen.figure = name
        chosen.add_argument(
            "-o",
            "--output",
            type=output(*style.KINDS.values()),
            nargs="+",
            required=True,
            help="files to write, .pdf (vector) or .png (300 dpi)",
        )


def run(arguments: argparse.Namespace) -> None:
    """Draw the figure, and write it."""
    style.save(_figure(arguments.figure).make(arguments), arguments.output)
