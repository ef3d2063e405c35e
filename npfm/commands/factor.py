"""``npfm factor``."""

import argparse
import time
from pathlib import Path

from npfm.commands.numbers import shape, whole
from npfm.commands.outputs import output
from npfm.datasets.analytic import FORMULAS
from npfm.errors import NpfmError, suggest
from npfm.fitting import fits
from npfm.fitting.factorisation.matrix import Brdf
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.fitting.fits import FIT, RECORD, Fit
from npfm.fitting.sources import table
from npfm.reflectance.factored import Angles
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import MERL

CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.sources",
    "npfm.datasets.analytic",
    "npfm.fitting.factorisation.recipes",
    "npfm.fitting.fits",
)
EXAMPLE = """\
examples:
  python -m npfm factor chrome.binary --terms 2x1 -o chrome.factored.npz
  python -m npfm factor ward --terms 2x4 --resolution 16x16x100x100 --recipe paper -o ward.npz
writes the factors as a fit of the model 'factored' (float32; rho_d and rho_s in 1/sr), which the
sampling strategy 'factored' follows. A resolution is bins of theta_o, phi_o, theta_p and phi_p;
with one bin of phi_o azimuths are counted from the view's, which is what isotropic tables need.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("table", help=f"MERL .binary file, UTIA .bin file, fit, or {_names()}")
    parser.add_argument(
        "-o",
        "--output",
        type=output(FIT, beside=RECORD),
        required=True,
        help="fit to write (.npz)",
    )
    add_recipe(parser)


def add_recipe(parser: argparse.ArgumentParser) -> None:
    """Declare how to factor."""
    parser.add_argument(
        "--terms",
        type=shape(2),
        default=(3, 2),
        metavar="JxK",
        help="terms of the first factorisation, and of the second for each (default: 3x2)",
    )
    parser.add_argument(
        "--resolution",
        type=shape(4),
        default=(16, 1, 128, 16),
        metavar="AxBxCxD",
        help="bins of theta_o, phi_o, theta_p and phi_p (default: 16x1x128x16)",
    )
    parser.add_argument(
        "--parameterisation",
        choices=("half-vector", "incident"),
        default="half-vector",
        help="whether p is the half vector or the light (default: %(default)s)",
    )
    parser.add_argument(
        "--recipe",
        choices=("improved", "paper"),
        default="improved",
        help="bins as samples see them, or as printed in 2004 (default: %(default)s)",
    )
    parser.add_argument(
        "--seed", type=whole(0), default=0, help="seed of the starts (default: %(default)s)"
    )


def recipe(arguments: argparse.Namespace) -> Recipe:
    """Return what `add_recipe` asked for."""
    half, improved = arguments.parameterisation == "half-vector", arguments.recipe == "improved"
    return Recipe(Angles(half, improved, arguments.resolution), arguments.terms)


def brdf(name: str) -> tuple[Brdf, Grid]:
    """Reflectance by the name of a formula or the path of a table or a fit, and its grid.

    Raises
    ------
    NpfmError
        If it is neither.
    """
    if name in FORMULAS:
        return FORMULAS[name], MERL
    if not Path(name).suffix:
        raise NpfmError(f"'{name}' is no file and no formula; {suggest(name, FORMULAS)}")
    found = table(name)
    return found.lookup, found.grid


def run(arguments: argparse.Namespace) -> str:
    """Factor, and write the factors; what it came to, in a line."""
    reflected, grid = brdf(arguments.table)
    began = time.process_time()
    found = factor(reflected, recipe(arguments), arguments.seed)
    seconds = time.process_time() - began
    arrays = {name: array.astype("float32") for name, array in found.factors.arrays().items()}
    fit = Fit("factored", arrays, grid)
    fits.save(arguments.output, fit)
    state = "converged" if found.converged else "iteration cap"
    return f"{found.updates} updates, {seconds:.2f} s, {fit.parameter_bytes} bytes, {state}"


def _names() -> str:
    return f"one of {', '.join(FORMULAS)}"
