"""Files of tables by their names: ``.binary`` of MERL, ``.bin`` of UTIA."""

from pathlib import Path

from npfm.reflectance.merl import BINARY, read_binary, write_binary
from npfm.reflectance.table import Table
from npfm.reflectance.utia import BIN, read_bin, write_bin

#: What tables are written as.
KINDS = (BINARY, BIN)


def read_table(path: str | Path) -> Table:
    """Read the table in a file: of UTIA's format if its name ends in ``.bin``, else of MERL's.

    Raises
    ------
    NpfmError
        If the file is absent or not of that format.
    """
    return read_bin(path) if Path(path).suffix == BIN.suffix else read_binary(path)


def write_table(path: str | Path, table: Table) -> None:
    """Write a table to a file of one of `KINDS`, by the end of its name.

    Raises
    ------
    NpfmError
        If such a file cannot hold a table on its grid.
    """
    write = write_bin if Path(path).suffix == BIN.suffix else write_binary
    write(path, table)
