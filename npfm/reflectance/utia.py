"""The file format of the UTIA database, and its own sequel for tables of other resolutions."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance import merl
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.table import CHANNELS, Table
from npfm.storage.files import Kind, replacing
from npfm.storage.lookalikes import mistaken

FILE_BYTES = 8 * 3 * UTIA.size  # 1 990 656
#: Four int32 before tables of other resolutions: how many theta_i, phi_i, theta_o and phi_o. No
#: such file has FILE_BYTES, which without the header are no multiple of 24.
HEADER_BYTES = 16
#: What so many bytes are, and what to do.
OTHER_SIZES = {
    merl.FILE_BYTES: "as many as a MERL file; let its name end in .binary",
    FILE_BYTES // 2: "it looks like float32 values; write them as float64",
    FILE_BYTES // 3: "it looks like one channel; write it three times, as red, green and blue",
    FILE_BYTES // 6: "it looks like one channel of float32 values; write it three times as float64",
    FILE_BYTES // 3 * 4: "it looks like four channels; leave out all but red, green and blue",
}
#: Values of a BRDF that are measured are between these, in 1/sr, and those in the other byte order
#: are not.
PLAUSIBLE = 1e-30, 1e30


def read_bin(path: str | Path) -> Table[Directional]:
    """Read a ``.bin`` file of the UTIA database (Filip and Vavra 2014), or of another resolution.

    Parameters
    ----------
    path : str or Path
        3 x 6 x 48 x 6 x 48 little-endian float64 without a header: red, green and blue, each by
        theta_i, phi_i, theta_o and phi_o. Or four int32, the number of each of these, and
        3 x that many float64.

    Returns
    -------
    Table
        The values as they are, as BRDF in 1/sr.

    Raises
    ------
    NpfmError
        If the file is absent, has another size, holds a NaN or an infinity, or has a channel
        without a single valid sample.
    """
    path = Path(path)
    grid = check_bin(path)
    offset = 0 if grid == UTIA else HEADER_BYTES
    stored = np.fromfile(path, dtype="<f8", offset=offset, count=3 * grid.size)
    if _swapped(stored):
        raise NpfmError(
            f"{path}: the values are in the other byte order (big-endian); swap the bytes of all "
            "float64, and run again"
        )
    if not np.isfinite(stored).all():
        count = stored.size - np.count_nonzero(np.isfinite(stored))
        raise NpfmError(
            f"{path}: {count} entries are NaN or infinite; mark missing samples with a negative "
            "value"
        )
    values = stored.reshape(3, *grid.shape)
    for name, plane in zip(CHANNELS, values, strict=True):
        if not (plane >= 0).any():
            raise NpfmError(
                f"{path}: the {name} channel has no valid (non-negative) sample; "
                "nothing can be fitted to it, so leave this material out"
            )
    return Table(values, grid)


def check_bin(path: str | Path) -> Directional:
    """Check the size of a ``.bin`` file, and the header of one of another resolution.

    Returns
    -------
    Directional
        The grid of its table.

    Raises
    ------
    NpfmError
        If the file is absent, or its size is not that of a table; with what it looks like.
    """
    path = Path(path)
    if not path.exists():
        raise NpfmError(f"{path}: no such file; give the path of a UTIA .bin file")
    if other := mistaken(path, "a UTIA .bin file"):
        raise NpfmError(f"{path}: {other}")
    size = path.stat().st_size
    if size == FILE_BYTES:
        return UTIA
    if grid := _declared(path, size):
        return grid
    if size in OTHER_SIZES:
        raise NpfmError(f"{path}: {size} bytes, {OTHER_SIZES[size]}; a UTIA file has {FILE_BYTES}")
    why = "is cut off or damaged" if size < FILE_BYTES else "has bytes after its end"
    raise NpfmError(
        f"{path}: {size} bytes, a UTIA file has {FILE_BYTES}, and no header declares this size; "
        f"the file {why}, copy or download it again"
    )


def _declared(path: Path, size: int) -> Directional | None:
    """Grid of a header that fits the size of its file, if there is one."""
    if size < HEADER_BYTES:
        return None
    counts = [int(count) for count in np.fromfile(path, dtype="<i4", count=4)]
    fits = min(counts) > 0 and HEADER_BYTES + 8 * 3 * math.prod(counts) == size
    return Directional(*counts) if fits else None


def _swapped(stored: NDArray) -> bool:
    """Whether values make sense only with their bytes swapped."""
    with np.errstate(invalid="ignore"):
        return not _plausible(stored) and _plausible(stored.byteswap())


def _plausible(values: NDArray) -> bool:
    size = np.abs(values[values != 0])
    return bool(size.size and PLAUSIBLE[0] < size.min() and size.max() < PLAUSIBLE[1])


def _is_table(path: Path) -> bool:
    """Whether a file, no link, has the size of a table, which is all that marks one."""
    if path.is_symlink() or not path.is_file():
        return False
    size = path.stat().st_size
    return size == FILE_BYTES or _declared(path, size) is not None


BIN = Kind("a table of the UTIA format", ".bin", _is_table)


def write_bin(path: str | Path, table: Table) -> None:
    """Write a table as a ``.bin`` file: as UTIA's if it has that resolution, else with a header.

    Negative values are written as they are.

    Raises
    ------
    NpfmError
        If the table is on another kind of grid.
    """
    if not isinstance(table.grid, Directional):
        raise NpfmError(
            f"{path}: a UTIA file cannot hold a table on the grid {table.grid.name}; "
            "give a name that ends in .binary"
        )
    with replacing(path, BIN) as temporary, open(temporary, "wb") as file:
        # Not ndarray.tofile, which says nothing when the disk is full for its last bytes.
        if table.grid != UTIA:
            file.write(np.array(table.grid.shape, dtype="<i4").data)
        file.write(np.ascontiguousarray(table.values, dtype="<f8").data)
