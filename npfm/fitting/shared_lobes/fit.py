"""Fit shared lobes: starts compared with lobes that cannot die, then the best without that help."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.problem import LEAST_SHARE
from npfm.fitting.fits import Trace
from npfm.fitting.objective import Samples
from npfm.fitting.shared_lobes.directional import DirectionalLobesProblem
from npfm.fitting.shared_lobes.isotropic import SharedLobesProblem
from npfm.fitting.shared_lobes.problem import LobesProblem, State
from npfm.fitting.shared_lobes.starts import first_factors, start_states
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.directional import Directional

#: Bins of phi_d that starts are compared on: every n-th.
THINNING = 9
#: Least share of each lobe in the mean of a channel while starts are compared. With 0, random
#: starts lose lobes for good, and end at many times the objective.
ALIVE = 0.1
#: Least share in the end, which asks for no derivative: a fit is no worse than a constant.
FAINTEST = 1e-12
#: Tolerances, in the solver's, of the fit of one lobe, of the comparison of starts, of the best on
#: thinned samples and of the end: lobes of one material can be exchanged a little for hundreds of
#: iterations, for next to nothing.
SINGLE, COMPARED, THINNED, FINAL = 1000.0, 100.0, 30.0, 3.0


def fit_lobes(
    samples: Sequence[Samples], solve: Solver, seed: int, lobes: int, starts: int, spline: bool
) -> tuple[State, list[Trace]]:
    """Fit lobes to channels that share them.

    Parameters
    ----------
    samples : sequence of Samples
        Folded measurements of the channels.
    solve : Solver
        A solver with its settings.
    seed : int
        Of the random starts.
    lobes, starts : int
        How many.
    spline : bool
        Whether G is read along a spline.

    Returns
    -------
    state : State
        Lobes from the narrowest to the widest: the same fit has the same numbers.
    traces : list of Trace
        The best first, from its start to its end; those of the others on thinned samples.
    """
    problem = problem_of(samples, lobes, spline)
    rough, single = _rough(samples, lobes, spline), _rough(samples, 1, spline)
    D, F = first_factors(single)
    first = single.state(D[None], F, np.ones((1, single.sizes[2])))
    one, _ = solve(single, {"slices": first}, ease=SINGLE)
    named = dict(islice(start_states(rough, one, seed), starts))
    state, traces = solve(rough, named, ease=COMPARED)
    best, *others = traces
    state, (longer,) = solve(rough, {best.start: state}, ease=THINNED)
    last = {best.start: problem.unpack(rough.pack(state))}
    state, (trace,) = solve(problem, last, ease=FINAL)
    state = problem.with_coefficients(state, FAINTEST)
    trace = _joined(_joined(best, longer), trace)
    return by_width(state, problem.theta_h), [trace, *others]


def problem_of(
    samples: Sequence[Samples],
    lobes: int,
    spline: bool,
    floor: float = LEAST_SHARE,
    every: int = 1,
) -> LobesProblem:
    """Return the problem for the grid of the samples; on a directional one all samples count."""
    if isinstance(samples[0].grid, Directional):
        return DirectionalLobesProblem(samples, lobes, floor)
    return SharedLobesProblem(samples, lobes, spline, floor, every)


def _rough(samples: Sequence[Samples], lobes: int, spline: bool) -> LobesProblem:
    thinned = problem_of(samples, lobes, spline, ALIVE, THINNING)
    return thinned if thinned.energy else problem_of(samples, lobes, spline, ALIVE)


def _joined(before: Trace, after: Trace) -> Trace:
    """Return the second of two runs, with the time and the iterations of the first."""
    offset = before.seconds[-1]
    return replace(
        after,
        iterations=before.iterations + after.iterations,
        gss_calls=before.gss_calls + after.gss_calls,
        seconds=tuple(offset + second for second in after.seconds),
        compared=before.compared,
    )


def by_width(state: State, theta_h: NDArray[np.float64]) -> State:
    """Return the state with its lobes sorted by the mean theta_h of D."""
    order = np.argsort((state.D @ theta_h) / state.D.sum(1), kind="stable")
    wk, wkk, wrk = state.sums
    return replace(
        state,
        D=state.D[order],
        G=state.G[order],
        rho_s=state.rho_s[:, order],
        sums=(wk[..., order], wkk[..., order, :][..., order], wrk[..., order]),
    )
