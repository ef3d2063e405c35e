"""The fit of shared lobes of anisotropic materials (Peng et al. 2017, sections 2.2 and 2.4).

D hangs on theta_h and phi_h, G on the elevation and azimuth of a direction; all else is as for
isotropic ones. Here a row is one pair of directions.
"""

from collections.abc import Sequence
from functools import cached_property
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.problem import LEAST_SHARE
from npfm.fitting.objective import Samples
from npfm.fitting.shared_lobes import sphere
from npfm.fitting.shared_lobes.problem import CLAMP, LobesProblem, State

Array = NDArray[np.float64]

#: Nodes that fewer samples read than this share of those that read the best-read one are filled in.
OBSERVED = 1e-3


def compiled() -> ModuleType:
    """Return the passes over pairs; a fit calls this first, before time is taken."""
    from npfm.fitting.shared_lobes import pair_kernels

    return pair_kernels


class DirectionalLobesProblem(LobesProblem):
    """The fit of lobes of half vectors, to samples on a directional grid.

    Parameters
    ----------
    samples, lobes, floor
        As of `LobesProblem`.
    """

    def __init__(self, samples: Sequence[Samples], lobes: int, floor: float = LEAST_SHARE):
        self.grid = samples[0].grid
        used = np.any([s.weight.ravel() > 0 for s in samples], axis=0)
        cells = np.flatnonzero(used)
        self.reading = sphere.reading(self.grid, cells)
        super().__init__(samples, lobes, floor, self.reading.G, lambda a: a.reshape(-1, 1)[cells])

    def thinned(self, every: int) -> "DirectionalLobesProblem":
        """Return itself: there are few samples for what is fitted to them."""
        return self

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Number of components of a D, an F and a G."""
        return sphere.node_count(self.grid), sphere.F_NODES, sphere.node_count(self.grid)

    @property
    def theta_h(self) -> Array:
        """Angle of each component of D, in radians."""
        return sphere.theta_of_nodes(self.grid)

    def over_theta_h(self, D: Array) -> tuple[Array, Array]:
        """Mean of a D over the azimuths, and the elevations."""
        return sphere.spread(D, self.grid).mean(-1), self.grid.theta_i

    @cached_property
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, of the F of each channel, and of G enough samples depend on."""
        counts, at = self.weight[..., 0] > 0, self.reading
        nodes, f_nodes, _ = self.sizes
        per_row = counts.sum(0)[:, None]
        in_d = np.bincount(at.D_nodes.ravel(), (at.D_taps * per_row).ravel(), nodes)
        in_f = [
            np.bincount(at.F_nodes.ravel(), (at.F_taps * c[:, None]).ravel(), f_nodes)
            for c in counts
        ]
        in_g = at.G.reads(np.any(counts, axis=0)[:, None])
        seen_by = in_d, np.stack(in_f), in_g
        return tuple(n > OBSERVED * n.max(-1, keepdims=True) for n in seen_by)

    def D_at(self, D: Array) -> Array:
        """Values of each lobe's D in each row, shape (rows, lobes)."""
        return self.reading.D_at(D)

    def F_at(self, F: Array) -> Array:
        """Values of each channel's F in each row, shape (channels, rows)."""
        return self.reading.F_at(F)

    def sums_over_F(self, values: Array) -> Array:
        """Sums of values of the rows, as much as each reads of a node of F."""
        at, sums = self.reading, np.zeros(self.sizes[1])
        np.add.at(sums, at.F_nodes, at.F_taps * values[:, None])
        return sums

    def filled(self, lobe: Array, seen: NDArray[np.bool_]) -> Array:
        """A D or a G scaled to maximum 1 and clamped, unseen components from their neighbours."""
        if not seen.any():
            return np.ones_like(lobe)
        if not seen.all():
            known = sphere.spread(np.where(seen, lobe, np.nan), self.grid)
            full = _filled(known)
            full[0] = full[0].mean()  # the normal is one direction
            lobe = np.where(seen, lobe, sphere.gathered(full))
        return np.maximum(lobe / lobe.max(), CLAMP)

    def profile(self) -> Array:
        """Light about each half vector: a D to begin with, one reflection by a mirror."""
        at = self.reading
        value = self.weighted_value[..., 0] / at.G.inverse_cosines[:, 0]
        total, count = (
            np.bincount(at.D_nodes.ravel(), (at.D_taps * v.sum(0)[:, None]).ravel(), self.sizes[0])
            for v in (value, self.weight[..., 0])
        )
        mean = np.divide(total, count, out=np.zeros_like(total), where=count > 0)
        return mean if mean.any() else np.ones_like(mean)

    def solved_D(self, numerator: Array, denominator: Array, before: Array) -> Array:
        """Best components of a lobe's D, one after the other (section 2.4)."""
        at = self.reading
        sums = denominator.sum(0), numerator.sum(0)
        return compiled().relaxed(at.D_nodes, at.D_taps, *sums, before, CLAMP)

    def solved_F(self, numerator: Array, denominator: Array, before: Array) -> Array:
        """Best components of a channel's F, one after the other."""
        at = self.reading
        return compiled().relaxed(at.F_nodes, at.F_taps, denominator, numerator, before, CLAMP)

    def smoothed(self, G: Array, width: float) -> Array:
        """Smooth a G by a Gaussian over elevations and around, whose width is in nodes."""
        from scipy.ndimage import gaussian_filter

        blurred = gaussian_filter(sphere.spread(G, self.grid), width, mode=("nearest", "wrap"))
        blurred[0] = blurred[0].mean()
        return sphere.gathered(blurred)

    def derivatives(self, state: State) -> tuple[Array, Array, Array]:
        """Gradient, Gauss-Newton matrix, and derivatives of the means, as of `LobesProblem`."""
        at = self.reading
        gradient, matrix = compiled().equations_of_pairs(
            self.weight[..., 0],
            self.weighted_value[..., 0],
            at.D_nodes,
            at.D_taps,
            at.F_nodes,
            at.F_taps,
            at.G.first_i[:, 0],
            at.G.first_o[:, 0],
            at.G.inverse_cosines[:, 0],
            *(state.D, state.F, state.G, state.rho_s, state.rho_d),
        )
        # Beside the constant, a row has sums of w times derivatives of the model.
        return gradient, matrix, matrix[-len(self.samples) :]


def _filled(known: Array) -> Array:
    """Fill in what is NaN around each elevation, then between elevations."""
    phi = np.arange(known.shape[1])
    full = known.copy()
    for ring in full:
        there = np.isfinite(ring)
        if there.any():
            ring[:] = np.interp(phi, phi[there], ring[there], period=len(phi))
    rows = np.flatnonzero(np.isfinite(full[:, 0]))
    place = np.arange(len(full))
    return np.stack([np.interp(place, rows, column[rows]) for column in full.T], axis=1)
