"""Meshes from files: PLY, and whatever else trimesh reads."""

import logging
import re
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.rendering import ply
from npfm.rendering.geometry import Array, Mesh
from npfm.storage.lookalikes import JSON, PLY, mistaken

#: Vertices so near, in sizes of the mesh, are at one place: far less than a pixel.
SAME_PLACE = 1e-6
#: Binary STL: a comment and the number of faces, then for each its normal, corners and two bytes.
STL_HEADER_BYTES, STL_FACE_BYTES = 84, 50


def load_mesh(path: str | Path) -> Mesh:
    """Read a mesh: the faces that have an area, and the vertices that they use.

    Its normals are those of the file at the vertices that have any; elsewhere they are averaged,
    weighted by angle, over the faces around a place, whether they share a vertex there or not.

    Parameters
    ----------
    path : str or Path
        PLY, or another format that trimesh reads (OBJ, STL, OFF, glTF). y points up.

    Raises
    ------
    NpfmError
        If the file is absent, cannot be read as a mesh, or has no faces, a face names a vertex
        that is not there, or a vertex in use is NaN or infinite.
    """
    path = Path(path)
    if not path.exists():
        raise NpfmError(f"{path}: no such file; give the path of a PLY mesh")
    if other := mistaken(path, "a mesh", PLY, JSON):
        raise NpfmError(f"{path}: {other}")
    try:
        vertices, faces, normals = _read(path)
    # A reader meets whatever the file holds with whatever exception comes up.
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise NpfmError(
            f"{path}: not a readable mesh ({reason}); export it again, as PLY"
        ) from error
    if len(faces) == 0:
        raise NpfmError(f"{path}: a mesh without faces; export it with its triangles")
    wrong = (faces < 0) | (faces >= len(vertices))
    if wrong.any():
        raise NpfmError(
            f"{path}: a face names vertex {faces[wrong][0]}, and there are 0 to "
            f"{len(vertices) - 1}; export the mesh again"
        )
    return _used(path, vertices, faces, normals)


def _read(path: Path) -> tuple[Array, NDArray[np.int64], Array | None]:
    """Vertices, triangles, and the normals at the vertices if the file has any."""
    content = path.read_bytes()
    if content.startswith(b"ply"):
        return ply.parse(content)
    import trimesh

    # What it complains of, it raises as well; a traceback in its log is no line of ours.
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    check = {".stl": _whole_stl, ".off": _whole_off, ".obj": _whole_obj}.get(path.suffix.lower())
    source = BytesIO(check(content)) if check else path
    kind = path.suffix[1:].lower()
    mesh: Any = trimesh.load(source, file_type=kind, process=False, skip_materials=True)
    if isinstance(mesh, trimesh.Scene):
        mesh = mesh.to_mesh()
    vertices = np.asarray(mesh.vertices, dtype=np.float64)
    if not hasattr(mesh, "faces"):
        return vertices, np.empty((0, 3), dtype=np.int64), None
    # Where trimesh keeps the normals of a file; its property computes them where there are none.
    normals = np.asarray(mesh._cache.cache.get("vertex_normals", ()), dtype=np.float64)
    faces = np.asarray(mesh.faces, dtype=np.int64)
    return vertices, faces, normals if normals.shape == vertices.shape else None


def _whole_stl(content: bytes) -> bytes:
    """A binary STL file without bytes after its end, which trimesh would take for ASCII."""
    if content.lstrip().startswith(b"solid") and b"facet" in content:
        if b"endsolid" not in content:
            raise ValueError("it is cut off: it has no endsolid")
        return content
    count = int.from_bytes(content[STL_HEADER_BYTES - 4 : STL_HEADER_BYTES], "little")
    end = STL_HEADER_BYTES + STL_FACE_BYTES * count
    if len(content) < max(end, STL_HEADER_BYTES):
        raise ValueError(f"it is cut off: there are not the {count} faces that its header declares")
    return content[:end]


def _whole_off(content: bytes) -> bytes:
    """An OFF file that has the faces that it declares; trimesh takes fewer."""
    lines = [line.partition(b"#")[0].split() for line in content.splitlines()]
    numbers = [word for words in lines for word in words if not word.upper().endswith(b"OFF")]
    filled = sum(1 for words in lines if words) - (len(lines[0]) == 1)
    vertices, faces = (int(number) for number in numbers[:2])
    if filled < 1 + vertices + faces:
        raise ValueError(f"it is cut off: there are not the {faces} faces that it declares")
    return content


def _whole_obj(content: bytes) -> bytes:
    """An OBJ file whose faces name vertices as OBJ does, from 1; trimesh takes 0 for the last."""
    if re.search(rb"^f\b.*\s0(/|\s|$)", content, re.MULTILINE):
        raise ValueError("a face names vertex 0, and OBJ counts from 1")
    return content


def _used(path: Path, vertices: Array, faces: NDArray[np.int64], normals: Array | None) -> Mesh:
    """The part of a mesh that can be seen, with normals at all its vertices."""
    used, corners = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], corners.reshape(faces.shape)
    normals = np.full(vertices.shape, np.nan) if normals is None else normals[used]
    with np.errstate(over="ignore"):
        extent = np.ptp(vertices, axis=0).max()
    if not np.isfinite(vertices).all() or not np.isfinite(extent):
        raise NpfmError(f"{path}: vertices are NaN or infinite; export the mesh again")
    # In a box of size 1, so that no threshold depends on the unit of the file.
    unit = (vertices - vertices.min(axis=0)) / max(extent, np.finfo(float).tiny)
    a, b, c = (unit[faces[:, k]] for k in range(3))
    seen = np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0
    if not seen.any():
        raise NpfmError(f"{path}: no face has an area; export the mesh again")
    if not seen.all():
        return _used(path, vertices, faces[seen], normals)
    with np.errstate(over="ignore"):
        length = np.linalg.norm(normals, axis=1, keepdims=True)
    sound = np.isfinite(length) & (length > 0)
    given = np.divide(normals, length, out=np.zeros_like(normals), where=sound)
    return Mesh(vertices, faces, np.where(sound, given, _averaged(unit, faces)))


def _averaged(unit: Array, faces: NDArray[np.int64]) -> Array:
    """Normals averaged over the faces around each place of a mesh in a box of size 1."""
    import trimesh

    rounded = np.round(unit / SAME_PLACE)
    _, first, place = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    place = place.reshape(-1)
    merged = trimesh.Trimesh(unit[first], place[faces], process=False)
    return np.asarray(merged.vertex_normals)[place]
