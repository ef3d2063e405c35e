"""``npfm factorisation``."""

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from npfm.commands import factor as verb
from npfm.commands.numbers import shape
from npfm.commands.outputs import output
from npfm.datasets import analytic
from npfm.evaluation import factorisation as study
from npfm.evaluation import tables
from npfm.fitting.factorisation.matrix import Brdf
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.fitting.objective import Objective
from npfm.fitting.parametric import lafortune, mixtures
from npfm.papers import lawrence2004
from npfm.reflectance.factored import Angles

CODE = (
    "npfm.commands.factor",
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.datasets.analytic",
    "npfm.evaluation.factorisation",
    "npfm.evaluation.tables",
    "npfm.fitting.objective",
    "npfm.fitting.parametric.lafortune",
    "npfm.fitting.parametric.mixtures",
    "npfm.papers.lawrence2004",
)
EXAMPLE = """\
examples:
  python -m npfm factorisation measure nickel.binary -o nickel.csv
  python -m npfm factorisation table nickel.csv ward.csv -o factorisation.csv
  python -m npfm factorisation terms ward --most 4x5 -o terms.csv
measure factors a table or a formula by both recipes, at the resolution and with the terms
of the paper's Table 1. error is the mean absolute error of the reflected light over its mean, at
directions spread evenly in their angles, in the mean over the channels; lafortune that of the
better of two fits of Lafortune's lobes (by squares, and by the divergence), where the material is
isotropic. terms tells the errors by the number of terms, by the recipe as printed.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    kinds = parser.add_subparsers(dest="kind", required=True, metavar="measure|terms|table")
    measure = kinds.add_parser("measure")
    terms = kinds.add_parser("terms")
    for kind in (measure, terms):
        kind.add_argument("table", help="MERL .binary file, fit, or the name of a formula")
    terms.add_argument(
        "--most",
        type=shape(2),
        default=(4, 5),
        metavar="JxK",
        help="most terms of both factorisations (default: 4x5)",
    )
    terms.add_argument(
        "--resolution",
        type=shape(4),
        metavar="AxBxCxD",
        help="bins of theta_o, phi_o, theta_p and phi_p (default: the paper's)",
    )
    gather = kinds.add_parser("table")
    gather.add_argument("tables", nargs="+", help="CSV made by npfm factorisation measure")
    for kind in (measure, terms, gather):
        kind.add_argument(
            "-o", "--output", type=output(tables.TABLE), required=True, help="CSV to write"
        )


def run(arguments: argparse.Namespace) -> None:
    """Measure, or gather what was measured."""
    if arguments.kind == "table":
        read = [tables.read(path, study.TEXT, study.NUMBERS) for path in arguments.tables]
        gathered = pd.concat(read, ignore_index=True)
        tables.write(arguments.output, gathered[[*study.TEXT, *study.NUMBERS]])
        return
    reflected, grid = verb.brdf(arguments.table)
    formula, name = arguments.table in analytic.FORMULAS, Path(arguments.table).stem
    known = formula or name in lawrence2004.MATERIALS
    printed = lawrence2004.factored(name if known else "")
    if arguments.kind == "terms":
        resolution = arguments.resolution or printed.resolution
        recipe = Recipe(Angles(printed.half, False, resolution), printed.terms)
        outer, inner = (range(1, most + 1) for most in arguments.most)
        tables.write(arguments.output, study.by_terms(reflected, recipe, outer, inner))
        return
    isotropic = name in analytic.ISOTROPIC if formula else not grid.anisotropic
    lobes = _lafortune(arguments.table, reflected, printed.lobes) if isotropic else np.nan
    rows = _rows(name, reflected, printed, isotropic)
    tables.write(arguments.output, study.table({**row, "lafortune": lobes} for row in rows))


def _rows(
    name: str, reflected: Brdf, printed: lawrence2004.Factored, isotropic: bool
) -> Iterator[dict[str, Any]]:
    """What the factors of both recipes come to."""
    views, azimuths, n, m = printed.resolution
    own = (views, 1 if isotropic else azimuths, n, m)
    recipes = (
        (Recipe(Angles(printed.half, False, printed.resolution), printed.terms), printed.error),
        (Recipe(Angles(printed.half, True, own), printed.terms), np.nan),
    )
    for recipe, paper in recipes:
        began = time.process_time()
        factors = factor(reflected, recipe).factors
        seconds = time.process_time() - began
        error, rms = study.errors(reflected, study.model(factors))
        row = study.described(name, factors) | {"error": error, "rms": rms, "paper": paper}
        yield row | {"lafortune_paper": printed.lafortune, "seconds": seconds}


def _lafortune(name: str, reflected: Brdf, lobes: int) -> float:
    """Error of the better of two fits of Lafortune's lobes."""
    table = analytic.tabulated(name) if name in analytic.FORMULAS else verb.table(name)
    found = []
    for criterion in mixtures.CRITERIA:
        fit = mixtures.fit("lafortune", lafortune.FORM, lobes, criterion, table, Objective())

        def shown(light: np.ndarray, view: np.ndarray, fit: Any = fit) -> np.ndarray:
            return mixtures.reflectance(lafortune.FORM, fit, light, view)

        found.append(study.errors(reflected, shown)[0])
    return min(found)
