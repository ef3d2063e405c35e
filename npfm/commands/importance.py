"""``npfm importance``."""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import importance as study
from npfm.evaluation import tables
from npfm.fitting import fits
from npfm.fitting.sources import table
from npfm.papers import lawrence2004
from npfm.rendering.lights import environment
from npfm.storage.bounds import check_size
from npfm.storage.names import distinct, named
from npfm.storage.pictures import EXR, write_exr_parts

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.evaluation.importance",
    "npfm.evaluation.tables",
    "npfm.fitting.fits",
    "npfm.papers.lawrence2004",
    "npfm.rendering.lights.environment",
    "npfm.storage.bounds",
    "npfm.storage.names",
    "npfm.storage.pictures",
)
EXAMPLE = """\
examples:
  python -m npfm importance measure chrome.binary --light grace.exr \\
      --ways cosine per-view light+half-vector per-view+light+uniform^2 -o chrome.csv
  python -m npfm importance measure chrome.binary --light grace.exr \\
      --ways quantiles/facets --parameters quantiles/facets=chrome.npz -o chrome.csv
  python -m npfm importance table chrome.csv nylon.csv -o variance.csv
A way is a strategy, or several with + between them and ^ before the power of the heuristic. What
stands after a / names the arrays that a strategy follows. n_var is the variance of a picture of a
sphere, times its samples a pixel, over its mean square; seconds are of the processor, for a sample.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="measure|table")
    measure = kinds.add_parser("measure")
    measure.add_argument("table", help="MERL .binary file of the material")
    measure.add_argument("--light", required=True, help="lat-long EXR, made by npfm light")
    measure.add_argument("--ways", nargs="+", required=True, help="ways of choosing directions")
    measure.add_argument(
        "--parameters",
        nargs="*",
        default=[],
        metavar="STRATEGY/RECIPE=FIT",
        help="the fit (.npz) that a strategy follows",
    )
    for name, lowest, default, what in (
        ("--resolution", 4, 20, "pixels along one side"),
        (
            "--points",
            1,
            1024,
            "points of each strategy a pixel that variances of one sample are from",
        ),
        ("--repetitions", 2, lawrence2004.TRIALS, "of estimates by several samples"),
        ("--seed", 0, 1, "of all points"),
    ):
        measure.add_argument(
            name, type=whole(lowest), default=default, help=f"{what} (default: {default})"
        )
    measure.add_argument(
        "--samples",
        nargs="+",
        type=whole(1),
        default=[4, 16, lawrence2004.SAMPLES],
        help="samples a pixel of stratified estimates, from few to many",
    )
    measure.add_argument(
        "--images", type=output(EXR), help="EXR to write: n_var by pixel, a part each way"
    )
    gather = kinds.add_parser("table")
    gather.add_argument("found", nargs="+", help="CSVs made by npfm importance measure")
    for kind in (measure, gather):
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    if arguments.kind == "table":
        made = study.gather([study.read(path, study.MEASURED) for path in arguments.found])
        tables.write(arguments.output, made.assign(published=_published(made)))
        return
    made, images = _measured(arguments)
    tables.write(arguments.output, made)
    if arguments.images:
        write_exr_parts(arguments.images, images)


def _measured(a: argparse.Namespace) -> tuple[pd.DataFrame, dict[str, np.ndarray]]:
    check_size(a.output, a.resolution, a.resolution)
    ways = [study.way(text) for text in distinct(a.ways)]
    effort = study.Effort(a.resolution, a.points, sorted(set(a.samples)), a.repetitions, a.seed)
    parameters = {
        name: fits.load(path).parameters
        for name, path in named(a.parameters, "quantiles/a=a.npz").items()
    }
    light = environment.read(a.light)
    try:
        made, images = study.measure(ways, table(a.table), light, parameters, effort)
    except study.Black as error:
        raise NpfmError(f"{a.table}: {error}") from None
    about = {"light": Path(a.light).stem, "material": Path(a.table).stem}
    return made.assign(**about)[list(study.MEASURED)], images


def _published(made: pd.DataFrame) -> list[float]:
    """Factors of improvement that the paper printed, NaN where it has none."""
    comparable = (made["points"] == study.SOBOL) & (made["samples"] == lawrence2004.SAMPLES)
    names = zip(made["light"], made["material"], made["strategy"], strict=True)
    printed = [lawrence2004.improvement(*row) for row in names]
    return np.where(comparable, printed, np.nan).tolist()
