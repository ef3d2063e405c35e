"""Damped Gauss-Newton (Levenberg-Marquardt) on the logarithms of the factors.

The objective is a weighted sum of squares in a few hundred unknowns, whose normal equations a
problem accumulates in one pass. Logarithms keep factors positive and make the product linear;
the clamp is a bound on them. After each step rho_d and rho_s are solved for exactly.
Several starts are run on thinned samples first, and only the best goes on to all of them.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

from npfm.fitting.fits import Trace
from npfm.fitting.solvers.normal import FIRST_DAMPING, status_at_rest, system
from npfm.fitting.solvers.problem import (
    NEGLIGIBLE,
    Follower,
    Problem,
    S,
    SolverSettings,
    unfollowed,
)

#: Several starts are compared on every n-th bin of phi_d, to so many times the tolerance.
COARSE, COARSE_TOLERANCE = 6, 10.0
LEAST_DAMPING, MOST_DAMPING = 1e-10, 1e8
#: Starts that differ by no more than this share of the energy are equally good: the first goes on.
TIE = 1e-12
#: Damping is divided by this after a step that helps, and multiplied by it after one that does not.
EASE, TIGHTEN = 5.0, 4.0
#: Iterations in a row that hardly lower the objective, before a run is called converged.
PATIENCE = 2


def solve(
    problem: Problem[S],
    starts: Mapping[str, S],
    settings: SolverSettings,
    after_start: Callable[[], object] = lambda: None,
    ease: float = 1.0,
    follow: Follower[S] = unfollowed,
) -> tuple[S, list[Trace]]:
    """Minimise from each start on thinned samples, then from the best on all of them.

    `after_start` is called when the run from a start has ended, `follow` after each iteration; the
    tolerance is that of the settings times `ease`.

    Returns
    -------
    state, traces
        The trace of the start that went on is that of its second run, the time of the first
        included, and where that one ended; the others' are those of their runs on thinned samples.
    """
    settings = replace(settings, tolerance=ease * settings.tolerance)
    coarse = problem.thinned(COARSE)
    if coarse.energy == 0:  # so few samples that thinning leaves none
        coarse = problem
    loose = replace(settings, tolerance=COARSE_TOLERANCE * settings.tolerance)
    runs = {}
    for name, start in starts.items():
        runs[name] = minimise(
            coarse, name, coarse.unpack(problem.pack(start)), loose, follow=follow
        )
        after_start()
    reached = {name: trace.objective[-1] for name, (_, trace) in runs.items()}
    best = next(name for name in runs if reached[name] <= min(reached.values()) + TIE)
    traces = {name: trace for name, (_, trace) in runs.items()}
    state = problem.unpack(coarse.pack(runs[best][0]))
    state, trace = minimise(problem, best, state, settings, traces.pop(best), follow)
    return state, [replace(trace, compared=reached[best]), *traces.values()]


def minimise(
    problem: Problem[S],
    name: str,
    state: S,
    settings: SolverSettings,
    earlier: Trace | None = None,
    follow: Follower[S] = unfollowed,
) -> tuple[S, Trace]:
    """Run from one start.

    Parameters
    ----------
    problem, name, state, settings
        What to minimise, the start's name, the start, and when to stop.
    earlier : Trace, optional
        A run on thinned samples that led to `state`: its time and iterations are counted.
    follow : callable, optional
        Is told of the start and of each accepted step.

    Returns
    -------
    state, trace
        An iteration is one accepted step.
    """
    offset = earlier.seconds[-1] if earlier else 0.0
    began = time.process_time() - offset
    objectives, seconds = [problem.objective(state)], [offset]
    energy = problem.energy or 1.0
    follow(name, 0, objectives[0] / energy, state)
    damping, calm, status = FIRST_DAMPING, 0, "converged"
    while calm < PATIENCE:
        if len(objectives) > settings.max_iterations:
            status = "iteration cap"
            break
        accepted, damping = _step(problem, state, objectives[-1], damping)
        if accepted is None:
            status = status_at_rest(problem, state, objectives[-1], settings)
            break
        state, reached = accepted
        enough = settings.tolerance * reached + NEGLIGIBLE * problem.energy
        calm = calm + 1 if objectives[-1] - reached <= enough else 0
        objectives.append(reached)
        seconds.append(time.process_time() - began)
        follow(name, len(objectives) - 1, reached / energy, state)
    relative = tuple(value / problem.energy if problem.energy else 0.0 for value in objectives)
    iterations = len(objectives) - 1 + (earlier.iterations if earlier else 0)
    return state, Trace(name, status, iterations, 0, tuple(seconds), relative)


def _step(
    problem: Problem[S], state: S, current: float, damping: float
) -> tuple[tuple[S, float] | None, float]:
    """Tighten the damping until a step lowers the objective; None if none does."""
    packed, equations = problem.pack(state), system(problem, state)
    while damping < MOST_DAMPING:
        candidate = problem.unpack(packed + equations.step(damping)[: packed.size])
        reached = problem.objective(candidate)
        if reached < current:
            return (candidate, reached), max(damping / EASE, LEAST_DAMPING)
        damping *= TIGHTEN
    return None, damping
