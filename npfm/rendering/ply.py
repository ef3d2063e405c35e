"""PLY files: ASCII, and binary of both byte orders, with faces of any number of corners.

Turk 1994, "The PLY polygon file format". trimesh reads such files too, but no binary ones whose
faces differ in their number of corners, and none with bytes after the end.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

TYPES = {
    **{"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"},
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"},
    **{"int64": "i8", "uint64": "u8", "float": "f4", "float32": "f4", "float64": "f8"},
    **{"double": "f8"},
}
ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}
#: Names that programs give to the corners of a face.
CORNERS = ("vertex_indices", "vertex_index")
#: No header is longer.
HEADER_BYTES = 2**16

Values = dict[str, NDArray | list[NDArray]]


@dataclass(frozen=True)
class Property:
    """A number for each row of an element, or, where `length` is a type, a list of them."""

    name: str
    type: np.dtype
    length: np.dtype | None = None


@dataclass(frozen=True)
class Element:
    """A kind of row, and how many of them there are."""

    name: str
    count: int
    properties: list[Property]


def parse(content: bytes) -> tuple[NDArray, NDArray[np.int64], NDArray | None]:
    """Read a PLY file.

    Parameters
    ----------
    content : bytes
        The file; what comes after its last element is ignored.

    Returns
    -------
    vertices : ndarray, shape (v, 3)
    triangles : ndarray of int, shape (f, 3)
        Faces of more corners as fans of triangles; fewer than three corners are no face.
    normals : ndarray, shape (v, 3), or None
        Those of the file, if it has any.

    Raises
    ------
    ValueError
        If the file is damaged, cut off, or of another format, or has no vertices or faces.
    """
    order, elements, at = _header(content)
    if order == "=":
        content, elements, at = _as_binary(content[at:], elements)
    found: dict[str, Values] = {}
    for element in elements:
        if {"vertex", "face"} <= found.keys():
            break
        found[element.name], at = _rows(content, at, element)
    if "tristrips" in found and "face" not in found:
        raise ValueError("it has triangle strips in place of faces")
    if not {"vertex", "face"} <= found.keys():
        raise ValueError("it has no faces")
    vertices, normals = (_columns(found["vertex"], names) for names in (("x", "y", "z"), NORMAL))
    if vertices is None:
        raise ValueError("its vertices lack x, y or z")
    return vertices, _triangles(found["face"]), normals


NORMAL = ("nx", "ny", "nz")


def _header(content: bytes) -> tuple[str, list[Element], int]:
    """Byte order, elements, and where the data begin."""
    ending = b"\r\n" if content.startswith(b"ply\r\n") else content[3:4]
    head, found, _ = content[:HEADER_BYTES].partition(b"end_header" + ending)
    if not found or ending not in (b"\n", b"\r", b"\r\n"):
        raise ValueError("its header has no end")
    order, elements = "", list[Element]()
    for line in head.decode("latin-1").split(ending.decode())[1:]:
        match line.split():
            case ["format", form, "1.0"] if form in ORDERS:
                order = ORDERS[form]
            case ["element", name, count] if count.isdecimal():
                elements.append(Element(name, int(count), []))
            case ["property", kind, name] if elements and kind in TYPES:
                elements[-1].properties.append(Property(name, np.dtype(order + TYPES[kind])))
            case ["property", "list", length, kind, name] if (
                elements and {kind, length} <= TYPES.keys()
            ):
                types = (np.dtype(order + TYPES[t]) for t in (kind, length))
                elements[-1].properties.append(Property(name, *types))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise ValueError(f"its header has a line that is not understood: {line[:60]!r}")
    if not order:
        raise ValueError("its header names no format")
    return order, elements, len(head) + len(found)


def _as_binary(text: bytes, elements: list[Element]) -> tuple[bytes, list[Element], int]:
    """The numbers of an ASCII file as a binary one of float64, in which indices are exact."""
    lines = sum(1 for line in text.splitlines() if line.strip())
    rows = sum(element.count for element in elements if element.properties)
    if lines < rows:
        raise ValueError(f"it is cut off: {lines} lines for the {rows} rows that it declares")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            numbers = np.fromstring(text.decode("latin-1"), sep=" ")
        except (DeprecationWarning, ValueError):  # by the version of numpy
            raise ValueError("there is something else than numbers after its header") from None
    double = np.dtype("f8")
    wide = [
        Element(
            element.name,
            element.count,
            [Property(p.name, double, p.length and double) for p in element.properties],
        )
        for element in elements
    ]
    return numbers.tobytes(), wide, 0


def _rows(content: bytes, at: int, element: Element) -> tuple[Values, int]:
    """Values of an element by property, and where the next element begins."""
    if element.count == 0 or not element.properties:
        return {p.name: np.empty((0, 0) if p.length else 0) for p in element.properties}, at
    first, _ = _row(content, at, element)
    fields: list[tuple] = []
    for p in element.properties:
        fields += [(f"{p.name} length", p.length)] if p.length else []
        fields += [(p.name, p.type, first[p.name].shape if p.length else ())]
    dtype = np.dtype(fields)
    if at + element.count * dtype.itemsize <= len(content):
        rows = np.frombuffer(content, dtype, element.count, at)
        lists = [p.name for p in element.properties if p.length]
        if all((rows[f"{name} length"] == first[name].size).all() for name in lists):
            values: Values = {p.name: rows[p.name] for p in element.properties}
            return values, at + element.count * dtype.itemsize
    return _one_by_one(content, at, element)


def _one_by_one(content: bytes, at: int, element: Element) -> tuple[Values, int]:
    """The same for rows of different lengths, and for what is cut off."""
    columns: dict[str, list[NDArray]] = {p.name: [] for p in element.properties}
    for _ in range(element.count):
        row, at = _row(content, at, element)
        for name, value in row.items():
            columns[name].append(value)
    lists = {p.name for p in element.properties if p.length}
    return {k: v if k in lists else np.concatenate(v) for k, v in columns.items()}, at


def _row(content: bytes, at: int, element: Element) -> tuple[dict[str, NDArray], int]:
    row = {}
    for p in element.properties:
        length = 1
        if p.length:
            declared = _take(content, at, p.length, 1, element)[0]
            if not declared >= 0 or declared != int(declared):
                raise ValueError(f"a list of its element '{element.name}' has {declared} entries")
            length, at = int(declared), at + p.length.itemsize
        row[p.name] = _take(content, at, p.type, length, element)
        at += length * p.type.itemsize
    return row, at


def _take(content: bytes, at: int, dtype: np.dtype, count: int, element: Element) -> NDArray:
    if at + count * dtype.itemsize > len(content):
        raise ValueError(
            f"it is cut off: there are not the {element.count} rows of its element "
            f"'{element.name}' that its header declares"
        )
    return np.frombuffer(content, dtype, count, at)


def _columns(values: Values, names: tuple[str, ...]) -> NDArray[np.float64] | None:
    if not set(names) <= values.keys():
        return None
    return np.stack([np.asarray(values[name], dtype=float) for name in names], axis=-1)


def _triangles(values: Values) -> NDArray[np.int64]:
    name = next((name for name in CORNERS if name in values), None)
    faces = np.empty(0) if name is None else values[name]
    if isinstance(faces, np.ndarray) and faces.ndim != 2:
        raise ValueError(f"its faces have no list {' or '.join(CORNERS)}")
    if isinstance(faces, list):
        lengths = np.array([face.size for face in faces])
        alike = [np.stack([f for f in faces if f.size == n]) for n in np.unique(lengths)]
    else:
        alike = [faces]
    fans = [_fans(polygons) for polygons in alike if polygons.shape[1] >= 3]
    return np.concatenate([*fans, np.empty((0, 3), dtype=np.int64)])


def _fans(polygons: NDArray) -> NDArray[np.int64]:
    """Triangles from the first corner of each polygon, shape (polygons * (corners - 2), 3)."""
    if polygons.dtype.kind == "f" and not (polygons == np.floor(polygons)).all():
        raise ValueError("a corner of a face is no whole number")
    first = np.broadcast_to(polygons[:, :1], polygons[:, 2:].shape)
    fans = np.stack([first, polygons[:, 1:-1], polygons[:, 2:]], axis=-1)
    return fans.reshape(-1, 3).astype(np.int64)
