"""``npfm basis``."""

import argparse
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from npfm.commands.numbers import whole
from npfm.commands.objectives import add_objective, add_solver, objective, solver
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.evaluation import basis as study
from npfm.evaluation import tables
from npfm.fitting import fits, registry
from npfm.fitting.basis import library
from npfm.fitting.basis.fit import fit_table
from npfm.fitting.basis.library import LIBRARY, Library
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.solvers import gauss_newton
from npfm.reflectance.table import Table
from npfm.reflectance.table_files import read_table
from npfm.rendering import transport
from npfm.storage.names import distinct

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.objectives",
    "npfm.commands.outputs",
    "npfm.evaluation.basis",
    "npfm.evaluation.tables",
    "npfm.fitting.basis.fit",
    "npfm.fitting.fits",
    "npfm.fitting.registry",
    "npfm.fitting.solvers.gauss_newton",
    "npfm.reflectance.table_files",
    "npfm.rendering.transport",
    "npfm.storage.names",
)
EXAMPLE = """\
examples:
  python -m npfm basis gather fits/independent-g/*.npz -o factors.npz
  python -m npfm basis fit chrome.binary --factors factors.npz --curves 8 -o chrome.npz
  python -m npfm basis measure chrome.binary --factors factors.npz --fit chrome.npz \\
      --scenes scenes/A scenes/D --curves 1 5 20 -o chrome.csv
  python -m npfm basis table chrome.csv nylon.csv -o basis.csv
gather keeps the logarithms of D, F and G of fits of independent-g or of shared-lobes, each named
after its material; fit and measure leave the material itself out of them, and make mean curves and
so many others of the rest. A fit in a basis is one of its model like any other. PSNR is in dB.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="gather|fit|measure|table")
    gather = kinds.add_parser("gather")
    gather.add_argument("fits", nargs="+", help="fits (.npz), one of each material")
    fit, measure = kinds.add_parser("fit"), kinds.add_parser("measure")
    for chosen, count in ((fit, None), (measure, "+")):
        chosen.add_argument("table", help="MERL .binary file of the material")
        chosen.add_argument("--factors", required=True, help="made by npfm basis gather")
        chosen.add_argument(
            "--curves", type=whole(1), nargs=count, required=True, help="of each of D, F and G"
        )
        add_solver(chosen)
    measure.add_argument("--fit", required=True, help="fit (.npz) of the table, factors free")
    measure.add_argument("--scenes", nargs="+", required=True, help="made by npfm scene")
    measure.add_argument("--variant", help="name in the table (default: that of the model)")
    gathered = kinds.add_parser("table")
    gathered.add_argument("found", nargs="+", help="CSVs made by npfm basis measure")
    for chosen in (gather, fit, measure):
        add_objective(chosen)
    outputs = (
        (gather, output(LIBRARY)),
        (fit, output(fits.FIT, beside=fits.RECORD)),
        (measure, output(tables.TABLE)),
        (gathered, output(tables.TABLE)),
    )
    for chosen, kind in outputs:
        chosen.add_argument("-o", "--output", type=kind, required=True, help="file to write")


def run(arguments: argparse.Namespace) -> None:
    """Make the factors, the fit or the table, and write it."""
    a = arguments
    match a.kind:
        case "gather":
            names = distinct(Path(path).stem for path in a.fits)
            loaded = dict(zip(names, map(fits.load, a.fits), strict=True))
            library.save(a.output, library.gather(loaded, objective(a)))
        case "fit":
            fits.save(a.output, _fitted(a))
        case "measure":
            tables.write(a.output, _measured(a))
        case "table":
            tables.write(a.output, study.summary(study.read(a.found)))


def _others(a: argparse.Namespace, measured: Table) -> Library:
    """Return the factors of all materials but the one that the table is named after."""
    try:
        found = library.load(a.factors).without(Path(a.table).stem)
    except NpfmError as error:
        raise NpfmError(f"{a.factors}: {error}") from error
    if found.grid != measured.grid:
        raise NpfmError(
            f"{a.table}: a table on {measured.grid.name}, and factors of fits on "
            f"{found.grid.name}; give those of one grid"
        )
    return found


def _fitted(a: argparse.Namespace) -> Fit:
    measured = read_table(a.table)
    others = _others(a, measured)
    solve = partial(gauss_newton.solve, settings=solver(a))
    tabulate = registry.model(others.model).tabulate
    return fit_table(measured, others, a.curves, objective(a), solve, tabulate)


def _measured(a: argparse.Namespace) -> pd.DataFrame:
    measured = read_table(a.table)
    others = _others(a, measured)
    own = _own(a.fit, others, objective(a))
    solve = partial(gauss_newton.solve, settings=solver(a))
    ways = study.ways(measured, own, others, a.curves, objective(a), solve)
    made = study.measure(measured, ways, _scenes(a), registry.model(others.model).tabulate)
    names = {"material": Path(a.table).stem, "variant": a.variant or others.model}
    return made.assign(**names)[list(study.MEASURED)]


def _own(path: str, others: Library, given: Objective) -> study.Own:
    fit = fits.load(path)
    if library.gather({path: fit}, given).form != others.form:
        raise NpfmError(
            f"{path}: a fit of another model, settings or grid than those that the factors are of; "
            "give one that was made as they were"
        )
    channels = fits.load_record(path)["channels"]
    objectives = [channel.objective for channel in channels]
    seconds = sum(channel.seconds for channel in channels)
    return study.Own(fit, float(np.mean(objectives)), seconds)


def _scenes(a: argparse.Namespace) -> Mapping[str, transport.Transport]:
    names = distinct(Path(path).name for path in a.scenes)
    return dict(zip(names, map(transport.load, a.scenes), strict=True))
