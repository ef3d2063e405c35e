"""Tables from what a person names on the command line."""

from pathlib import Path

from npfm.fitting import fits, registry
from npfm.fitting.fits import Fit
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table


def tabulate(fit: Fit) -> Table:
    """Values of a fit, by the model that made it."""
    return registry.model(fit.model).tabulate(fit)


def table(path: str | Path) -> Table:
    """Return the table of a MERL ``.binary`` file, or of a fit (``.npz``)."""
    if Path(path).suffix == ".npz":
        return tabulate(fits.load(path))
    return read_binary(path)
