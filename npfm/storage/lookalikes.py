"""What a file that cannot be read looks like, and what its owner can do about it."""

from pathlib import Path
from typing import NamedTuple

#: So much of a file is looked at.
HEAD_BYTES = 512


class Kind(NamedTuple):
    """A kind of file, with its article, and what to do with one that came in place of another."""

    what: str
    remedy: str


EMPTY = Kind("an empty file", "copy or download it again")
FOLDER = Kind("a folder", "give the path of a file in it")
ZIP = Kind("a zip archive", "unpack it and give the file that is in it")
NPY = Kind("a single NumPy array (.npy)", "save all arrays together with numpy.savez")
PAGE = Kind("an HTML page", "download the file itself, not the page about it")
POINTER = Kind("a git-lfs pointer", "fetch what it stands for with 'git lfs pull'")
PLY = Kind("a PLY mesh", "give it where a mesh is asked for")
JSON = Kind("a JSON file", "download the file itself")
TENSORS = Kind(
    "a tensor file of the RGL database (.bsdf)",
    "make a table of it with 'npfm material --rgl', or give its folder as a dataset of kind rgl",
)
_COMPRESSED = "decompress it and give the file that is in it"
_PICTURE = "give it where a light or a picture is asked for"

#: How files of a kind begin.
_MAGIC = {
    b"PK\x03\x04": ZIP,
    b"PK\x05\x06": ZIP,
    b"\x1f\x8b": Kind("a gzip archive", _COMPRESSED),
    b"BZh": Kind("a bzip2 archive", _COMPRESSED),
    b"\xfd7zXZ\0": Kind("an xz archive", _COMPRESSED),
    b"(\xb5/\xfd": Kind("a zstd archive", _COMPRESSED),
    b"7z\xbc\xaf\x27\x1c": Kind("a 7z archive", _COMPRESSED),
    b"Rar!": Kind("a rar archive", _COMPRESSED),
    b"tensor_file\0": TENSORS,
    b"\x93NUMPY": NPY,
    b"\x89HDF\r\n\x1a\n": Kind("an HDF5 file", "convert it first"),
    b"ply\n": PLY,
    b"ply\r": PLY,
    b"v/1\x01": Kind("an OpenEXR picture", _PICTURE),
    b"#?R": Kind("a Radiance picture", _PICTURE),
    b"\x89PNG": Kind("a PNG picture", _PICTURE),
    b"\xff\xd8\xff": Kind("a JPEG picture", _PICTURE),
    b"%PDF": Kind("a PDF", "give the file that it speaks of"),
    b"\x80\x04\x95": Kind("a Python pickle", "save it in the format that is asked for"),
    b"version https://git-lfs": POINTER,
    b"oid sha256:": POINTER,
}
#: How text of a kind begins, in lower case, after a byte-order mark and blanks.
_TEXT = {
    b"<!doctype html": PAGE,
    b"<html": PAGE,
    b"<head": PAGE,
    b"<?xml": Kind("an XML file", "download the file itself"),
    b"<error": Kind("an XML file", "download the file itself"),
    b'{"': JSON,
}


def kind(path: str | Path) -> Kind | None:
    """Guess the kind of a file from its beginning; None where nothing is recognised.

    Raises
    ------
    OSError
        If the file is absent or must not be read.
    """
    if Path(path).is_dir():
        return FOLDER
    with open(path, "rb") as file:
        head = file.read(HEAD_BYTES)
    if not head:
        return EMPTY
    text = head.removeprefix(b"\xef\xbb\xbf").lstrip().lower()
    found = (k for magic, k in _MAGIC.items() if head.startswith(magic))
    return next(found, None) or next((k for t, k in _TEXT.items() if text.startswith(t)), None)


def mistaken(path: str | Path, expected: str, *own: Kind) -> str:
    """Say that a file looks like one of another kind, and what to do; nothing if it does not.

    Parameters
    ----------
    path : str or Path
        A file that is there.
    expected : str
        What it should be, with its article.
    *own : Kind
        The kinds that are no surprise.

    Returns
    -------
    str
        Such as ``looks like an HTML page, not a fit; download the file itself, ...``.
    """
    found = kind(path)
    if found is None or found in own:
        return ""
    verb = "is" if found in (EMPTY, FOLDER) else "looks like"
    return f"{verb} {found.what}, not {expected}; {found.remedy}"
