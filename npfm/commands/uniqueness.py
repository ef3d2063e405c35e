"""``npfm uniqueness``."""

import argparse
from pathlib import Path

from npfm.commands.objectives import add_objective, objective
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation import uniqueness as study
from npfm.fitting import fits, iterations

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.objectives",
    "npfm.commands.outputs",
    "npfm.evaluation.tables",
    "npfm.evaluation.uniqueness",
    "npfm.fitting.fits",
    "npfm.fitting.iterations",
)
EXAMPLE = """\
examples:
  python -m npfm fit chrome.binary --model bivariate -o bivariate.npz
  python -m npfm fit chrome.binary --model independent-g --tolerance 1e-6 \\
      --iterations starts.npz -o chrome.npz
  python -m npfm uniqueness measure chrome.npz --iterations starts.npz \\
      --bivariate bivariate.npz -o chrome.csv
  python -m npfm uniqueness table chrome.csv nylon.csv -o uniqueness.csv
  python -m npfm uniqueness summary uniqueness.csv -o uniqueness_summary.csv
Distances are root mean squares of the change of a factor's logarithm, weighted by what the samples
see, the scale of the factor taken out: 0.1 is about 10 percent.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="measure|table|summary")
    measure = kinds.add_parser("measure")
    measure.add_argument("fit", help="fit (.npz) of independent-g")
    measure.add_argument("--iterations", required=True, help="made by npfm fit --iterations")
    measure.add_argument("--bivariate", required=True, help="fit (.npz) of bivariate")
    add_objective(measure)
    kinds.add_parser("table").add_argument(
        "found", nargs="+", help="CSVs made by npfm uniqueness measure"
    )
    kinds.add_parser("summary").add_argument("table", help="CSV made by npfm uniqueness table")
    for chosen in kinds.choices.values():
        chosen.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the table, and write it."""
    a = arguments
    match a.kind:
        case "measure":
            found = iterations.load(a.iterations)
            own, bivariate = _fit(a.fit, "independent-g"), _fit(a.bivariate, "bivariate")
            try:
                made = study.measure(own, found, bivariate, objective(a))
            except NpfmError as error:
                raise NpfmError(f"{a.fit}: {error}") from error
            made = made.assign(material=Path(a.fit).stem)[list(study.CHANNEL)]
        case "table":
            made = study.read(a.found)
        case "summary":
            made = study.summary(study.read([a.table]))
    tables.write(a.output, made)


def _fit(path: str, model: str) -> fits.Fit:
    fit = fits.load(path)
    if fit.model != model or fit.grid.anisotropic:
        raise NpfmError(f"{path}: a fit of '{fit.model}' on {fit.grid.name}; give one of {model}")
    return fit
