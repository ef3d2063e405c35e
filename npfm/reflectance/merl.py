"""The file format of the MERL database."""

from pathlib import Path

import numpy as np

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import CHANNELS, Table
from npfm.storage.files import Kind, replacing

#: What a stored value is multiplied with to give a BRDF in 1/sr, for red, green and blue
#: (BRDFRead.cpp, distributed with the MERL database).
CHANNEL_SCALE = np.array([1.00, 1.15, 1.66]) / 1500.0
HEADER_BYTES = 12
FILE_BYTES = HEADER_BYTES + 8 * 3 * MERL.size  # 34 992 012


def read_binary(path: str | Path) -> Table:
    """Read a MERL ``.binary`` file.

    Parameters
    ----------
    path : str or Path
        Three little-endian int32 (90, 90, 180), then 3 x 90 x 90 x 180 float64.

    Returns
    -------
    Table
        BRDF in 1/sr, the channel scaling applied.

    Raises
    ------
    NpfmError
        If the file is absent, has another size or header, holds a NaN or an infinity, or has a
        channel without a single valid sample.
    """
    path = Path(path)
    check_header(path)
    stored = np.fromfile(path, dtype="<f8", offset=HEADER_BYTES)
    stored = stored.reshape(3, *MERL.shape)
    if not np.isfinite(stored).all():
        count = stored.size - np.count_nonzero(np.isfinite(stored))
        raise NpfmError(
            f"{path}: {count} entries are NaN or infinite; mark missing samples with a negative "
            "value, as MERL does"
        )
    for name, plane in zip(CHANNELS, stored, strict=True):
        if not (plane >= 0).any():
            raise NpfmError(
                f"{path}: the {name} channel has no valid (non-negative) sample; "
                "nothing can be fitted to it, so leave this material out"
            )
    return Table(stored * CHANNEL_SCALE[:, None, None, None])


def check_header(path: str | Path) -> None:
    """Check the size and the dimensions of a MERL ``.binary`` file.

    Raises
    ------
    NpfmError
        If the file is absent, or its size or its header are not MERL's.
    """
    path = Path(path)
    if not path.is_file():
        raise NpfmError(f"{path}: no such file; give the path of a MERL .binary file")
    size = path.stat().st_size
    dimensions = tuple(np.fromfile(path, dtype="<i4", count=3)) if size >= HEADER_BYTES else ()
    if size >= HEADER_BYTES and dimensions != MERL.shape:
        found = " x ".join(str(n) for n in dimensions)
        raise NpfmError(
            f"{path}: the header says {found}, a MERL file says 90 x 90 x 180; "
            "convert the table to the MERL grid"
        )
    if size != FILE_BYTES:
        raise NpfmError(
            f"{path}: {size} bytes, a MERL file has {FILE_BYTES}; "
            "the file is cut off or damaged, copy or download it again"
        )


def _is_table(path: Path) -> bool:
    """Whether a file, no link, begins as a MERL file."""
    if path.is_symlink() or not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(HEADER_BYTES) == np.array(MERL.shape, dtype="<i4").tobytes()


BINARY = Kind("a table of MERL's format", ".binary", _is_table)


def write_binary(path: str | Path, table: Table) -> None:
    """Write a table as a MERL ``.binary`` file; negative values are written as they are.

    Raises
    ------
    NpfmError
        If the table is not on the MERL grid.
    """
    if table.grid != MERL:
        raise NpfmError(f"{path}: a MERL file cannot hold a table on the grid {table.grid.name}")
    with replacing(path, BINARY) as temporary, open(temporary, "wb") as file:
        # Not ndarray.tofile, which says nothing when the disk is full for its last bytes.
        file.write(np.array(MERL.shape, dtype="<i4").data)
        scale = CHANNEL_SCALE[:, None, None, None]
        stored = np.where(table.values < 0, table.values, table.values / scale)
        file.write(np.ascontiguousarray(stored, dtype="<f8").data)
