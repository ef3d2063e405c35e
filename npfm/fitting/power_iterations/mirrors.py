"""Values of the microfacet BRDF with Smith's correlated shadowing.

F D G / (4 cos(theta_i) cos(theta_o)) with G = G1 G1 / (G1 + G1 - G1 G1) and G1 = cos / sigma
(equations 1 to 3 of Dupuy et al. 2015) is F D / (4 A) with

    A = sigma(theta_o) cos(theta_i) + sigma(theta_i) cos(theta_o) - cos(theta_i) cos(theta_o):

no more than sums and one division, and nothing that is singular at grazing angles.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.slopes import ELEVATIONS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cells:
    """Cells with phi_d in its first half: their cosines, and places between `ELEVATIONS`.

    Parameters
    ----------
    cosines : tuple of two ndarray, shape (theta_h, theta_d, phi_d / 2)
        Of theta_i and theta_o, 0 below the horizon.
    nodes, parts : tuples of two ndarray, the same shape
        The node at or below theta_i and theta_o, and how far they are on the way to the next.
    """

    cosines: tuple[Array, Array]
    nodes: tuple[NDArray[np.int16], NDArray[np.int16]]
    parts: tuple[Array, Array]

    def shadowed_area(self, sigma: Array) -> Array:
        """A of each cell, for projected areas at `ELEVATIONS`."""
        slopes = np.append(np.diff(sigma), 0.0)
        at_i, at_o = (
            sigma[node] + part * slopes[node]
            for node, part in zip(self.nodes, self.parts, strict=True)
        )
        cos_i, cos_o = self.cosines
        return at_o * cos_i + at_i * cos_o - cos_i * cos_o


@lru_cache(maxsize=2)
def cells(grid: HalfDifference) -> Cells:
    """Place the folded cells of a grid."""
    half = grid.phi_d_bins // 2
    cosines = tuple(np.clip(cosine[..., :half], 0.0, 1.0) for cosine in grid.cosines)
    places = [np.arccos(cosine) / ELEVATIONS[1] for cosine in cosines]
    nodes = tuple(np.minimum(place, len(ELEVATIONS) - 2).astype(np.int16) for place in places)
    parts = tuple(place - node for place, node in zip(places, nodes, strict=True))
    return Cells(cosines, nodes, parts)


def mirrors(D: NDArray, sigma: NDArray, grid: HalfDifference) -> Array:
    """Values of the BRDF for F = 1, that of ideal mirrors: equation 19 of Dupuy et al. 2015.

    Parameters
    ----------
    D : ndarray, shape (theta_h_bins,)
        Normalised, at the bin centres.
    sigma : ndarray
        Its projected areas at `ELEVATIONS`.
    grid : HalfDifference
        Where D is tabulated.

    Returns
    -------
    ndarray, shape (theta_h, theta_d, phi_d / 2)
        In 1/sr, for phi_d in its first half; 0 below the horizon.
    """
    half = grid.phi_d_bins // 2
    above = grid.above_horizon[..., :half]
    area = np.where(above, 4 * cells(grid).shadowed_area(sigma), 1.0)
    return np.where(above, D[:, None, None] / area, 0.0)
