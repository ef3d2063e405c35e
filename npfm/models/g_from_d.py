"""The microfacet model with G derived from D by Smith shadowing (Bagher et al. 2016, sec. 4.3)."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.factors.microfacet import (
    G_NODES,
    G_THETA,
    MicrofacetProblem,
    compiled,
    tabulate_channel,
)
from npfm.fitting.factors.problem import SMALLEST, Factors, State, filled, updated_D, updated_F
from npfm.fitting.factors.slices import factors_of_slices
from npfm.fitting.factors.smith import log_derivative, masking_shadowing
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples, fold
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "g-from-d"
COEFFICIENTS = ("rho_d", "rho_s")
CLAMP = 0.0  # "we simply clamp negative factor components to 0" (section 4.3)
FREEDOMS = 1  # scalings of the factors that leave the model as it is
STARTS = 2  # the paper has one
#: Updates of F and the coefficients for one of D, which alone needs a pass over the samples.
INNER_SWEEPS = 5


class GFromDProblem(MicrofacetProblem):
    """The fit of one channel: every change of D changes G with it."""

    def __init__(self, samples: Samples, clamp: float = CLAMP, every: int = 1):
        super().__init__(samples, clamp, every)

    def smith(self, D: NDArray) -> NDArray:
        """G of a normal distribution at the nodes of G, scaled to maximum 1."""
        G = masking_shadowing(D, self.samples.grid, G_THETA)
        return G / G.max()

    def start(self, D: NDArray, F: NDArray) -> State:
        """Return the state of a normal distribution and a Fresnel factor."""
        D, F = (filled(x, seen, self.clamp) for x, seen in zip((D, F), self.seen, strict=False))
        state = State(Factors(D, F, self.smith(D), 0.0, 0.0), self.sums(self.smith(D)))
        return state.with_coefficients()

    def pack(self, state: State) -> NDArray:
        """Logarithms of D and F."""
        return super().pack(state)[: -G_THETA.size]

    def unpack(self, packed: NDArray) -> State:
        """Return the state of packed D and F, with the G that follows from D."""
        return self.start(*np.split(np.exp(packed), [self.samples.grid.theta_h_bins]))

    def normal_equations(self, state: State) -> tuple[NDArray, NDArray]:
        """Gradient and Gauss-Newton matrix in the logarithms of D and F, then rho_d.

        Those of a free G, carried over by the exact derivative of log G with respect to log D,
        components of D that are filled in from seen ones included.
        """
        gradient, matrix = super().normal_equations(state)
        nh, n = self.samples.grid.theta_h_bins, gradient.size
        g = slice(n - 1 - G_THETA.size, n - 1)
        chain = np.eye(n)
        D, bins, seen = state.factors.D, np.arange(nh), self.seen[0]
        filling = np.array([np.interp(bins, bins[seen], row[seen]) for row in np.eye(nh)]).T
        filling *= D / np.maximum(D, SMALLEST)[:, None]
        chain[g, :nh] = log_derivative(D, self.samples.grid, G_THETA) @ filling
        chain = np.delete(chain, np.r_[g], axis=1)
        return chain.T @ gradient, chain.T @ matrix @ chain

    @property
    def stages(self) -> tuple[tuple[Callable[[State], State], ...]]:
        """One stage: D with its G, then F and the coefficients a few times."""
        inner = (lambda state: updated_F(state, CLAMP), State.with_coefficients)
        return ((self._updated_D_and_G, *inner * INNER_SWEEPS),)

    def _updated_D_and_G(self, state: State) -> State:
        return self._with_G(updated_D(state, CLAMP))

    def _with_G(self, state: State) -> State:
        G = self.smith(state.factors.D)
        return State(replace(state.factors, modulation=G), self.sums(G))

    def between(self, before: State, after: State, t: float) -> State:
        """Interpolate D, F and the coefficients, and derive G from the D between."""
        if before.factors.modulation is after.factors.modulation:
            return super().between(before, after, t)
        D = (1 - t) * before.factors.D + t * after.factors.D
        return self._with_G(before.with_factors(D=D))


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material: D, F, rho_d and rho_s for each channel."""
    return 3 * (grid.theta_h_bins + grid.theta_d_bins + 2)


def _starts(problem: GFromDProblem) -> Iterator[tuple[str, State]]:
    """Two starts by name: the slices of section 5 of the paper, and D and F fitted to G = 1.

    The tail of a mirror's slices is noise, and the G that follows from it falls far too early, from
    where no step leads back; with G = 1 the tail is found first.
    """
    D, F = factors_of_slices(problem.samples)
    yield "slices", problem.start(D, F)
    flat = np.ones(G_NODES)
    state = State(Factors(D, F, flat, 0.0, 0.0), problem.sums(flat)).with_coefficients()
    fitted = problem.warmed_up(state).factors
    yield "slices-flat", problem.start(fitted.D, fitted.F)


def fit_samples(samples: Samples, solve: Solver, starts: int = STARTS) -> tuple[State, list[Trace]]:
    """Fit one channel of folded samples from the first of its starts."""
    problem = GFromDProblem(samples)
    return solve(problem, dict(islice(_starts(problem), starts)))


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the model from two starts and keep the better.

    `npfm.models` says what every `fit` takes and raises.
    """
    compiled()

    def fit_channel(samples: Samples, channel: int) -> ChannelFit:
        state, traces = fit_samples(samples, solve)
        f = state.factors
        return ChannelFit(
            {"D": f.D, "F": f.F, "rho_d": f.rho_d, "rho_s": f.rho_s},
            tuple(traces),
        )

    parameters, records = fit_channels(table, objective, fit_channel, COEFFICIENTS)
    return Fit(NAME, parameters, table.grid, records)


def linearised(samples: Samples, p: dict[str, NDArray]) -> tuple[GFromDProblem, State]:
    """Return the problem of a channel, its samples not folded yet, and the state of a fit."""
    problem = GFromDProblem(fold(samples))
    return problem, problem.start(p["D"], p["F"])


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr; G is derived from the stored D."""
    channels = []
    for D, F, rho_d, rho_s in zip(
        *(fit.parameters[name].astype(float) for name in ("D", "F", "rho_d", "rho_s")), strict=True
    ):
        G = masking_shadowing(D, fit.grid, G_THETA)
        channels.append(tabulate_channel(fit.grid, D, F, G / np.max(G), rho_d, rho_s))
    return as_table(channels, fit.grid)
