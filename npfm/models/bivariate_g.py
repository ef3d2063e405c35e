"""The microfacet model with D F replaced by a free B(theta_h, theta_d).

rho = rho_d + rho_s B(theta_h, theta_d) K with K = G(theta_i) G(theta_o) / (cos cos): the model that
Bagher et al. 2016 name in their conclusion and leave open how to fit. It is fitted by variable
projection (Golub and Pereyra 1973): for a given G, the best B and rho_d follow in closed form, so
that log G alone is sought.

G is determined up to a factor exp(a cos theta): cos theta_i + cos theta_o is
2 cos theta_h cos theta_d, so that B absorbs it.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from npfm.fits import Fit
from npfm.grid import Grid
from npfm.merl import Table
from npfm.models import g_from_d, kernels
from npfm.models.channels import ChannelFit, as_table, fit_channels
from npfm.models.factors import SMALLEST, Sums, filled
from npfm.models.microfacet import G_NODES, G_THETA, MicrofacetProblem, tabulate_product
from npfm.models.slices import factors_of_slices
from npfm.models.smith import masking_shadowing
from npfm.objective import Objective, Samples
from npfm.solvers.problem import Solve

NAME = "bivariate-g"
CLAMP = 1e-6  # smallest component of G, as in independent-g
#: Width of the Gaussian that smooths G in the first stage of AWLS, in nodes.
SMOOTHING = 1.0

Array = NDArray[np.float64]


def _levelling() -> Array:
    """Matrix that takes the part linear in cos(theta) out of a function at the nodes of G."""
    deviation = np.cos(G_THETA) - np.cos(G_THETA).mean()
    return np.eye(G_NODES) - np.outer(np.cos(G_THETA), deviation / (deviation @ deviation))


LEVELLING = _levelling()


@dataclass(frozen=True)
class State:
    """B in the units of the samples (that is, rho_s B), G, rho_d, and the sums that belong to G."""

    B: Array
    G: Array
    rho_d: float
    sums: Sums


def best_rho_d(sums: Sums) -> float:
    """Return the rho_d >= 0 that is best together with the best B >= 0.

    B is max(0, (wrK - rho_d wK) / wK^2) in each cell, so that the derivative of the objective is a
    continuous, rising function of rho_d, linear between the values wrK / wK at which a cell's B
    becomes 0. Where K varies in no cell, B does all that rho_d can, and rho_d is 0.
    """
    reached = sums.wkk > 0
    w, wr = sums.w[reached], sums.wr[reached]
    wk, wkk, wrk = sums.wk[reached], sums.wkk[reached], sums.wrk[reached]
    share = wk / wkk
    slope, constant = float(np.sum(w - share * wk)), float(np.sum(wr - share * wrk))
    if slope <= 1e-12 * w.sum():
        return 0.0
    zeros = wrk / wk
    order = np.argsort(zeros)
    # Entry k is for the k cells of lowest zeros having B = 0.
    slopes = slope + np.append(0.0, np.cumsum((share * wk)[order]))
    constants = constant + np.append(0.0, np.cumsum((share * wrk)[order]))
    passed = np.count_nonzero(zeros[order] * slopes[:-1] < constants[:-1])
    return max(float(constants[passed] / slopes[passed]), 0.0)


class BivariateGProblem(MicrofacetProblem):
    """The fit of one channel."""

    def __init__(self, samples: Samples, clamp: float = CLAMP, every: int = 1):
        super().__init__(samples, clamp, every)

    @cached_property
    def _nearest(self) -> tuple[NDArray[np.intp], ...]:
        """For each cell, the nearest one with a sample."""
        unseen = self._fixed[0] == 0
        return tuple(distance_transform_edt(unseen, return_distances=False, return_indices=True))

    def start(self, G: Array) -> State:
        """Return the state of a masking-shadowing factor: G settled, B and rho_d the best for it.

        Cells without a sample take the B of the nearest one that has.
        """
        G = self.settled(G)
        sums = self.sums(G)
        rho_d = best_rho_d(sums)
        B = np.maximum(sums.wrk - rho_d * sums.wk, 0) / np.where(sums.wkk > 0, sums.wkk, 1.0)
        return State(B[self._nearest], G, rho_d, sums)

    def settled(self, G: Array) -> Array:
        """Return an equivalent G that is level where `LEVEL` says, scaled to maximum 1 and clamped.

        Nodes that no sample depends on are interpolated from their neighbours.
        """
        G = filled(np.asarray(G, dtype=float), self.seen[2], self.clamp)
        G = np.exp(LEVELLING @ np.log(G))
        return np.maximum(G / G.max(), self.clamp)

    @property
    def stages(self) -> tuple[tuple[Callable[[State], State]], ...]:
        """G smoothed as in the paper, then a second stage without: smoothing has its own error."""
        return (
            (lambda state: self._updated(state, SMOOTHING),),
            (lambda state: self._updated(state, 0.0),),
        )

    def _updated(self, state: State, smoothing: float) -> State:
        return self.start(self.updated_G(state.B, state.rho_d, state.G, smoothing))

    def objective(self, state: State) -> float:
        """Objective of equation 7, the floor included."""
        return self.samples.floor + state.sums.objective(state.B, state.rho_d, 1.0)

    def between(self, before: State, after: State, t: float) -> State:
        """Return the state of an interpolated G."""
        return self.start((1 - t) * before.G + t * after.G)

    def normalised(self, state: State) -> State:
        """Return the state as it is: its G has maximum 1."""
        return state

    def pack(self, state: State) -> Array:
        """Logarithms of G."""
        return np.log(state.G)

    def unpack(self, packed: Array) -> State:
        """Return the state of a packed G, with the B and rho_d that are best for it."""
        return self.start(np.exp(packed))

    def tops(self, packed: Array) -> NDArray[np.intp]:
        """Return, for each node of G, where the largest one is."""
        return np.full(packed.size, np.argmax(packed))

    def normal_equations(self, state: State) -> tuple[Array, Array]:
        """Gradient and Gauss-Newton matrix in log G, then rho_d, with B eliminated."""
        gradient, upper = kernels.normal_equations(
            *self._arrays, state.B, state.G, state.rho_d, True
        )
        matrix = upper + np.triu(upper, 1).T
        chain = np.zeros_like(matrix)
        chain[:-1, :-1] = LEVELLING
        chain[-1, -1] = state.rho_d > 0  # at its bound it stays there
        return chain.T @ gradient, chain.T @ matrix @ chain
