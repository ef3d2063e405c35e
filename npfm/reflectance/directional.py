"""The grid of the UTIA database's tables: both directions, each by elevation and azimuth."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HALF_PI = np.pi / 2
#: Columns of a transport matrix from a table's last elevation to the horizon, in each direction:
#: `Directional.columns`.
BEYOND = 3
#: Bins of theta_h to the step of theta_i, for `Directional.theta_h_edges`.
HALF_VECTORS = 2


@dataclass(frozen=True)
class Directional:
    """Elevations and azimuths of light and view; the defaults are the UTIA database's.

    Elevations are k / n of 90 degrees, k from 0 to n - 1, and azimuths k / n of 360 degrees: 0, 15,
    ..., 75 and 0, 7.5, ..., 352.5. Azimuths are counted from the tangent to normal x tangent. A
    table has values at these directions, and between them they are interpolated linearly in the
    four angles, from sixteen cells. Beyond the last elevation they go on linearly as between the
    last two, but not below 0: so they do in the database's own readers.

    Parameters
    ----------
    theta_i_count, phi_i_count, theta_o_count, phi_o_count : int
        Number of elevations and azimuths of light and view, each at least 1.
    """

    kind: ClassVar[str] = "directional"
    anisotropic: ClassVar[bool] = True

    theta_i_count: int = 6
    phi_i_count: int = 48
    theta_o_count: int = 6
    phi_o_count: int = 48

    @property
    def shape(self) -> tuple[int, int, int, int]:
        """Number of elevations and azimuths of the light, and of the view."""
        return self.theta_i_count, self.phi_i_count, self.theta_o_count, self.phi_o_count

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.theta_i_count * self.phi_i_count * self.theta_o_count * self.phi_o_count

    @property
    def name(self) -> str:
        """Kind and shape, for messages."""
        return f"{self.kind} " + "x".join(map(str, self.shape))

    @cached_property
    def theta_i(self) -> Array:
        """Elevations of the light in radians from the normal, shape (theta_i_count,)."""
        return np.arange(self.theta_i_count) / self.theta_i_count * HALF_PI

    @cached_property
    def phi_i(self) -> Array:
        """Azimuths of the light in radians, shape (phi_i_count,)."""
        return np.arange(self.phi_i_count) / self.phi_i_count * 2 * np.pi

    @cached_property
    def theta_o(self) -> Array:
        """Elevations of the view in radians from the normal, shape (theta_o_count,)."""
        return np.arange(self.theta_o_count) / self.theta_o_count * HALF_PI

    @cached_property
    def phi_o(self) -> Array:
        """Azimuths of the view in radians, shape (phi_o_count,)."""
        return np.arange(self.phi_o_count) / self.phi_o_count * 2 * np.pi

    @cached_property
    def light(self) -> Array:
        """Unit vectors to the light, normal z and tangent x: (theta_i_count, phi_i_count, 3)."""
        return directions(self.theta_i[:, None], self.phi_i)

    @cached_property
    def view(self) -> Array:
        """Unit vectors to the viewer, as `light`: (theta_o_count, phi_o_count, 3)."""
        return directions(self.theta_o[:, None], self.phi_o)

    @cached_property
    def above_horizon(self) -> NDArray[np.bool_]:
        """Where light and view lie above the horizon, shape `shape`: in all cells."""
        return np.ones(self.shape, dtype=bool)

    @cached_property
    def cosines(self) -> tuple[Array, Array]:
        """Cosines of theta_i and theta_o of all cells, shape `shape` each."""
        cos_i = np.broadcast_to(np.cos(self.theta_i)[:, None, None, None], self.shape)
        return cos_i, np.broadcast_to(np.cos(self.theta_o)[:, None], self.shape)

    @cached_property
    def theta_h_edges(self) -> Array:
        """Edges of bins of theta_h from 0 to pi/2, half as wide as the steps of theta_i."""
        return np.linspace(0, HALF_PI, HALF_VECTORS * self.theta_i_count + 1)

    def theta_h_bin(self, theta_h: Array) -> NDArray[np.int32]:
        """Bins between these edges that angles in [0, pi/2] fall into."""
        bins = HALF_VECTORS * self.theta_i_count
        return np.minimum((theta_h / HALF_PI * bins).astype(np.int32), bins - 1)

    def axes(self, normal: Array, view: Array, tangent: Array | None) -> tuple[Array, Array, Array]:
        """Normal, tangent and normal x tangent, each of shape (p, 3)."""
        if tangent is None:
            raise ValueError("directions on this grid have azimuths, which a tangent is needed for")
        return normal, tangent, np.cross(normal, tangent)

    def cells(
        self, light: Array, view: Array, point: NDArray[np.intp]
    ) -> tuple[NDArray[np.int32], Array]:
        """Cells (n, 16) of pairs of directions and the shares (n, 16) that they have in the value.

        Beyond the last elevation a share is negative.

        Parameters
        ----------
        light : ndarray, shape (n, 3)
            Components of light directions along `axes`, above the horizon.
        view : ndarray, shape (p, 3)
            Components of the view directions.
        point : ndarray of int, shape (n,)
            The point that each light direction belongs to.
        """
        at_light = _near(light, self.theta_i_count, self.phi_i_count, 0)
        at_view = _near(view, self.theta_o_count, self.phi_o_count, 0)
        return _joined(at_light, at_view, point, self.theta_o_count * self.phi_o_count)

    @property
    def column_count(self) -> int:
        """Columns of a transport matrix: more than cells, since they go on to the horizon."""
        at_light = (self.theta_i_count + BEYOND) * self.phi_i_count
        return at_light * (self.theta_o_count + BEYOND) * self.phi_o_count

    def columns(
        self, light: Array, view: Array, point: NDArray[np.intp]
    ) -> tuple[NDArray[np.int32], Array]:
        """Columns (n, 16) of a transport matrix that pairs of directions fall into, and shares.

        Extrapolation that ends at 0 is not linear in a table, as a matrix is. So the matrix is for
        a table that goes on to the horizon, by `BEYOND` elevations of what is extrapolated. Between
        these it is not quite what `cells` give, and only where the values come down to 0 there.

        Parameters
        ----------
        light, view, point : ndarray
            As in `cells`.
        """
        at_light = _near(light, self.theta_i_count, self.phi_i_count, BEYOND)
        at_view = _near(view, self.theta_o_count, self.phi_o_count, BEYOND)
        views = (self.theta_o_count + BEYOND) * self.phi_o_count
        return _joined(at_light, at_view, point, views)

    def column_values(self, values: Array) -> Array:
        """BRDFs (3, column_count) of a table (3,) + shape, extrapolated and not below 0."""
        on_i, on_o = _continuation(self.theta_i_count), _continuation(self.theta_o_count)
        measured = np.maximum(values, 0)
        onwards = np.einsum("ai,cipjq,bj->capbq", on_i, measured, on_o, optimize=True)
        return np.maximum(onwards, 0).reshape(len(values), -1)


#: The grid of the UTIA database.
UTIA = Directional()


def directions(theta: Array, phi: Array) -> Array:
    """Unit vectors S + (3,) over a surface with normal z and tangent x, of angles of shape S."""
    theta, phi = np.broadcast_arrays(theta, phi)
    sine = np.sin(theta)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)


Neighbours = tuple[NDArray[np.intp], Array]


def _near(components: Array, elevations: int, azimuths: int, beyond: int) -> Neighbours:
    """Four neighbours (n, 4) of directions, among so many elevations and `beyond` more, and shares.

    `components` (n, 3) are those along normal, tangent and normal x tangent.
    """
    cosine, along, across = components.T
    theta = np.arctan2(np.hypot(along, across), cosine)
    place = _onwards(theta / HALF_PI * elevations, elevations, beyond)
    low, share = _between(place, elevations + beyond)
    at, between = _around(np.arctan2(across, along), azimuths)
    index = low[:, :, None] * azimuths + at[:, None]
    return index.reshape(-1, 4), (share[:, :, None] * between[:, None]).reshape(-1, 4)


def _onwards(place: Array, count: int, beyond: int) -> Array:
    """Places among `count` elevations, stretched where `beyond` more divide the last step."""
    last = count - 1
    return np.where(place > last, last + (place - last) * max(beyond, 1), place)


def _between(place: Array, count: int) -> Neighbours:
    """Two neighbours (n, 2) among `count` elevations, and their shares; the last two beyond."""
    low = np.minimum(place.astype(np.intp), max(count - 2, 0))
    share = place - low
    # A single elevation is its own neighbour: what is there is everywhere.
    return np.stack([low, np.minimum(low + 1, count - 1)], -1), np.stack([1 - share, share], -1)


def _around(phi: Array, count: int) -> Neighbours:
    """Two neighbours (n, 2) among `count` azimuths, and their shares."""
    place = phi / (2 * np.pi) * count
    low = np.floor(place)
    share = place - low
    index = np.stack([low, low + 1], axis=-1).astype(np.intp) % count
    return index, np.stack([1 - share, share], axis=-1)


def _joined(
    light: Neighbours, view: Neighbours, point: NDArray[np.intp], views: int
) -> tuple[NDArray[np.int32], Array]:
    """Sixteen neighbours of pairs of directions, (n, 16), and their shares."""
    index = (light[0] * views)[:, :, None] + view[0][point][:, None]
    share = light[1][:, :, None] * view[1][point][:, None]
    return index.reshape(-1, 16).astype(np.int32), share.reshape(-1, 16)


def _continuation(count: int) -> Array:
    """Matrix (count + BEYOND, count) that continues values at elevations to the horizon."""
    beyond = count - 1 + np.arange(1, BEYOND + 1) / BEYOND
    index, share = _between(np.concatenate([np.arange(count), beyond]), count)
    matrix = np.zeros((count + BEYOND, count))
    np.add.at(matrix, (np.arange(count + BEYOND)[:, None], index), share)
    return matrix
