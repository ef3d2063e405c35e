"""``npfm quality``."""

import argparse

from npfm.commands.outputs import output
from npfm.evaluation import quality, tables

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.outputs",
    "npfm.evaluation.quality",
    "npfm.evaluation.tables",
)
#: And what it covers for some of the kinds.
CODE_OF_KIND = {"material": ("npfm.fitting.sources", "npfm.evaluation.quality_of_fits")}
EXAMPLE = """\
examples:
  python -m npfm quality material chrome.binary --run results/smoke --scenes A D \\
      --variants naive bivariate -o chrome.csv
  python -m npfm quality gather chrome.csv felt.csv -o quality.csv
  python -m npfm quality summary quality.csv -o quality_summary.csv
material compares the fits of a material with its measurement by every metric: pictures by PSNR
(dB) of radiance and of display values, SSIM, LDR- and HDR-FLIP, CIEDE2000 and HyAB, over the
object alone; tables by their cube roots and logarithms. docs/quality.md says which to trust.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="material|gather|summary")
    material, gather = kinds.add_parser("material"), kinds.add_parser("gather")
    material.add_argument("table", help="the measured table, of the name of the material")
    material.add_argument("--run", required=True, help="folder of the run")
    material.add_argument("--scenes", nargs="+", required=True, help="the scenes that count")
    material.add_argument("--variants", nargs="+", required=True, help="the variants that count")
    gather.add_argument("tables", nargs="+", help="CSVs made by npfm quality material")
    summary = kinds.add_parser("summary")
    summary.add_argument("quality", help="CSV made by npfm quality gather")
    for kind in (material, gather, summary):
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    a = arguments
    match a.kind:
        case "material":
            from npfm.evaluation import quality_of_fits
            from npfm.fitting.sources import table

            made = quality_of_fits.material(a.run, a.scenes, a.table, a.variants, table)
        case "gather":
            made = quality.gather(a.tables)
        case "summary":
            made = quality.summary(quality.read(a.quality))
    tables.write(a.output, made)
