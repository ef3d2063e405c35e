"""Where samples read G: between which nodes, and with which weights."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.microfacet import G_NODES, elevations
from npfm.reflectance.half_difference import HalfDifference

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Places:
    """theta_i and theta_o of folded cells as weighted sums over nodes of G that follow each other.

    Parameters
    ----------
    first_i, first_o : ndarray of int16, shape (theta_h * theta_d, phi_d)
        First node that is read.
    taps_i, taps_o : ndarray, shape (theta_h * theta_d, phi_d, taps)
        Weights of the nodes from there on; two of them, or four of a spline.
    inverse_cosines : ndarray, shape (theta_h * theta_d, phi_d)
        1 / (cos theta_i cos theta_o), 0 below the horizon.
    nodes : int
        How many G has.
    """

    first_i: NDArray[np.int16]
    taps_i: Array
    first_o: NDArray[np.int16]
    taps_o: Array
    inverse_cosines: Array
    nodes: int = G_NODES

    @property
    def arrays(self) -> tuple[NDArray, ...]:
        """All of it, in the order of the arguments of `npfm.fitting.shared_lobes.kernels`."""
        return self.first_i, self.taps_i, self.first_o, self.taps_o, self.inverse_cosines

    def kernel(self, G: Array) -> Array:
        """K = G(theta_i) G(theta_o) / (cos theta_i cos theta_o) for a G of shape (nodes,)."""
        at_i, at_o = (
            sum(taps[..., t] * G[first + t] for t in range(taps.shape[-1]))
            for first, taps in ((self.first_i, self.taps_i), (self.first_o, self.taps_o))
        )
        return at_i * at_o * self.inverse_cosines

    def reads(self, counts: NDArray[np.bool_]) -> Array:
        """How many of the samples that count read each node, weighted; shape (nodes,)."""
        total = np.zeros(self.nodes)
        for first, taps in ((self.first_i, self.taps_i), (self.first_o, self.taps_o)):
            for t in range(taps.shape[-1]):
                total += np.bincount(
                    first[counts] + t, np.abs(taps[..., t][counts]), minlength=self.nodes
                )
        return total

    @cached_property
    def readers(self) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
        """Samples above the horizon that read each node, as the ends of node's lists and the lists.

        A sample that reads a node at both of its places is there once.
        """
        cells = np.flatnonzero(self.inverse_cosines)
        taps = self.taps_i.shape[-1]
        pairs = []
        for first, weights in ((self.first_i, self.taps_i), (self.first_o, self.taps_o)):
            for t in range(taps):
                read = weights.reshape(-1, taps)[cells, t] != 0
                node = first.ravel()[cells[read]].astype(np.int64) + t
                pairs.append(node * self.inverse_cosines.size + cells[read])
        node, cell = np.divmod(np.unique(np.concatenate(pairs)), self.inverse_cosines.size)
        ends = np.append(0, np.cumsum(np.bincount(node, minlength=self.nodes)))
        return ends, cell.astype(np.int32)


@lru_cache(maxsize=4)
def places(grid: HalfDifference, every: int = 1, spline: bool = False) -> Places:
    """Places of the folded half of a grid, of every n-th bin of phi_d from the middle on.

    Parameters
    ----------
    grid : Grid
    every : int
        See `elevations`, whose angles these are.
    spline : bool
        Whether a Catmull-Rom spline runs through the nodes, and not straight lines.
    """
    at = elevations(grid, every)
    weights = _spline if spline else _linear
    first_i, taps_i = weights(at.node_i, at.part_i)
    first_o, taps_o = weights(at.node_o, at.part_o)
    return Places(first_i, taps_i, first_o, taps_o, at.inverse_cosines)


def _linear(node: NDArray[np.int16], part: Array) -> tuple[NDArray[np.int16], Array]:
    return node, np.stack([1 - part, part], axis=-1)


def _spline(node: NDArray[np.int16], part: Array) -> tuple[NDArray[np.int16], Array]:
    """Catmull-Rom weights of four nodes (Pharr et al. 2016, section 8.6.1).

    Slopes at the nodes are half the difference of their neighbours, at the two ends the
    difference to the only neighbour.
    """
    t = part
    value_0, value_1 = 2 * t**3 - 3 * t**2 + 1, 3 * t**2 - 2 * t**3
    slope_0, slope_1 = t**3 - 2 * t**2 + t, t**3 - t**2
    at_start, at_end = node == 0, node == G_NODES - 2
    half_0, half_1 = np.where(at_start, 1.0, 0.5), np.where(at_end, 1.0, 0.5)
    before = np.where(at_start, 0.0, -half_0 * slope_0)
    low = value_0 - half_1 * slope_1 - np.where(at_start, slope_0, 0.0)
    high = value_1 + half_0 * slope_0 + np.where(at_end, slope_1, 0.0)
    after = np.where(at_end, 0.0, half_1 * slope_1)
    taps = np.stack([before, low, high, after], axis=-1)
    first = np.clip(node - 1, 0, G_NODES - 4).astype(np.int16)
    moved = np.zeros_like(taps)
    shift = (node - 1 - first)[..., None]  # -1 at the first interval, 1 at the last
    for s in (-1, 0, 1):
        moved += np.where(shift == s, np.roll(taps, s, axis=-1), 0.0)
    return first, moved
