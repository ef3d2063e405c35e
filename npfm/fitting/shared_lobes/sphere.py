"""Where pairs of directions on a directional grid read D, F and G of shared lobes.

As in section 2.4 of Peng et al. 2017, D is read linearly in theta_h and phi_h and F linearly in
theta_d. G has a node at every direction of the grid, and is read there. The node at the normal is
one, though tables have it once for every azimuth: a direction has one value.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import fsum

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.shared_lobes.places import Places
from npfm.reflectance.directional import HALF_PI, Directional
from npfm.reflectance.table import Table

Array = NDArray[np.float64]
Nodes = NDArray[np.int16]

#: Nodes of F, of theta_d from 0 in steps of a degree (section 2.2; the paper does not say where).
F_NODES = 90
#: Digits that are kept of places between nodes: directions that are turned by whole bins, or light
#: and view exchanged, differ by rounding, and read the same nodes all the same.
DIGITS = 10


@dataclass(frozen=True)
class Reading:
    """Nodes that pairs of directions read, and weights.

    Parameters
    ----------
    D_nodes, D_taps : ndarray, shape (n, 4)
        Of D on the nodes of `node_count`.
    F_nodes, F_taps : ndarray, shape (n, 2)
    G : Places
        Of one column and one tap.
    """

    D_nodes: Nodes
    D_taps: Array
    F_nodes: Nodes
    F_taps: Array
    G: Places

    def D_at(self, D: Array) -> Array:
        """Values (n, lobes) of each lobe's D."""
        return np.ascontiguousarray(np.einsum("nt,lnt->nl", self.D_taps, D[:, self.D_nodes]))

    def F_at(self, F: Array) -> Array:
        """Values (channels, n) of each channel's F."""
        return np.ascontiguousarray(np.einsum("nt,cnt->cn", self.F_taps, F[:, self.F_nodes]))


def node_count(grid: Directional) -> int:
    """Nodes of a D or a G: the normal, and the other directions of the grid."""
    return 1 + (grid.theta_i_count - 1) * grid.phi_i_count


def theta_of_nodes(grid: Directional) -> Array:
    """Angle of each node to the normal."""
    return np.append(0.0, np.repeat(grid.theta_i[1:], grid.phi_i_count))


def spread(lobe: Array, grid: Directional) -> Array:
    """Values at nodes S + (node_count,) by elevation and azimuth, S + (theta_i, phi_i)."""
    normal = np.repeat(lobe[..., :1], grid.phi_i_count, axis=-1)
    rest = lobe[..., 1:].reshape(*lobe.shape[:-1], -1, grid.phi_i_count)
    return np.concatenate([normal[..., None, :], rest], axis=-2)


def gathered(lobe: Array) -> Array:
    """Undo `spread`: values of shape S + (theta_i, phi_i) at nodes."""
    return np.concatenate([lobe[..., 0, :1], lobe[..., 1:, :].reshape(*lobe.shape[:-2], -1)], -1)


def first_azimuth(table: Table[Directional]) -> int:
    """Azimuth of the light, as an index, that most is reflected from; sums are exact.

    The same direction of a table that is turned, whatever rounding does to sums in another order.
    """
    values = np.maximum(np.nan_to_num(table.values), 0)
    by_phi = np.moveaxis(values, 2, 0).reshape(table.grid.phi_i_count, -1)
    return int(np.argmax([fsum(values) for values in by_phi]))


def turned(table: Table[Directional], bins: int) -> Table[Directional]:
    """A table whose surface is turned about its normal by so many azimuths."""
    return Table(np.roll(table.values, (bins, bins), axis=(2, 4)), table.grid)


@lru_cache(maxsize=2)
def reading_of_all(grid: Directional) -> Reading:
    """Where all cells of a grid read, in their order."""
    return reading(grid, np.arange(grid.size))


def reading(grid: Directional, cells: NDArray[np.intp]) -> Reading:
    """Where some cells of a grid read.

    Parameters
    ----------
    grid : Directional
        Whose light and view have the same directions.
    cells : ndarray, shape (n,)
        Flat indices.
    """
    count = grid.theta_i_count * grid.phi_i_count
    i, o = np.divmod(cells, count)
    light, view = grid.light.reshape(-1, 3)[i], grid.view.reshape(-1, 3)[o]
    D_nodes, D_taps = _half_vectors(light + view, grid)
    F_nodes, F_taps = _difference_angles(light, view)
    first = [np.maximum(x - grid.phi_i_count + 1, 0).astype(np.int16)[:, None] for x in (i, o)]
    tap = np.ones((len(cells), 1, 1))
    inverse = 1 / (light[:, 2:] * view[:, 2:])
    places = Places(first[0], tap, first[1], tap, np.ascontiguousarray(inverse), node_count(grid))
    return Reading(D_nodes, D_taps, F_nodes, F_taps, places)


def _half_vectors(along: Array, grid: Directional) -> tuple[Nodes, Array]:
    """Four nodes around half vectors (n, 3) of any length, and their weights."""
    across = np.hypot(along[:, 0], along[:, 1])
    theta = np.arctan2(across, along[:, 2]) / HALF_PI * grid.theta_i_count
    phi = np.arctan2(along[:, 1], along[:, 0]) / (2 * np.pi) * grid.phi_i_count
    low, part = _between(theta, grid.theta_i_count)
    phi = np.round(phi, DIGITS)
    near = np.floor(phi)
    turn = phi - near
    columns = np.stack([near, near + 1], -1).astype(np.intp) % grid.phi_i_count
    rings = np.stack([low, np.minimum(low + 1, grid.theta_i_count - 1)], -1)
    nodes = 1 + (rings[:, :, None] - 1) * grid.phi_i_count + columns[:, None]
    nodes = np.where(rings[:, :, None] == 0, 0, nodes)
    taps = np.stack([1 - part, part], -1)[:, :, None] * np.stack([1 - turn, turn], -1)[:, None]
    return nodes.reshape(-1, 4).astype(np.int16), taps.reshape(-1, 4)


def _difference_angles(light: Array, view: Array) -> tuple[Nodes, Array]:
    """Two nodes of F around theta_d, and their weights."""
    apart, together = (np.linalg.norm(v, axis=-1) for v in (light - view, light + view))
    low, part = _between(np.arctan2(apart, together) / HALF_PI * F_NODES, F_NODES)
    nodes = np.stack([low, np.minimum(low + 1, F_NODES - 1)], -1).astype(np.int16)
    return nodes, np.stack([1 - part, part], -1)


def _between(place: Array, count: int) -> tuple[NDArray[np.intp], Array]:
    """Node below places among `count`, and the part of the way to the next."""
    place = np.clip(np.round(place, DIGITS), 0, count - 1)
    low = np.minimum(place.astype(np.intp), max(count - 2, 0))
    return low, place - low
