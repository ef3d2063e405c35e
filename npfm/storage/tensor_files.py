"""Tensor files, the container of the RGL material database: named arrays behind one header.

Mitsuba 3 and pbrt-v4 read their measured materials from them (Mitsuba's `tensor_io.py`). What is
in such a file is told by its header, which anybody may have written: nothing is read before it is
known to lie within the file.
"""

import math
import struct
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.files import Kind, replacing
from npfm.storage.lookalikes import TENSORS, mistaken

MAGIC = b"tensor_file\0"
#: Magic, version (two bytes) and the number of fields (uint32), all little-endian.
START = struct.Struct("<12s2BI")
#: Of a field, after its name: the number of its axes, its type, and where its values begin.
FIELD = struct.Struct("<HBQ")
#: Types of values by the numbers that stand for them (Mitsuba 3, ``Struct::Type``).
TYPES = {
    number: np.dtype(f"<{code}")
    for number, code in enumerate(
        ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f2", "f4", "f8"), start=1
    )
}
CODES = {type_: number for number, type_ in TYPES.items()}
#: Bytes that arrays begin at multiples of.
ALIGNED = 8
#: The version that there is.
VERSION = 1, 0
#: A measurement of all azimuths has some 20 MB in RGB; in spectra, which are not read, 110.
MOST_BYTES = 2**28
#: The database's files have 11 fields of up to 5 axes.
MOST_FIELDS, MOST_AXES = 64, 8


@dataclass(frozen=True)
class Field:
    """Where an array is in its file.

    Parameters
    ----------
    type : numpy.dtype
    shape : tuple of int
    offset : int
        Bytes from the beginning of the file.
    """

    type: np.dtype
    shape: tuple[int, ...]
    offset: int


class _Damaged(Exception):
    """What is wrong with a file, in words that go into a message."""


def read_header(path: str | Path, what: str) -> dict[str, Field]:
    """Read which arrays a tensor file has.

    Parameters
    ----------
    path : str or Path
    what : str
        What the file should be, with its article, for messages.

    Returns
    -------
    dict of str to Field
        All of them lie within the file.

    Raises
    ------
    NpfmError
        If the file is absent, of another kind, larger than `MOST_BYTES`, cut off or damaged.
    """
    path = Path(path)
    if not path.exists():
        raise NpfmError(f"{path}: no such file; give the path of {what}")
    if other := mistaken(path, what, TENSORS):
        raise NpfmError(f"{path}: {other}")
    size = path.stat().st_size
    if size > MOST_BYTES:
        raise NpfmError(f"{path}: {size} bytes; {MOST_BYTES} are the most that {what} has")
    try:
        # Not more than so many fields with the longest names there can be.
        with path.open("rb") as file:
            head = file.read(START.size + MOST_FIELDS * (2**16 + FIELD.size + 8 * MOST_AXES + 2))
        return _fields(head, size)
    except (_Damaged, struct.error) as error:
        reason = error if isinstance(error, _Damaged) else "it ends within its header"
        raise NpfmError(
            f"{path}: cannot be read as {what} ({reason}); copy or download it again"
        ) from None


def read_arrays(
    path: str | Path, fields: dict[str, Field], names: Iterable[str]
) -> dict[str, NDArray]:
    """Read some of the arrays that `read_header` found."""
    return {
        name: np.fromfile(
            path, fields[name].type, math.prod(fields[name].shape), offset=fields[name].offset
        ).reshape(fields[name].shape)
        for name in names
    }


def write_arrays(path: str | Path, kind: Kind, arrays: Mapping[str, NDArray]) -> None:
    """Write a tensor file.

    Parameters
    ----------
    path : str or Path
    kind : Kind
        What is written, and what may be there already.
    arrays : mapping of str to ndarray
        In order, of the types that there are.
    """
    heads = [(name.encode(), array) for name, array in arrays.items()]
    end = START.size + sum(2 + len(n) + FIELD.size + 8 * a.ndim for n, a in heads)
    with replacing(path, kind) as temporary, temporary.open("wb") as file:
        file.write(START.pack(MAGIC, *VERSION, len(arrays)))
        for name, array in heads:
            begin = _aligned(end)
            file.write(struct.pack("<H", len(name)) + name)
            file.write(FIELD.pack(array.ndim, CODES[array.dtype], begin))
            file.write(struct.pack(f"<{array.ndim}Q", *array.shape))
            end = begin + array.nbytes
        for array in arrays.values():
            file.write(bytes(_aligned(file.tell()) - file.tell()))
            # Not ndarray.tofile, which says nothing when the disk is full for its last bytes.
            file.write(np.ascontiguousarray(array).data)


def _aligned(offset: int) -> int:
    return -(-offset // ALIGNED) * ALIGNED


def _fields(head: bytes, size: int) -> dict[str, Field]:
    """Fields of a header, each within the `size` bytes of the file."""
    magic, *version, count = START.unpack_from(head)
    if magic != MAGIC or tuple(version) != VERSION:
        raise _Damaged("it does not begin as one of version 1.0")
    if count > MOST_FIELDS:
        raise _Damaged(f"its header declares {count} fields, {MOST_FIELDS} are the most")
    fields: dict[str, Field] = {}
    place = START.size
    for _ in range(count):
        (length,) = struct.unpack_from("<H", head, place)
        name = head[place + 2 : place + 2 + length].decode("ascii", "backslashreplace")
        axes, code, offset = FIELD.unpack_from(head, place + 2 + length)
        place += 2 + length + FIELD.size
        if axes > MOST_AXES:
            raise _Damaged(f"the field {name[:40]!r} has {axes} axes, {MOST_AXES} are the most")
        shape = struct.unpack_from(f"<{axes}Q", head, place)
        place += 8 * axes
        if name in fields:
            raise _Damaged(f"it has two fields {name[:40]!r}")
        if code not in TYPES:
            raise _Damaged(f"the field {name[:40]!r} is of the unknown type {code}")
        if offset + math.prod(shape) * TYPES[code].itemsize > size:
            raise _Damaged(f"the field {name[:40]!r} goes on beyond the end of the file")
        fields[name] = Field(TYPES[code], shape, offset)
    return fields
