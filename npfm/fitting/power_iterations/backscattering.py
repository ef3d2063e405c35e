"""What a table of both directions tells of its microfacets: the eigenproblem of `circulant` for it.

D is tabulated as in `npfm.reflectance.tabulated_slopes`, up to the last elevation of the table:
what readers extrapolate beyond it is noise, and not asked for. Each value is read off the two
directions of one azimuth that have their half vector there and are nearest to each other: the same
one, or neighbours half a step of elevation from it. Up to that angle theta_d, 7.5 degrees for the
UTIA database, the Fresnel factor is taken for F0.

Where D is interpolated it is no linear function of its table any more, but one that keeps order and
scale, as a matrix without negative entries does.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.objective import Samples
from npfm.fitting.power_iterations import eigenproblem
from npfm.fitting.power_iterations.circulant import CLAMPED, resolved_status
from npfm.fitting.power_iterations.eigenproblem import iterated
from npfm.reflectance.anisotropic_slopes import Normals, facing, projected
from npfm.reflectance.directional import Directional
from npfm.reflectance.tabulated_slopes import at_normals

Array = NDArray[np.float64]

#: Elevations at which integrals over D are summed up, as MERL's tables have (section 5.3 of Dupuy
#: et al. 2015 has as many).
THETA_H_BINS = 90


def normals(grid: Directional) -> Normals:
    """Where integrals over D are summed up."""
    return Normals(THETA_H_BINS, grid.phi_i_count)


def shape(grid: Directional) -> tuple[int, int]:
    """Elevations and azimuths of D.

    Raises
    ------
    NpfmError
        If light and view do not have the same directions.
    """
    if grid.shape[:2] != grid.shape[2:]:
        raise NpfmError(
            f"a {grid.name} table has light and view in different directions; "
            "microfacets are read off tables that have both in the same"
        )
    return 2 * grid.theta_i_count - 1, grid.phi_i_count


def areas(D: Array, grid: Directional, clamped: bool = False) -> Array:
    """Integrals of |o.h| D(h) for the directions o of a table, shape (theta_o, phi_o).

    Parameters
    ----------
    D : ndarray, shape normals.shape
        At `normals`.
    grid : Directional
        Of the table.
    clamped : bool
        Whether they are of max(0, o.h) D(h).
    """
    return projected(facing(normals(grid), tuple(grid.theta_o.tolist()), clamped), D)


@dataclass(frozen=True)
class Rows:
    """Equations of the eigenproblem in one channel.

    F0 D is 4 f A for light and view at elevations `first` and `second` of one azimuth, and A half
    of cos(theta_i) S(o) + cos(theta_o) S(i), with S as `areas`.

    Parameters
    ----------
    value : ndarray, shape of D
        f, 0 where nothing was measured.
    first, second : ndarray of int, shape of D
        Elevations of the two directions: the nearest to each other that were measured.
    seen : ndarray of bool, shape of D
        Where something was.
    """

    value: Array
    first: NDArray[np.intp]
    second: NDArray[np.intp]
    seen: NDArray[np.bool_]

    def image(self, S: Array, cosine: Array) -> Array:
        """F0 D, filled in where nothing was measured, by areas S and the table's cosines."""
        azimuth = np.arange(S.shape[1])
        across = cosine[self.first] * S[self.second, azimuth]
        image = 2 * self.value * (across + cosine[self.second] * S[self.first, azimuth])
        # The normal has no azimuth.
        known = self.seen[0]
        image[0] = image[0][known].mean() if known.any() else 0.0
        return filled(image, self.seen)


def rows(samples: Samples, grid: Directional) -> Rows:
    """Read what a folded channel of a table says of D."""
    count, azimuths = shape(grid)
    value, azimuth = np.zeros((count, azimuths)), np.arange(azimuths)
    first, second = np.zeros((2, count, azimuths), dtype=np.intp)
    seen = np.zeros((count, azimuths), dtype=bool)
    for between in range(grid.theta_i_count):
        for low in range(grid.theta_i_count - between):
            at = low, azimuth, low + between, azimuth
            row = 2 * low + between
            new = (samples.weight[at] > 0) & ~seen[row]
            value[row, new] = samples.value[at][new]
            first[row, new], second[row, new] = low, low + between
            seen[row] |= new
    return Rows(value, first, second, seen)


def filled(image: Array, seen: NDArray[np.bool_]) -> Array:
    """Entries that were not seen, from others: between neighbours of a row, and between rows."""
    azimuths = np.arange(image.shape[1])
    for row in np.flatnonzero(seen.any(axis=1) & ~seen.all(axis=1)):
        known = seen[row] if row else np.ones_like(seen[row])
        image[row] = np.interp(azimuths, azimuths[known], image[row][known], period=len(azimuths))
    return eigenproblem.filled(image, np.asarray(seen.any(axis=1)))


def distribution(samples: Sequence[Samples], kernel: str) -> tuple[Array, str, int]:
    """D of a table, that of all its channels together; as `eigenproblem.distribution`.

    Returns
    -------
    D : ndarray, shape `shape`
        Largest value 1, not negative.
    status : str
    iterations : int
    """
    grid = samples[0].grid
    assert isinstance(grid, Directional)
    unit = max(channel.scale for channel in samples)
    scales = [channel.scale / unit for channel in samples]
    channels = [rows(channel, grid) for channel in samples]
    if not all(channel.seen.any() for channel in channels):
        return np.ones(shape(grid)), "degenerate: no light comes back that was measured", 0
    # In an order of their own, so that that of the channels does not even matter for rounding.
    order = sorted(range(len(channels)), key=lambda k: scales[k] * channels[k].value.sum())
    cosine, clamped = np.cos(grid.theta_i), CLAMPED[kernel]

    def image(D: Array) -> Array:
        S = areas(at_normals(D, normals(grid)), grid, clamped)
        return reduce(np.add, [scales[k] * channels[k].image(S, cosine) for k in order])

    D, status, iterations = iterated(image, shape(grid))
    at = normals(grid)
    return D, resolved_status(at_normals(D, at), at, status), iterations
