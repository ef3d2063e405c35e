"""Alternating weighted least squares with a golden-section safeguard.

Bagher et al. 2016, sections 4.2 and 4.3. Factors are updated in turn; a candidate that does not
lower the objective is pulled back along the line to the state before it by a golden-section
search, and dropped if nothing on the line is better. So the objective never rises.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

from npfm.fitting.fits import Trace
from npfm.fitting.solvers.golden import golden_section
from npfm.fitting.solvers.normal import status_at_rest
from npfm.fitting.solvers.problem import (
    NEGLIGIBLE,
    Follower,
    Problem,
    S,
    SolverSettings,
    Update,
    unfollowed,
)


def solve(
    problem: Problem[S],
    starts: Mapping[str, S],
    settings: SolverSettings,
    after_start: Callable[[], object] = lambda: None,
    ease: float = 1.0,
    follow: Follower[S] = unfollowed,
) -> tuple[S, list[Trace]]:
    """Run AWLS from each start; the state with the lowest objective and all traces.

    `after_start` is called when the run from a start has ended, `follow` after each iteration; the
    tolerance is that of the settings times `ease`.
    """
    settings = replace(settings, tolerance=ease * settings.tolerance)
    runs = []
    for name, start in starts.items():
        runs.append(minimise(problem, name, start, settings, follow))
        after_start()
    runs.sort(key=lambda run: run[1].objective[-1])
    return runs[0][0], [trace for _, trace in runs]


def minimise(
    problem: Problem[S],
    name: str,
    state: S,
    settings: SolverSettings,
    follow: Follower[S] = unfollowed,
) -> tuple[S, Trace]:
    """Run AWLS from one start, and tell `follow` of it and of each iteration.

    Returns
    -------
    state, trace
        The last state, and what happened. An iteration is one pass through the updates of a
        stage.
    """
    began = time.process_time()
    objectives, seconds = [problem.objective(state)], [0.0]
    energy = problem.energy or 1.0
    follow(name, 0, objectives[0] / energy, state)
    gss_calls, status = 0, "converged"
    for updates in problem.stages:
        decrease = float("inf")
        while decrease > settings.tolerance * objectives[-1] + NEGLIGIBLE * problem.energy:
            if len(objectives) > settings.max_iterations:
                status = "iteration cap"
                break
            current = objectives[-1]
            for update in updates:
                state, current, searched = _guarded(problem, state, current, update)
                gss_calls += searched
            state = problem.normalised(state)
            decrease = objectives[-1] - current
            objectives.append(current)
            seconds.append(time.process_time() - began)
            follow(name, len(objectives) - 1, current / energy, state)
    # Less is rounding: whether it comes out as 0 depends on the machine.
    if status == "converged" and decrease <= NEGLIGIBLE * problem.energy:
        status = status_at_rest(problem, state, objectives[-1], settings)
    relative = tuple(value / problem.energy if problem.energy else 0.0 for value in objectives)
    trace = Trace(name, status, len(objectives) - 1, gss_calls, tuple(seconds), relative)
    return state, trace


def _guarded(
    problem: Problem[S], state: S, current: float, update: Update[S]
) -> tuple[S, float, int]:
    """Take an update if it lowers the objective, else the best point on the way to it."""
    candidate = update(state)
    reached = problem.objective(candidate)
    if reached <= current:
        return candidate, reached, 0
    t = golden_section(problem.along(state, candidate))
    candidate = problem.between(state, candidate, t)
    reached = problem.objective(candidate)
    if reached <= current:
        return candidate, reached, 1
    return state, current, 1
