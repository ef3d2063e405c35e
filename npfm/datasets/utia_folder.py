"""A folder of ``.bin`` files in the format of the UTIA database (dataset ``utia``)."""

from pathlib import Path

from npfm.datasets import table_folders
from npfm.reflectance.utia import check_bin


def materials(folder: str | Path) -> list[str]:
    """Names of the ``.bin`` files in a folder, sorted.

    Raises
    ------
    NpfmError
        If there is no such folder, or a file in it would be missed for its ``.BIN``.
    """
    return table_folders.materials(folder, ".bin", "UTIA")


def path(folder: str | Path, name: str) -> Path:
    """Path of a material's file, its size checked.

    Raises
    ------
    NpfmError
        If folder or file are absent, or the size is not that of a table.
    """
    file = table_folders.path(folder, name, ".bin", "UTIA")
    check_bin(file)
    return file
