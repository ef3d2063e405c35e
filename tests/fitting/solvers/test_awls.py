"""Alternating weighted least squares: downhill, safeguarded, and it says how it ended."""

from dataclasses import replace

import numpy as np
import pytest

from npfm.datasets import neural
from npfm.fitting.factors.problem import FactorProblem
from npfm.fitting.factors.slices import factors_of_slices
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.solvers import awls
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models.g_from_d import GFromDProblem
from npfm.models.independent_g import IndependentGProblem
from npfm.models.naive import NaiveProblem

PROBLEMS = pytest.mark.parametrize(
    "kind", [IndependentGProblem, GFromDProblem, NaiveProblem], ids=lambda kind: kind.__name__
)
#: A mirror and a plastic with a strong diffuse part.
MATERIALS = ("chrome", "green-latex")


@pytest.fixture(scope="module", params=MATERIALS)
def samples(request, data):
    """Green channel of a measured material at MERL's full resolution."""
    table = neural.load(data / "merl_nbrdf.zip", request.param)
    return channel_samples(table, 1, Objective())


def started(kind, samples, seed=None):
    """A problem, with a start from its slices or at random."""
    problem = kind(samples if kind is NaiveProblem else fold(samples))
    grid = samples.grid
    if seed is None:
        D, F = factors_of_slices(problem.samples)
    else:
        rng = np.random.default_rng(seed)
        D, F = rng.random(grid.theta_h_bins), rng.random(grid.theta_d_bins)
    if kind is GFromDProblem:
        return problem, problem.start(D, F)
    return problem, problem.state(D, F, np.ones(180 if kind is NaiveProblem else 90))


class Watched:
    """A problem that writes down the objective after every update that was accepted."""

    def __init__(self, problem: FactorProblem):
        self.problem = problem
        self.accepted = []

    def __getattr__(self, name):
        return getattr(self.problem, name)

    @property
    def stages(self):
        return [[self._watched(update) for update in stage] for stage in self.problem.stages]

    def _watched(self, update):
        def watched(state):
            self.accepted.append(self.problem.objective(state))
            return update(state)

        return watched


@PROBLEMS
def test_the_objective_never_rises(samples, kind):
    """Neither from iteration to iteration nor from update to update."""
    problem, start = started(kind, samples)
    watched = Watched(problem)
    state, trace = awls.minimise(watched, "slices", start, SolverSettings(max_iterations=6))
    # Sums that a normalisation scales are rounded; nothing else may raise the objective.
    assert (np.diff(watched.accepted) <= 1e-12 * np.array(watched.accepted[1:])).all()
    assert (np.diff(trace.objective) <= 0).all()
    assert trace.objective[-1] < 0.99 * trace.objective[0]
    direct = problem.objective(state) / problem.energy
    assert trace.objective[-1] == pytest.approx(direct, rel=1e-9)


@PROBLEMS
def test_a_capped_run_says_so(samples, kind):
    problem, start = started(kind, samples, seed=4)
    _, trace = awls.minimise(
        problem, "random", start, SolverSettings(max_iterations=2, tolerance=1e-12)
    )
    assert trace.status == "iteration cap"
    assert trace.iterations == 2
    assert len(trace.objective) == len(trace.seconds) == 3
    assert list(trace.seconds) == sorted(trace.seconds)
    assert trace.seconds[0] == 0


@PROBLEMS
def test_a_loose_tolerance_converges(samples, kind):
    problem, start = started(kind, samples)
    _, trace = awls.minimise(problem, "slices", start, SolverSettings(tolerance=0.5))
    assert trace.status == "converged"
    # One iteration that halves the objective at most follows on those that did better.
    assert trace.objective[-1] > 0.5 * trace.objective[-2]


class Valley:
    """A problem in one number whose update overshoots the minimum of (x - 1)^2 + 1 by far."""

    energy, lower, stages = 4.0, -10.0, ((lambda x: 10.0,),)

    def objective(self, x):
        return (x - 1) ** 2 + 1

    def pack(self, x):
        return np.array([x])

    def tops(self, packed):
        return np.array([0])

    def normal_equations(self, x):
        return np.array([x - 1, 0.0]), np.eye(2)

    def between(self, before, after, t):
        return (1 - t) * before + t * after

    def along(self, before, after):
        return lambda t: self.objective(self.between(before, after, t))

    def normalised(self, x):
        return x


def test_golden_section_saves_an_update_that_overshoots():
    x, trace = awls.minimise(Valley(), "0", 0.0, SolverSettings(tolerance=1e-3))
    assert trace.gss_calls >= 1
    assert x == pytest.approx(1, abs=0.02)
    assert trace.objective[0] == 0.5
    assert trace.objective[-1] == pytest.approx(0.25, abs=1e-3)
    assert (np.diff(trace.objective) <= 0).all()


def test_an_update_that_leads_uphill_only_is_dropped():
    x, trace = awls.minimise(Valley(), "1", 1.0, SolverSettings())
    assert x == pytest.approx(1, abs=1e-6)
    assert trace.gss_calls >= 1
    assert trace.status == "converged"


def test_golden_section_is_called_on_a_measured_material(data):
    """Solving for D while its G stays overshoots on a mirror: section 4.3's own case."""
    table = neural.load(data / "merl_nbrdf.zip", "chrome")
    problem, start = started(GFromDProblem, channel_samples(table, 1, Objective()), seed=2)
    _, trace = awls.minimise(problem, "random", start, SolverSettings(max_iterations=8))
    assert trace.gss_calls > 0
    assert (np.diff(trace.objective) <= 0).all()


def test_the_best_start_is_kept(samples):
    problem, slices = started(NaiveProblem, samples)
    _, poor = started(NaiveProblem, samples, seed=4)
    settings = SolverSettings(max_iterations=2)
    state, traces = awls.solve(problem, {"poor": poor, "slices": slices}, settings)
    assert {trace.start for trace in traces} == {"poor", "slices"}
    best = min(trace.objective[-1] for trace in traces)
    assert problem.objective(state) / problem.energy == pytest.approx(best, rel=1e-9)


def test_nothing_to_fit_ends_at_once(samples):
    black = replace(fold(samples), value=np.zeros_like(fold(samples).value), floor=0.0)
    problem = IndependentGProblem(black)
    start = problem.state(np.ones(90), np.ones(90), np.ones(90))
    state, trace = awls.minimise(problem, "ones", start, SolverSettings())
    assert trace.status == "converged"
    assert set(trace.objective) == {0.0}
    assert state.factors.rho_d == state.factors.rho_s == 0
