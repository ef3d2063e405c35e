"""``npfm edit``."""

import argparse

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.fitting import fits, registry
from npfm.reflectance.grids import Grid

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.fits",
    "npfm.fitting.registry",
    "npfm.reflectance.grids",
)
EXAMPLE = """\
examples:
  python -m npfm edit chrome.npz --roughness 2 -o rougher.npz
  python -m npfm edit brushed-steel.npz --roughness 1 0.5 -o brushed-more.npz
makes every slope of the microfacets twice as steep, or those along the table's y half as steep, and
leaves the colour at each angle as it is.
The new fit is tabulated and rendered like any other, and may be edited again; it has no record.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("fit", help="fit (.npz) of a model of microfacets whose D is a surface's")
    parser.add_argument(
        "--roughness",
        type=positive,
        nargs="+",
        required=True,
        metavar="FACTOR",
        help="what slopes are multiplied by, and with them the roughness alpha: one number, or two "
        "for slopes along x and along y, if the fit is of a table that tells them apart",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=output(fits.FIT, beside=fits.RECORD),
        required=True,
        help="fit to write (.npz)",
    )


def run(arguments: argparse.Namespace) -> None:
    """Edit the fit."""
    fit = fits.load(arguments.fit)
    model = registry.declared(fit.model).load()
    if not hasattr(model, "rougher"):
        models = registry.models().items()
        editable = [name for name, other in models if hasattr(other.load(), "rougher")]
        raise NpfmError(
            f"{arguments.fit}: '{fit.model}' cannot be made rougher; "
            f"give a fit of {' or '.join(editable)}"
        )
    fits.save(arguments.output, model.rougher(fit, _factors(arguments, fit.grid)))


def _factors(arguments: argparse.Namespace, grid: Grid) -> tuple[float, float]:
    """Factors along x and along y."""
    first, *others = arguments.roughness
    if len(others) > 1:
        raise NpfmError(f"--roughness has {len(others) + 1} numbers; give one, or two for x and y")
    second = others[0] if others else first
    if first != second and not grid.anisotropic:
        raise NpfmError(
            f"{arguments.fit}: a fit of a {grid.kind} table has no x and y; give one number"
        )
    return first, second
