"""Members of zip archives, and arrays out of ``.npz`` files, without trust in what they declare."""

import math
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.lookalikes import ZIP, mistaken


class Unreadable(Exception):
    """Why something cannot be read, in words that go into a message."""


@contextmanager
def opened(path: str | Path, what: str, remedy: str) -> Iterator[zipfile.ZipFile]:
    """Open a zip archive, and tell in one line what goes wrong in the block.

    Parameters
    ----------
    path : str or Path
        The archive.
    what, remedy : str
        What it should be, with its article, and where to get it; for messages.

    Raises
    ------
    NpfmError
        If the file is absent, is no zip or a damaged one, or the block raises `Unreadable`.
    """
    path = Path(path)
    if not path.exists():
        raise NpfmError(f"{path}: no such file; {remedy}")
    try:
        if other := mistaken(path, what, ZIP):
            raise NpfmError(f"{path}: {other}")
        with zipfile.ZipFile(path) as archive:
            yield archive
    except (OSError, Unreadable, zipfile.BadZipFile, NotImplementedError) as error:
        reason = " ".join(str(error).split())
        raise NpfmError(f"{path}: cannot be read as {what} ({reason}); {remedy}") from error


def read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo, most: int) -> bytes:
    """Unpack a member of an archive.

    Parameters
    ----------
    archive : ZipFile
        The archive, open.
    member : ZipInfo
        One of its members.
    most : int
        Bytes that the member may have. `zipfile` stops at the size that the archive declares, so
        a small archive that unpacks to a large member is refused before anything is unpacked.

    Raises
    ------
    Unreadable
        If it is larger, damaged, encrypted, or compressed in a way that is not known.
    """
    name = member.filename
    if member.file_size > most:
        raise Unreadable(f"{name} unpacks to {member.file_size} bytes, {most} are the most")
    try:
        return archive.read(member)
    # What the decompressors raise passes through zipfile, and encryption is a RuntimeError.
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise Unreadable(f"{name} is damaged or encrypted: {reason}") from error


def read_arrays(path: str | Path, what: str, remedy: str, most: int) -> dict[str, NDArray]:
    """Read all arrays of an ``.npz`` file.

    Parameters
    ----------
    path, what, remedy
        As in `opened`.
    most : int
        Bytes that all arrays together may have.

    Returns
    -------
    dict of str to ndarray
        Plain arrays of numbers or text: objects, which are code, are not read.

    Raises
    ------
    NpfmError
        If the file is absent, no ``.npz``, damaged, or larger than that.
    """
    with opened(path, what, remedy) as archive:
        members = archive.infolist()
        if (size := sum(member.file_size for member in members)) > most:
            raise Unreadable(f"it unpacks to {size} bytes, {most} are the most")
        return {
            member.filename.removesuffix(".npy"): _array(
                read_member(archive, member, most), member.filename
            )
            for member in members
        }


def _array(content: bytes, name: str) -> NDArray:
    """Array in the ``.npy`` format, of exactly the size that its header declares."""
    file = BytesIO(content)
    try:
        version = npy.read_magic(file)
        read_header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read_header(file)
    except ValueError as error:
        raise Unreadable(f"{name} is no array: {error}") from None
    if dtype.hasobject or dtype.names:
        raise Unreadable(f"{name} holds objects or records, not numbers")
    declared, there = math.prod(shape) * dtype.itemsize, len(content) - file.tell()
    if declared != there or min(shape, default=0) < 0:
        raise Unreadable(f"{name} has {there} bytes where its header declares {declared}")
    array = np.frombuffer(content[file.tell() :], dtype) if there else np.empty(0, dtype)
    return array.reshape(shape, order="F" if fortran else "C").copy()
