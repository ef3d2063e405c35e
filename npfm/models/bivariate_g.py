"""The microfacet model with a free B(theta_h, theta_d) in place of rho_s D F.

rho = rho_d + B(theta_h, theta_d) K with K = G(theta_i) G(theta_o) / (cos theta_i cos theta_o): the
model that Bagher et al. 2016 name in their conclusion, and leave open how to fit. Both theirs
are special cases: independent-g where B is a product, and bivariate where G = cos(theta).

It is fitted by variable projection (Golub and Pereyra 1973): for a given G, the best B and rho_d
follow in closed form from sums over phi_d, and only G is sought.

G is determined up to a factor exp(a cos theta): since cos theta_i + cos theta_o =
2 cos theta_h cos theta_d, B can take it over. Of all equivalent G, the one whose logarithm has
no trend in cos(theta) is kept.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.factors.microfacet import (
    G_NODES,
    G_THETA,
    MaskedProblem,
    compiled,
    tabulate_product,
)
from npfm.fitting.factors.problem import Sums, filled
from npfm.fitting.factors.slices import factors_of_slices
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples, fold
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "bivariate-g"
COEFFICIENTS = ("B", "rho_d")
CLAMP = 1e-6  # smallest component of G, as in independent-g; B may be 0
FREEDOMS = 2  # scalings of G that leave the model as it is
#: Width of the Gaussian that smooths G in the first stage of AWLS, in nodes.
SMOOTHING = 1.0
#: Powers of cos(theta) that are starts for G: from G = 1 to the bivariate model, K = 1.
POWERS = (0.0, 0.25, 0.5, 0.75, 1.0)

Array = NDArray[np.float64]


def _levelling() -> Array:
    """Matrix that takes the trend in cos(theta) out of a function at the nodes of G."""
    cosine = np.cos(G_THETA)
    deviation = cosine - cosine.mean()
    return np.eye(G_NODES) - np.outer(cosine, deviation / (deviation @ deviation))


LEVELLING = _levelling()


@dataclass(frozen=True)
class State:
    """What follows from G: the sums that belong to it, and the best B and rho_d."""

    G: Array
    sums: Sums
    B: Array
    rho_d: float


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
    slope, constant = np.sum(w - share * wk), np.sum(wr - share * wrk)
    if slope <= 1e-12 * w.sum():
        return 0.0
    zeros = wrk / wk
    order = np.argsort(zeros)
    # Entry k belongs to B = 0 in the k cells where that happens first.
    slopes = slope + np.append(0.0, np.cumsum((share * wk)[order]))
    constants = constant + np.append(0.0, np.cumsum((share * wrk)[order]))
    passed = np.count_nonzero(zeros[order] * slopes[:-1] < constants[:-1])
    return max(float(constants[passed] / slopes[passed]), 0.0)


def best_B(sums: Sums, rho_d: float) -> Array:
    """Best B >= 0 for a given rho_d, 0 where there is no sample."""
    right = np.maximum(sums.wrk - rho_d * sums.wk, 0.0)
    return np.where(sums.wkk > 0, right / np.where(sums.wkk > 0, sums.wkk, 1.0), 0.0)


class BivariateGProblem(MaskedProblem[State]):
    """The fit of one channel: a state is a function of its G."""

    def __init__(self, samples: Samples, clamp: float = CLAMP, every: int = 1):
        super().__init__(samples, clamp, every)

    @cached_property
    def nearest(self) -> tuple[NDArray[np.intp], ...]:
        """Index of the nearest cell with a sample, for every cell."""
        from scipy.ndimage import distance_transform_edt

        unseen = self._fixed[0] == 0
        return tuple(distance_transform_edt(unseen, return_distances=False, return_indices=True))

    def start(self, G: Array) -> State:
        """Return the state of a masking-shadowing factor, levelled, scaled and clamped.

        Cells without a sample take the B of the nearest one that has.
        """
        G = np.exp(LEVELLING @ np.log(filled(np.asarray(G, dtype=float), self.seen[2], self.clamp)))
        G = np.maximum(G / G.max(), self.clamp)
        sums = self.sums(G)
        rho_d = best_rho_d(sums)
        return State(G, sums, best_B(sums, rho_d)[self.nearest], rho_d)

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
        above = state.sums.objective(state.B, state.rho_d, 1.0)
        return self.samples.floor + max(above, 0.0)  # a sum of squares but for rounding

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
        """Return the state of a packed G."""
        return self.start(np.exp(packed))

    def tops(self, packed: Array) -> NDArray[np.intp]:
        """Return, for each node of G, where the largest one is."""
        return np.full(packed.size, np.argmax(packed))

    def normal_equations(self, state: State) -> tuple[Array, Array]:
        """Gradient and Gauss-Newton matrix in log G, then rho_d, with B eliminated."""
        gradient, upper = compiled().normal_equations(
            *self._arrays, state.B, state.G, state.rho_d, True
        )
        chain = np.zeros_like(upper)
        chain[:-1, :-1] = LEVELLING
        chain[-1, -1] = state.rho_d > 0  # at its bound it is no unknown
        return chain.T @ gradient, chain.T @ (upper + np.triu(upper, 1).T) @ chain


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material: B, G and rho_d for each channel."""
    return 3 * (grid.theta_h_bins * grid.theta_d_bins + G_NODES + 1)


def fit_samples(samples: Samples, solve: Solver) -> tuple[BivariateGProblem, State, list[Trace]]:
    """Fit one channel of folded samples; none of the starts is random."""
    problem = BivariateGProblem(samples)
    D, _ = factors_of_slices(samples)
    starts = {f"cosine-{power:g}": np.cos(G_THETA) ** power for power in POWERS}
    starts["slices-smith"] = masking_shadowing(D, samples.grid, G_THETA)
    state, traces = solve(problem, {name: problem.start(G) for name, G in starts.items()})
    return problem, state, traces


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model from several starts for G and keep the best.

    `npfm.models` says what every `fit` takes and raises.
    """
    compiled()

    def fit_channel(samples: Samples, channel: int) -> ChannelFit:
        _, state, traces = fit_samples(samples, solve)
        return ChannelFit(
            {"B": state.B, "G": state.G, "rho_d": state.rho_d},
            tuple(traces),
        )

    parameters, records = fit_channels(table, objective, fit_channel, COEFFICIENTS)
    return Fit(NAME, parameters, table.grid, records)


def linearised(samples: Samples, p: dict[str, NDArray]) -> tuple[BivariateGProblem, State]:
    """Return the problem of a channel, its samples not folded yet, and the state of a fit."""
    problem = BivariateGProblem(fold(samples))
    return problem, problem.start(p["G"])


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    channels = [
        tabulate_product(fit.grid, B, G, rho_d, 1.0)
        for B, G, rho_d in zip(p["B"], p["G"], p["rho_d"], strict=True)
    ]
    return as_table(channels, fit.grid)
