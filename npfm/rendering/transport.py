"""The transport matrix: a scene in a light, as weights of the cells of a table.

Direct lighting is linear in the BRDF. For a fixed scene a pixel is a weighted sum of table
entries, so a picture is T @ table. `npfm.rendering.assembly` builds T, once for all materials.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from npfm.errors import NpfmError
from npfm.reflectance import grids
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.storage.files import Kind, replacing


@dataclass(frozen=True)
class Transport:
    """A scene in a light as a sparse matrix, pixels x columns, with one value set per channel.

    Parameters
    ----------
    indptr : ndarray of int64, shape (pixels + 1,)
        Where the entries of a pixel begin; pixels row by row from the upper left corner.
    indices : ndarray of int32, shape (n,)
        Columns of the grid, increasing within a pixel.
    weights : ndarray of float32, shape (3, n)
        Radiance per BRDF (1/sr), for red, green and blue.
    coverage : ndarray of float32, shape (h, w)
        Share of a pixel that objects cover.
    backdrop : ndarray of float32, shape (h, w, 3)
        Radiance of the light seen past the objects, times the share of the pixel it fills.
    grid : Grid
        Whose columns they are.
    """

    indptr: NDArray[np.int64]
    indices: NDArray[np.int32]
    weights: NDArray[np.float32]
    coverage: NDArray[np.float32]
    backdrop: NDArray[np.float32]
    grid: Grid

    @property
    def foreground(self) -> NDArray[np.bool_]:
        """Pixels that objects cover entirely, shape (h, w)."""
        return self.coverage == 1

    @property
    def arrays(self) -> dict[str, NDArray]:
        """All of it as arrays by name, the grid by its kind and shape: the files of its folder."""
        arrays = {name: value for name, value in vars(self).items() if name != "grid"}
        kind, shape = np.array(self.grid.kind), np.array(self.grid.shape)
        return arrays | {"grid_kind": kind, "grid_shape": shape}

    @property
    def matrices(self) -> list[csr_array]:
        """T for red, green and blue, shape (pixels, columns)."""
        # SciPy would copy the indices to give them the type of indptr.
        fits = self.indptr[-1] <= np.iinfo(np.int32).max
        indptr = self.indptr.astype(np.int32 if fits else np.int64)
        shape = self.coverage.size, self.grid.column_count
        return [csr_array((weights, self.indices, indptr), shape=shape) for weights in self.weights]


def render(transport: Transport, table: Table) -> NDArray[np.float32]:
    """Render a material: T @ table, over the light seen past the objects.

    Parameters and errors are those of `reflected`.

    Returns
    -------
    ndarray of float32, shape (h, w, 4)
        Linear radiance in red, green and blue, and the coverage by objects.
    """
    return over_backdrop(transport, reflected(transport, table))


def over_backdrop(transport: Transport, light: NDArray[np.float32]) -> NDArray[np.float32]:
    """Put light that objects reflect, (h, w, 3), over the light seen past them: (h, w, 4)."""
    return np.dstack([light + transport.backdrop, transport.coverage])


def reflected(transport: Transport, table: Table) -> NDArray[np.float32]:
    """Light that objects of a material reflect: T @ table.

    Parameters
    ----------
    transport : Transport
    table : Table
        BRDF in 1/sr; negative entries reflect nothing.

    Returns
    -------
    ndarray of float32, shape (h, w, 3)
        Linear RGB radiance, times the share of the pixel that objects cover.

    Raises
    ------
    NpfmError
        If the table is on another grid than the matrix was built for.
    """
    if table.grid != transport.grid:
        raise NpfmError(
            f"the table is on the grid {table.grid.name}, the scene was built for "
            f"{transport.grid.name}; build the scene for the grid of the table"
        )
    values = table.grid.column_values(table.values).astype(np.float32)
    light = np.empty((*transport.coverage.shape, 3), dtype=np.float32)
    for channel, (matrix, column) in enumerate(zip(transport.matrices, values, strict=True)):
        light[..., channel] = (matrix @ column).reshape(transport.coverage.shape)
    return light


def columns(shown: Sequence[Table]) -> NDArray[np.float32]:
    """What `pictures` renders of many tables, shape (3, columns, tables).

    Raises
    ------
    NpfmError
        If the tables are on different grids.
    """
    names = {table.grid.name for table in shown}
    if len(names) > 1:
        raise NpfmError(f"tables on the grids {' and '.join(sorted(names))}; give those of one")
    return np.stack([t.grid.column_values(t.values).astype(np.float32) for t in shown], axis=-1)


def pictures(matrix: Transport, values: NDArray[np.float32]) -> NDArray[np.float32]:
    """Render many tables in one pass over the matrix, in a fraction of the time of one by one.

    Parameters
    ----------
    matrix : Transport
    values : ndarray of float32, shape (3, columns, tables)
        BRDF in 1/sr of the grid's columns; negative values reflect nothing.

    Returns
    -------
    ndarray of float32, shape (tables, h, w, 3)
        Linear radiance, as `render` gives it for each table.

    Raises
    ------
    NpfmError
        If the tables are on another grid than the matrix was built for.
    """
    if values.shape[1] != matrix.grid.column_count:
        raise NpfmError(
            f"the scene was built for {matrix.grid.name}, and the tables are on another grid; "
            "build it for theirs"
        )
    products = [
        channel @ np.maximum(columns, 0)
        for channel, columns in zip(matrix.matrices, values, strict=True)
    ]
    lit = np.stack(products, axis=-1).reshape(*matrix.coverage.shape, -1, 3)
    return np.moveaxis(lit, 2, 0) + matrix.backdrop


def _is_scene(path: Path) -> bool:
    """Whether a folder, no link, is empty, or has the files of a matrix and nothing else."""
    if path.is_symlink() or not path.is_dir():
        return False
    names = {entry.name for entry in path.iterdir()}
    needed = {f"{field.name}.npy" for field in fields(Transport) if field.name != "grid"}
    # Matrices did not name the kind of their grid at first.
    return not names or names - {"grid_kind.npy"} == needed | {"grid_shape.npy"}


SCENE = Kind("a scene", "", _is_scene)


def save(path: str | Path, transport: Transport) -> None:
    """Write a matrix as a folder of ``.npy`` files, whole or not at all."""
    with replacing(path, SCENE) as temporary:
        temporary.mkdir()
        for name, value in transport.arrays.items():
            with open(temporary / f"{name}.npy", "wb") as file:
                # Not np.save, which says nothing when the disk is full for its last bytes.
                np.lib.format.write_array(SimpleNamespace(write=file.write), value)


def load(path: str | Path) -> Transport:
    """Open a matrix that `save` wrote, mapped into memory, so that processes share it.

    Raises
    ------
    NpfmError
        If a file of the folder is absent or damaged.
    """

    def read(name: str) -> NDArray:
        return np.load(Path(path) / f"{name}.npy", mmap_mode="r")

    try:
        arrays = {
            field.name: read(field.name) for field in fields(Transport) if field.name != "grid"
        }
        shape = read("grid_shape")
        # Matrices had only one kind of grid at first, and did not name it.
        named = (Path(path) / "grid_kind.npy").exists()
        kind = str(read("grid_kind")) if named else HalfDifference.kind
        return Transport(**arrays, grid=grids.named(kind, shape.tolist()))
    except (OSError, ValueError, NpfmError) as error:
        raise NpfmError(
            f"{path}: not a transport matrix that npfm wrote ({error}); build it again"
        ) from error
