"""The file format of the MERL database."""

from pathlib import Path

import numpy as np

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import CHANNELS, Table
from npfm.storage.files import Kind, replacing
from npfm.storage.lookalikes import mistaken

#: What a stored value is multiplied with to give a BRDF in 1/sr, for red, green and blue
#: (BRDFRead.cpp, distributed with the MERL database).
CHANNEL_SCALE = np.array([1.00, 1.15, 1.66]) / 1500.0
HEADER_BYTES = 12
FILE_BYTES = HEADER_BYTES + 8 * 3 * MERL.size  # 34 992 012
#: Tables without reciprocity, such as those of Lavoue et al. 2021, "Perceptual quality of BRDF
#: approximations": phi_d runs over 360 degrees.
TWICE_PHI_D = (90, 90, 360)
#: What a right header before so many bytes for each cell of the grid means, and what to do.
OTHER_VALUES = {
    3 * 4: "float32 values; write them as float64 after the same header",
    1 * 8: "one channel; write it three times, as red, green and blue",
    1 * 4: "one channel of float32 values; write it three times as float64",
    4 * 8: "four channels; leave out all but red, green and blue",
}
#: What so many bytes are without a header, and what to do.
HEADLESS = {
    FILE_BYTES - HEADER_BYTES: "but as many as its values; put the int32 90, 90, 180 before them",
    8 * 3 * 288**2: "as many as a file of the UTIA database; let its name end in .bin",
}


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
    stored = np.fromfile(path, dtype="<f8", offset=HEADER_BYTES, count=3 * MERL.size)
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
        If the file is absent, or its size or its header are not MERL's; with what it looks like.
    """
    path = Path(path)
    if not path.exists():
        raise NpfmError(f"{path}: no such file; give the path of a MERL .binary file")
    if other := mistaken(path, "a MERL .binary file"):
        raise NpfmError(f"{path}: {other}")
    size = path.stat().st_size
    if fault := _fault(path, size):
        raise NpfmError(f"{path}: {fault}")


def _fault(path: Path, size: int) -> str:
    """What is wrong with a file, and what to do; nothing if size and header are MERL's."""
    if size in HEADLESS:
        return f"{size} bytes without MERL's header, {HEADLESS[size]}"
    if size < HEADER_BYTES:
        return _damaged(size)
    dimensions = tuple(int(n) for n in np.fromfile(path, dtype="<i4", count=3))
    swapped = tuple(int(n) for n in np.array(dimensions, "<i4").view(">i4"))
    found = " x ".join(map(str, dimensions))
    if swapped == MERL.shape:
        return (
            "the header is in the other byte order (big-endian); swap the bytes of its three "
            "int32 and of all float64 after them, and run again"
        )
    if dimensions == TWICE_PHI_D:
        return (
            f"the header says {found}: phi_d over 360 degrees, light and view told apart; "
            "average the entries k and k + 180 of phi_d to get MERL's 90 x 90 x 180"
        )
    if dimensions != MERL.shape:
        return (
            f"the header says {found}, a MERL file says 90 x 90 x 180; "
            "convert the table to the MERL grid"
        )
    bytes_a_cell, rest = divmod(size - HEADER_BYTES, MERL.size)
    if not rest and (other := OTHER_VALUES.get(bytes_a_cell)):
        return f"{size} bytes: it looks like {other}, a MERL file has {FILE_BYTES}"
    return "" if size == FILE_BYTES else _damaged(size)


def _damaged(size: int) -> str:
    why = "is cut off or damaged" if size < FILE_BYTES else "has bytes after its end"
    return f"{size} bytes, a MERL file has {FILE_BYTES}; the file {why}, copy or download it again"


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
        end = "; give a name that ends in .bin" if table.grid.kind == "directional" else ""
        raise NpfmError(
            f"{path}: a MERL file cannot hold a table on the grid {table.grid.name}{end}"
        )
    with replacing(path, BINARY) as temporary, open(temporary, "wb") as file:
        # Not ndarray.tofile, which says nothing when the disk is full for its last bytes.
        file.write(np.array(MERL.shape, dtype="<i4").data)
        scale = CHANNEL_SCALE[:, None, None, None]
        stored = np.where(table.values < 0, table.values, table.values / scale)
        file.write(np.ascontiguousarray(stored, dtype="<f8").data)
