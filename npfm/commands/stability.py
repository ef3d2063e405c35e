"""``npfm stability``."""

import argparse
import sys
import warnings
from collections.abc import Iterator
from functools import partial
from itertools import product

import pandas as pd

from npfm.commands.numbers import whole
from npfm.commands.outputs import output
from npfm.evaluation import stability, tables
from npfm.evaluation.hard_cases import CASES
from npfm.fitting import registry
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.solvers.choice import SOLVERS, chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.table import Table

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.evaluation.stability",
    "npfm.evaluation.tables",
    "npfm.fitting.registry",
    "npfm.fitting.solvers.choice",
)
EXAMPLE = """\
examples:
  python -m npfm stability fit naive --starts 8 --awls-iterations 60 -o naive.csv
  python -m npfm stability gather naive.csv g-from-d.csv -o stability.csv
fits inputs that no measurement should be like, each at MERL's full resolution; fails if a warning
is raised, or if what must hold of every fit does not.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="fit|gather")
    fit = kinds.add_parser("fit", help="fit all cases by a model and every solver")
    fit.add_argument("model", help=f"{', '.join(registry.fitted())}")
    fit.add_argument("--starts", type=whole(1), required=True, help="of independent-g")
    fit.add_argument(
        "--awls-iterations", type=whole(1), required=True, help="cap on a start of awls"
    )
    gather = kinds.add_parser("gather", help="join tables")
    gather.add_argument("tables", nargs="+", help="CSVs made by npfm stability fit")
    for kind in (fit, gather):
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Make the rows of one model, or gather those of several."""
    a = arguments
    if a.kind == "gather":
        read = (pd.read_csv(path, keep_default_na=False) for path in a.tables)
        table = stability.gathered(read)
    else:
        warnings.simplefilter("error")
        rows = _rows(a.model, a.starts, a.awls_iterations)
        table = pd.DataFrame(rows, columns=stability.COLUMNS)
    tables.write(a.output, table)


def methods(model: str) -> tuple[str, ...]:
    """Solvers that a model is fitted by; one that needs none is fitted once."""
    return SOLVERS if registry.declared(model).solver else ("",)


def fitted(table: Table, model: str, settings: SolverSettings, starts: int) -> Fit:
    """Fit a model; `starts` is how many it has, if it can be told."""
    own = {"starts": starts} if "starts" in registry.declared(model).settings else {}
    return registry.model(model).fit(table, Objective(), chosen(settings), 1, **own)


def _rows(model: str, starts: int, awls_iterations: int) -> Iterator[dict]:
    """All cases on MERL's grid, by one model and each of its solvers."""
    module = registry.model(model)
    for case, method in product(CASES, methods(model)):
        cap = awls_iterations if method == "awls" else SolverSettings.max_iterations
        settings = SolverSettings(method or SolverSettings.method, max_iterations=cap)
        table = CASES[case]()
        fit = partial(fitted, table, model, settings, starts)
        row = stability.row(case, table, module, method, fit)
        print(*row.values(), file=sys.stderr, flush=True)
        yield row
