"""The microfacet model with a free factor G (Bagher et al. 2016, sections 3, 4.3 and 5)."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.factors.microfacet import (
    G_NODES,
    G_THETA,
    MicrofacetProblem,
    compiled,
    tabulate_channel,
)
from npfm.fitting.factors.problem import State
from npfm.fitting.factors.slices import factors_of_slices
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, Samples, fold
from npfm.fitting.solvers.problem import Solver
from npfm.models import g_from_d
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "independent-g"
COEFFICIENTS = ("rho_d", "rho_s")
RANDOM = True
SETTINGS = {"starts": "use only the first N of the eight starts (default: 8)"}
CLAMP = 1e-6  # smallest component of a factor (section 4.3, "Dynamic range clamping")
FREEDOMS = 2  # scalings of the factors that leave the model as it is
STARTS, RANDOM_STARTS = 8, 4  # section 5
#: Width of the Gaussian that smooths G, in nodes (the paper gives none).
SMOOTHING = 1.0
#: Updates of D, F and the coefficients for one of G, which alone needs passes over the samples.
INNER_SWEEPS = 5


class IndependentGProblem(MicrofacetProblem):
    """The fit of one channel."""

    def __init__(self, samples: Samples, clamp: float = CLAMP, every: int = 1):
        super().__init__(samples, clamp, every)

    @property
    def stages(self) -> tuple[tuple[Callable[[State], State], ...], ...]:
        """G smoothed as in the paper, then a second stage without: smoothing has its own error."""
        inner = self.inner * INNER_SWEEPS
        return (
            (*inner, lambda state: self._updated_G(state, SMOOTHING)),
            (*inner, lambda state: self._updated_G(state, 0.0)),
        )

    def _updated_G(self, state: State, smoothing: float) -> State:
        f = state.factors
        G = self.updated_G(f.rho_s * state.product, f.rho_d, f.modulation, smoothing)
        return State(replace(f, modulation=G), self.sums(G))

    def along(self, before: State, after: State) -> Callable[[float], float]:
        """Objective between two states; between two G it is a polynomial of degree 4 in t."""
        if before.factors.modulation is after.factors.modulation:
            return super().along(before, after)
        t = np.linspace(0, 1, 5)
        values = [self.objective(self.between(before, after, x)) for x in t]
        return np.polynomial.Polynomial(np.linalg.solve(np.vander(t, increasing=True), values))


def start_states(
    problem: IndependentGProblem, derive: Callable[[], State], seed: int
) -> Iterator[tuple[str, State]]:
    """Eight named starts after section 5 of the paper, each made when its turn comes.

    Four random ones, all ones, the g-from-d result, and two slices with G = 1. The eighth stands in
    for the published shifted-gamma fits: the same slices, with the G that Smith's factor gives for
    the first; like those fits a physical guess, but one that any table allows.

    Parameters
    ----------
    problem : IndependentGProblem
        The fit of one channel.
    derive : callable
        Gives the g-from-d result of the same channel.
    seed : int
        Seed of the random starts.
    """
    nh, nd, _ = problem.samples.grid.shape
    rng = np.random.default_rng(seed)
    D, F = factors_of_slices(problem.samples)
    flat = np.ones(G_NODES)

    def begun(D: NDArray, F: NDArray, G: NDArray) -> State:
        return problem.warmed_up(problem.state(D, F, G))

    for k in range(RANDOM_STARTS):
        factors = (rng.uniform(CLAMP, 1.0, n) for n in (nh, nd, G_NODES))
        yield f"random-{k + 1}", begun(*factors)
    yield "ones", begun(np.ones(nh), np.ones(nd), flat)
    derived = derive().factors
    yield "g-from-d", begun(derived.D, derived.F, derived.modulation)
    yield "slices", begun(D, F, flat)
    yield "slices-smith", begun(D, F, masking_shadowing(D, problem.samples.grid, G_THETA))


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material: D, F, G, rho_d and rho_s for each channel."""
    return 3 * (grid.theta_h_bins + grid.theta_d_bins + G_NODES + 2)


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, starts: int = STARTS
) -> Fit:
    """Fit the model from several starts and keep the best.

    `npfm.models` says what every `fit` takes and raises.

    Parameters
    ----------
    starts : int
        How many: the first ones of `start_states`.
    """
    if not 1 <= starts <= STARTS:
        raise NpfmError(f"{starts} starts of {NAME}: give a number from 1 to {STARTS}")

    compiled()

    def fit_channel(samples: Samples, channel: int) -> ChannelFit:
        problem = IndependentGProblem(samples)
        # Every channel sees the same starts, so that permuting channels permutes fits.
        named = start_states(
            problem, lambda: g_from_d.fit_samples(samples, solve, starts=1)[0], seed
        )
        state, traces = solve(problem, dict(islice(named, starts)))
        f = state.factors
        return ChannelFit(
            {"D": f.D, "F": f.F, "G": f.modulation, "rho_d": f.rho_d, "rho_s": f.rho_s},
            tuple(traces),
        )

    parameters, records = fit_channels(table, objective, fit_channel, COEFFICIENTS)
    return Fit(NAME, parameters, table.grid, records)


def linearised(samples: Samples, p: dict[str, NDArray]) -> tuple[IndependentGProblem, State]:
    """Return the problem of a channel, its samples not folded yet, and the state of a fit."""
    problem = IndependentGProblem(fold(samples))
    return problem, problem.state(p["D"], p["F"], p["G"])


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    channels = [
        tabulate_channel(fit.grid, *(p[name][c] for name in ("D", "F", "G", "rho_d", "rho_s")))
        for c in range(3)
    ]
    return as_table(channels, fit.grid)
