"""Tensor files: named arrays one after the other, as Mitsuba 3 and pbrt-v4 read them.

A header of twelve bytes, the version 1.0, the number of fields, and of each field its name, number
of dimensions, type, offset and shape; then the arrays. Little-endian, arrays at multiples of eight
bytes (Mitsuba's `tensor_io.py`, which reads and writes them).
"""

import struct
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from npfm.storage.files import Kind, marked, replacing

MAGIC = b"tensor_file\0"
VERSION = (1, 0)
#: How the types that are needed are numbered.
TYPES = {np.dtype("u1"): 1, np.dtype("<f4"): 10}
ALIGNED = 8
#: What stands in the description of every file of npfm.
MARK = "written by npfm"
KIND = Kind("a measured material", ".bsdf", marked(MAGIC, MARK.encode()))


def write(path: str, fields: Mapping[str, NDArray]) -> None:
    """Write a tensor file.

    Parameters
    ----------
    path : str
        Ends in ``.bsdf``.
    fields : mapping of str to ndarray
        Of uint8 or float32, in order; one that says `MARK` comes early.
    """
    start = len(MAGIC) + 6 + sum(16 - 3 + len(k) + 8 * v.ndim for k, v in fields.items())
    offsets = {}
    for name, array in fields.items():
        start = -(-start // ALIGNED) * ALIGNED
        offsets[name] = start
        start += array.nbytes
    with replacing(path, KIND) as temporary, temporary.open("wb") as file:
        file.write(MAGIC + struct.pack("<BBI", *VERSION, len(fields)))
        for name, array in fields.items():
            label = name.encode()
            file.write(struct.pack("<H", len(label)) + label)
            file.write(struct.pack("<HBQ", array.ndim, TYPES[array.dtype], offsets[name]))
            file.write(struct.pack(f"<{array.ndim}Q", *array.shape))
        for name, array in fields.items():
            file.write(bytes(offsets[name] - file.tell()))
            file.write(np.ascontiguousarray(array).data)
