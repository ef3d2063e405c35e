"""``npfm reproduction``."""

import argparse
import os
from pathlib import Path

from npfm.commands.outputs import output
from npfm.evaluation import importance, psnr_level, tables
from npfm.evaluation.head_to_head import renderings as by_rendering
from npfm.figures import figure10, renderings
from npfm.papers import page
from npfm.papers.evidence import Evidence, starts

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.evaluation.tables",
    "npfm.evaluation.head_to_head",
    "npfm.evaluation.importance",
    "npfm.evaluation.psnr_level",
    "npfm.figures.figure10",
    "npfm.papers.page",
    "npfm.papers.evidence",
)
#: Columns of text that claims need of the table of fits.
FITS = ["material", "variant", "status"]
#: Columns of text and of numbers that they need of the table of fidelity.
FIDELITY = (["material", "variant"], ["rendering_db", "rendering_8_bit_db"])
EXAMPLE = """\
example:
  python -m npfm reproduction --run results/neural-10 --dataset neural \\
      --psnr results/neural-10/tables/psnr.csv --summary results/neural-10/tables/summary.csv \\
      --materials results/neural-10/tables/materials.csv \\
      --figures results/neural-10/figures/figure12.png -o results/neural-10/reproduction.md
A claim that needs a table which is not given is said to be untestable. PSNR is in dB.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    add = parser.add_argument
    add("--run", required=True, help="folder of the run, with fits and pictures")
    add("--dataset", required=True, choices=list(page.TABLES), help="where its materials are from")
    add("--psnr", required=True, help="CSV made by npfm tables psnr")
    add("--summary", required=True, help="CSV made by npfm tables summary")
    add("--materials", help="CSV made by npfm tables materials")
    add("--weighting", help="CSV made by npfm tables psnr, with and without compressive weight")
    add("--fits", help="CSV made by npfm tables fits")
    add("--variance", help="CSV made by npfm importance table")
    add("--fidelity", help="CSV made by npfm tables fidelity")
    add("--published", help="CSV made by npfm tables published")
    add("--levels", help="CSV made by npfm psnr-level table")
    add("--figures", nargs="*", default=[], help="figures (.png) to show beside the claims")
    add("-o", "--output", type=output(page.PAGE), required=True, help="Markdown file to write")


def run(arguments: argparse.Namespace) -> None:
    """Put the claims to the tables, and write the page."""
    a = arguments
    folder = Path(a.output).parent
    figures = [Path(os.path.relpath(path, folder)).as_posix() for path in a.figures]
    distance = tables.read_published(a.published) if a.published else None
    levels = psnr_level.read_levels(a.levels) if a.levels else None
    page.write(a.output, Path(a.run).name, a.dataset, _evidence(a), figures, distance, levels)


def _evidence(a: argparse.Namespace) -> Evidence:
    psnr = tables.read_psnr(a.psnr)
    summary = tables.read(a.summary, ["variant"], ["bytes"])
    diffuseness = None
    if a.materials:
        materials = tables.read(a.materials, ["material"], ["diffuseness"])
        diffuseness = materials.set_index("material")["diffuseness"]
    ours = psnr[psnr["variant"] == "independent-g"].dropna(subset="psnr_db")
    rows = [renderings.Row(*row) for row in by_rendering(ours, ["independent-g"]).index]
    return Evidence(
        psnr=psnr,
        bytes=summary.drop_duplicates("variant").set_index("variant")["bytes"],
        diffuseness=diffuseness,
        starts=starts(a.run, ours["material"].unique()),
        weighting=tables.read_psnr(a.weighting) if a.weighting else None,
        fits=tables.read(a.fits, FITS, ["seconds"]) if a.fits else None,
        variance=importance.read(a.variance) if a.variance else None,
        fidelity=tables.read(a.fidelity, *FIDELITY) if a.fidelity else None,
        worst=[row.material for row in figure10.worst(a.run, rows, "independent-g")],
    )
