"""``npfm perception``."""

import argparse
from pathlib import Path

import pandas as pd

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.datasets import opinions
from npfm.errors import NpfmError
from npfm.evaluation import perception, quality, tables
from npfm.papers import lavoue2021

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.datasets.opinions",
    "npfm.evaluation.perception",
    "npfm.evaluation.quality",
    "npfm.evaluation.tables",
    "npfm.papers.lavoue2021",
)
EXAMPLE = """\
examples:
  python -m npfm perception pairs --quality quality.csv --opinions perceptual -o pairs.csv
  python -m npfm perception correlations --quality quality.csv --opinions perceptual \\
      -o perception.csv
pairs puts every metric of a fit beside how different people found its picture from that of the
measurement (0 to 1; Lavoué et al. 2021); correlations says how well each metric orders the pairs as
people do (Spearman, with the 95 % interval over materials).
"""
#: By the name of a group of models: what ours are of those that people saw.
GROUPS = {
    "as shown": (lavoue2021.PUBLISHED, lavoue2021.MADE_AGAIN),
    lavoue2021.PUBLISHED: (lavoue2021.PUBLISHED,),
    lavoue2021.MADE_AGAIN: (lavoue2021.MADE_AGAIN,),
    "our fits": (lavoue2021.OURS,),
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="pairs|correlations")
    pairs, correlations = kinds.add_parser("pairs"), kinds.add_parser("correlations")
    correlations.add_argument(
        "--seed", type=whole(0), default=1, help="of the draws of materials (default: 1)"
    )
    for kind in (pairs, correlations):
        kind.add_argument("--quality", required=True, help="CSV made by npfm quality gather")
        kind.add_argument(
            "--opinions",
            required=True,
            help=f"folder that has {opinions.DISTANCES} and {opinions.CLASSES}",
        )
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    made = _pairs(arguments)
    if arguments.kind == "correlations":
        made = perception.correlations(made, GROUPS, arguments.seed)
    tables.write(arguments.output, made)


def _pairs(arguments: argparse.Namespace) -> pd.DataFrame:
    folder = Path(arguments.opinions)
    said = opinions.read(folder / opinions.DISTANCES)
    classes = opinions.classes(folder / opinions.CLASSES)
    try:
        return perception.pairs(quality.read(arguments.quality), said, classes, lavoue2021.SHOWN)
    except perception.NothingShown as error:
        raise NpfmError(f"{arguments.quality}: {error}") from error
