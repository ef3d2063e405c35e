"""A material that is another product of factors at each pixel (Bagher et al. 2016, equation 3).

A blend of tables is linear in them: their pictures, weighted at each pixel, are exact. A blend of
factors is not, and each pixel would need a table of its own. But it needs few cells of it, those
that its row of the transport matrix names: the product is worked out there and nowhere else.
"""

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import HalfDifference
from npfm.rendering.transport import Transport

Array = NDArray[np.float64]

#: Pixels whose factors are in memory at once: 6.5 kB each.
BLOCK = 4096


@dataclass(frozen=True)
class Products:
    """rho_d + rho_s D(theta_h) F(theta_d) G(theta_i) G(theta_o) / (cos theta_i cos theta_o).

    Parameters
    ----------
    D, F, G : ndarray, shapes (n, 3, theta_h), (n, 3, theta_d), (n, 3, nodes)
        Of each of n materials, and each channel.
    rho_s, rho_d : ndarray, shape (n, 3)
        In 1/sr.
    """

    D: Array
    F: Array
    G: Array
    rho_s: Array
    rho_d: Array

    @property
    def arrays(self) -> tuple[Array, Array, Array, Array, Array]:
        """All of it, in the order of the arguments of `npfm.rendering.product_kernel`."""
        D, F, G = map(np.ascontiguousarray, (self.D, self.F, self.G))
        return D, F, G, np.ascontiguousarray(self.rho_s), np.ascontiguousarray(self.rho_d)


@dataclass(frozen=True)
class Reading:
    """Where cells of a half-difference grid read G, linearly between two nodes of it.

    Parameters
    ----------
    node_i, node_o : ndarray of int16, shape (theta_h * theta_d, phi_d / 2)
        The first of the nodes, for cells with phi_d in its first half.
    part_i, part_o : ndarray
        How far the angle is on the way to the next node.
    inverse_cosines : ndarray
        1 / (cos theta_i cos theta_o); 0 below the horizon, where nothing is reflected.
    """

    node_i: NDArray[np.int16]
    part_i: Array
    node_o: NDArray[np.int16]
    part_o: Array
    inverse_cosines: Array

    @property
    def arrays(self) -> tuple[NDArray[np.int16], Array, NDArray[np.int16], Array, Array]:
        """All of it, in the order of the arguments of `npfm.rendering.product_kernel`."""
        return self.node_i, self.part_i, self.node_o, self.part_o, self.inverse_cosines


def compiled() -> ModuleType:
    """Return `npfm.rendering.product_kernel`; who takes the time of pictures calls this before."""
    from npfm.rendering import product_kernel

    return product_kernel


def render_products(
    matrix: Transport, at: Reading, products_of: Callable[[NDArray[np.int64]], Products]
) -> NDArray[np.float32]:
    """Render a material whose factors differ from pixel to pixel.

    Parameters
    ----------
    matrix : Transport
        Scene and light, on a half-difference grid.
    at : Reading
        Of that grid.
    products_of : callable
        Gives the factors at pixels, whose numbers it takes.

    Returns
    -------
    ndarray of float32, shape (h, w, 4)
        As `npfm.rendering.transport.render`.

    Raises
    ------
    NpfmError
        If the matrix is on another kind of grid.
    """
    grid = matrix.grid
    if not isinstance(grid, HalfDifference):
        raise NpfmError(f"factors are of half-difference tables, and the scene of {grid.name}")
    picture = np.empty((*matrix.coverage.shape, 4), dtype=np.float32)
    picture[..., :3], picture[..., 3] = matrix.backdrop, matrix.coverage
    flat = picture.reshape(-1, 4)
    seen, radiances = np.flatnonzero(np.diff(matrix.indptr)), compiled().radiances
    # A matrix that is mapped into memory is of a type of its own.
    indptr, indices, weights = map(np.asarray, (matrix.indptr, matrix.indices, matrix.weights))
    for first in range(0, len(seen), BLOCK):
        pixels = seen[first : first + BLOCK]
        factors = products_of(pixels).arrays
        flat[pixels, :3] += radiances(indptr, indices, weights, pixels, *factors, *at.arrays)
    return picture
