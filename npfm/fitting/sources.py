"""Tables from what a person names: a file of a table, or of a fit."""

from pathlib import Path

from npfm.fitting.fits import FIT
from npfm.fitting.registry import tabulated
from npfm.reflectance.table import Table
from npfm.reflectance.table_files import read_table


def table(path: str | Path) -> Table:
    """Return the table of a MERL ``.binary`` or UTIA ``.bin`` file, or of a fit (``.npz``)."""
    return tabulated(path) if Path(path).suffix == FIT.suffix else read_table(path)
