"""Grids that tables live on: what every kind of grid can do, and the kinds there are.

A grid divides pairs of light and view directions into cells. What it stands on is the surface: a
normal, and for anisotropic reflection a tangent from which azimuths are counted. Files of fits and
of transport matrices name the kind and the shape of theirs, from which `named` makes it again.
"""

from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference

Array = NDArray[np.float64]


class Grid(Protocol):
    """A division of pairs of directions into cells.

    Grids are equal if they are of one kind and shape, and can be keys of dictionaries.
    """

    #: Name of the kind, in files and messages.
    kind: ClassVar[str]
    #: Whether cells depend on how a surface is turned about its normal.
    anisotropic: ClassVar[bool]

    @property
    def shape(self) -> tuple[int, ...]:
        """Bins along each axis of a table."""

    @property
    def size(self) -> int:
        """Number of cells."""

    @property
    def name(self) -> str:
        """Kind and shape, for messages."""

    @property
    def above_horizon(self) -> NDArray[np.bool_]:
        """Where light and view at the centre of a cell both lie above the horizon."""

    @property
    def cosines(self) -> tuple[Array, Array]:
        """Cosines of theta_i and theta_o at the centres of the cells."""

    @property
    def theta_h_edges(self) -> Array:
        """Edges of bins of theta_h from 0 to pi/2, as narrow as highlights are resolved."""

    def theta_h_bin(self, theta_h: Array) -> NDArray[np.integer]:
        """Bins between these edges that angles in [0, pi/2] fall into."""

    def axes(self, normal: Array, view: Array, tangent: Array | None) -> tuple[Array, Array, Array]:
        """Vectors (p, 3) at p points along which `cells` wants directions; the first is the normal.

        They need neither be unit vectors nor orthogonal.
        """

    def cells(
        self, light: Array, view: Array, point: NDArray[np.intp]
    ) -> tuple[NDArray[np.int32], Array | None]:
        """Cells of a table that give the BRDF of pairs of directions above the horizon.

        Parameters
        ----------
        light : ndarray, shape (n, 3)
            Components of light directions along the axes.
        view : ndarray, shape (p, 3)
            Components of the view directions of the points.
        point : ndarray of int, shape (n,)
            The point that each light direction belongs to.

        Returns
        -------
        index : ndarray of int32, shape (n,) or (n, k)
            Indices into a flattened table.
        share : ndarray, shape (n, k), or None
            Weights of the interpolation between k cells, or of an extrapolation, which are negative
            in part: what they give is 0 where it would be below. None where one cell has it all.
        """

    @property
    def column_count(self) -> int:
        """Number of columns of a transport matrix."""

    def columns(
        self, light: Array, view: Array, point: NDArray[np.intp]
    ) -> tuple[NDArray[np.int32], Array | None]:
        """Columns of a transport matrix that pairs of directions fall into, as `cells`.

        They are the cells of a table, but for grids that extrapolate: a matrix is linear, so that
        what is beyond their tables has columns of its own, and no weight is negative.
        """

    def column_values(self, values: Array) -> Array:
        """What a matrix is multiplied by: BRDFs (3, column_count) of a table (3,) + shape.

        None is below 0: what was not measured reflects nothing.
        """


#: What makes a grid of a kind from its shape.
KINDS: dict[str, Callable[..., Grid]] = {
    Directional.kind: Directional,
    HalfDifference.kind: HalfDifference,
}
#: Columns of a transport matrix are int32.
MOST_COLUMNS = 2**31 - 1


def named(kind: str, shape: Sequence[int]) -> Grid:
    """Make the grid of a kind and a shape.

    Raises
    ------
    NpfmError
        If there is no such kind, or its grids have another number of axes.
    """
    if kind not in KINDS:
        raise NpfmError(f"unknown kind of grid '{kind}'; {suggest(kind, KINDS)}")
    try:
        grid = KINDS[kind](*map(int, shape))
    except TypeError:
        grid = None
    if grid is None or grid.shape != tuple(shape):
        raise NpfmError(f"a {kind} grid does not have {len(shape)} axes")
    return grid


def parse(words: Sequence[str]) -> Grid:
    """Make a grid from how it is named, such as ``directional 6x48x6x48``.

    Parameters
    ----------
    words : sequence of str
        The kind, and the shape if it is not the usual one: MERL's, or that of the UTIA database.

    Raises
    ------
    NpfmError
        If there is no such kind, or that is no shape of it.
    """
    kind, *shape = words
    counts = shape[0].split("x") if len(shape) == 1 else []
    if len(shape) > 1 or not all(count.isdecimal() and int(count) > 0 for count in counts):
        raise NpfmError(f"{' '.join(words)}: no shape of a grid; give one such as 6x48x6x48")
    if kind in KINDS and not counts:
        return KINDS[kind]()
    grid = named(kind, [int(count) for count in counts])
    if grid.column_count > MOST_COLUMNS:
        raise NpfmError(f"{' '.join(words)}: too fine; {MOST_COLUMNS} cells are the most")
    return grid


def components(directions: Array, axes: tuple[Array, Array, Array]) -> Array:
    """Components (p, 3) of p directions along axes of the points that they belong to."""
    return np.stack([np.einsum("ij,ij->i", axis, directions) for axis in axes], axis=-1)


def local_cells(grid: Grid, light: Array, view: Array) -> tuple[NDArray[np.int32], Array | None]:
    """Cells of pairs of directions (n, 3) over a surface with normal z and tangent x."""
    normal, tangent = (np.broadcast_to(axis, view.shape) for axis in np.eye(3)[[2, 0]])
    axes = grid.axes(normal, view, tangent)
    return grid.cells(components(light, axes), components(view, axes), np.arange(len(view)))
