"""Tables from what a person names on the command line."""

from pathlib import Path

from npfm.fitting.registry import tabulated
from npfm.reflectance.table import Table
from npfm.reflectance.table_files import read_table


def table(path: str | Path) -> Table:
    """Return the table of a MERL ``.binary`` or UTIA ``.bin`` file, or of a fit (``.npz``)."""
    return tabulated(path) if Path(path).suffix == ".npz" else read_table(path)
