"""Tables from what a person names on the command line."""

from pathlib import Path

from npfm.errors import NpfmError
from npfm.fitting import fits, registry
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table


def tabulated(path: str | Path) -> Table:
    """Values of a fit (``.npz``), by the model that made it."""
    fit = fits.load(path)
    try:
        model = registry.model(fit.model)
    except NpfmError as error:
        raise NpfmError(f"{path}: {error}") from error
    return fits.tabulate(path, fit, model)


def table(path: str | Path) -> Table:
    """Return the table of a MERL ``.binary`` file, or of a fit (``.npz``)."""
    return tabulated(path) if Path(path).suffix == ".npz" else read_binary(path)
