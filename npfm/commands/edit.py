"""``npfm edit``."""

import argparse

from npfm.commands.numbers import positive
from npfm.commands.outputs import output
from npfm.errors import NpfmError
from npfm.fitting import fits, registry

#: What a digest covers beside this file (`npfm.run.provenance`).
CODE = (
    "npfm.commands.numbers",
    "npfm.commands.outputs",
    "npfm.fitting.fits",
    "npfm.fitting.registry",
)
EXAMPLE = """\
example:
  python -m npfm edit chrome.npz --roughness 2 -o rougher.npz
makes every slope of the microfacets twice as steep, and leaves the colour at each angle as it is.
The new fit is tabulated and rendered like any other, and may be edited again; it has no record.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.epilog = EXAMPLE
    parser.add_argument("fit", help="fit (.npz) of a model of microfacets whose D is a surface's")
    parser.add_argument(
        "--roughness",
        type=positive,
        required=True,
        metavar="FACTOR",
        help="what slopes are multiplied by, and with them the roughness alpha",
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
    fits.save(arguments.output, model.rougher(fit, arguments.roughness))
