"""Tables from what a person names on the command line."""

from pathlib import Path

from npfm.fitting.registry import tabulated
from npfm.reflectance.merl import read_binary
from npfm.reflectance.table import Table


def table(path: str | Path) -> Table:
    """Return the table of a MERL ``.binary`` file, or of a fit (``.npz``)."""
    return tabulated(path) if Path(path).suffix == ".npz" else read_binary(path)
