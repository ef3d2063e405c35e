"""Meshes for scenes: those that the project makes itself, and how any mesh is stood up."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.geometry import Mesh


def standing(mesh: Mesh, height: float, width: float, foot: tuple[float, float, float]) -> Mesh:
    """Scale a mesh into a box and stand it on a point.

    Parameters
    ----------
    mesh : Mesh
        With y up, and no vertex that no face uses.
    height, width : float
        The largest extent allowed along y, and along x and z; one of them is reached.
    foot : tuple of float
        Where the middle of the lower side of the bounding box comes to lie.
    """
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    extent = high - low
    scale = 1 / max(extent[1] / height, extent[0] / width, extent[2] / width)
    middle = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    return replace(mesh, vertices=(mesh.vertices - middle) * scale + foot)


def figure() -> Mesh:
    """Make the project's own non-convex figure: a tall woven knot on a turned pedestal.

    It is brushed along the tube of the knot, and up the pedestal.
    """
    return _joined(_knot(segments=400, sides=24), _pedestal(rings=64, sides=80))


def cloth() -> Mesh:
    """Make a piece of cloth that hangs in folds from its upper edge, with threads that run up.

    It is 2 wide and high, and faces z. The folds are flat where it is held and deepen towards the
    lower edge, where they drift apart.
    """
    u, v = np.meshgrid(np.linspace(-1, 1, 241), np.linspace(-1, 1, 241))
    hangs = ((1 - v) / 2) ** 0.7
    folds = np.cos(7.5 * u * (1 - 0.12 * hangs) + 0.6 * np.sin(2.0 * u + 1.5 * v))
    fine = np.cos(17.0 * u + 1.3 * np.sin(3.0 * v) + 2.0)
    depth = (0.03 + 0.13 * hangs) * folds + 0.02 * hangs * fine
    points = np.stack([u * (1 - 0.06 * hangs), v, depth], axis=-1)
    return lattice_mesh(
        points, lattice(np.arange(u.size).reshape(u.shape)), np.gradient(points, axis=0)
    )


def _knot(segments: int, sides: int) -> Mesh:
    """Make a tube along a torus knot, twice around y and five times around the tube of a torus."""
    t = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    out = 0.25 + 0.135 * np.cos(5 * t)
    curve = np.stack([out * np.sin(2 * t), 0.63 * np.sin(5 * t), out * np.cos(2 * t)], axis=-1)
    tangent = np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0)
    # Towards the axis, as seen along the curve: never parallel to the tangent of this knot.
    inward = np.stack([np.sin(2 * t), np.sin(5 * t), np.cos(2 * t)], axis=-1)
    across = np.cross(tangent, inward)
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    outward = np.cross(across, tangent)
    outward /= np.linalg.norm(outward, axis=-1, keepdims=True)
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)[:, None]
    ring = np.cos(angle) * outward[:, None] + np.sin(angle) * across[:, None]
    points = curve[:, None] + 0.08 * ring + [0.0, 1.13, 0.0]
    threads = np.broadcast_to(tangent[:, None], points.shape)
    return lattice_mesh(points, quads(segments, sides, closed=True), threads)


def _pedestal(rings: int, sides: int) -> Mesh:
    """Make a turned foot with a waist, 0.5 high, closed by a pole at either end."""
    s = np.linspace(0, 1, rings)
    cosine = np.cos(np.pi * s)
    sine = np.sqrt(1 - cosine**2)
    height = 0.25 * (1 - cosine)
    radius = 0.4 * sine**0.25 * (1 - 0.38 * sine**4 - 0.12 * s)
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    points = np.stack(
        np.broadcast_arrays(
            radius[:, None] * np.cos(angle), height[:, None], -radius[:, None] * np.sin(angle)
        ),
        axis=-1,
    )
    return lattice_mesh(points, quads(rings, sides, closed=False), np.gradient(points, axis=0))


def quads(rows: int, columns: int, *, closed: bool) -> NDArray[np.int64]:
    """Triangles over a rows x columns lattice, closed in columns, and in rows if asked."""
    index = np.arange(rows * columns).reshape(rows, columns)
    index = np.concatenate([index, index[:, :1]], axis=1)
    return lattice(np.concatenate([index, index[:1]]) if closed else index)


def lattice(index: NDArray[np.int64]) -> NDArray[np.int64]:
    """Triangles over a lattice of vertices."""
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    triangles = np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    return triangles.reshape(-1, 3)


def lattice_mesh(points: NDArray, faces: NDArray, threads: NDArray | None = None) -> Mesh:
    """Mesh of a lattice of points and of the directions of its threads there, of any length."""
    import trimesh

    mesh = trimesh.Trimesh(points.reshape(-1, 3), faces, process=False)
    along = None
    if threads is not None:
        flat = threads.reshape(-1, 3)
        along = flat / np.linalg.norm(flat, axis=1, keepdims=True)
    return Mesh(np.array(mesh.vertices), np.array(mesh.faces), np.array(mesh.vertex_normals), along)


def _joined(first: Mesh, second: Mesh) -> Mesh:
    return Mesh(
        np.concatenate([first.vertices, second.vertices]),
        np.concatenate([first.faces, second.faces + len(first.vertices)]),
        np.concatenate([first.normals, second.normals]),
        np.concatenate([first.threads, second.threads]),
    )
