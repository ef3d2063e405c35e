"""Gauss-Newton on logarithms, against SciPy's least squares and against AWLS."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from npfm.datasets import neural
from npfm.fitting.factors.microfacet import G_THETA, elevations, kernel
from npfm.fitting.factors.slices import factors_of_slices
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.solvers import awls, gauss_newton
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models.g_from_d import GFromDProblem
from npfm.models.independent_g import IndependentGProblem
from npfm.models.naive import NaiveProblem
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

PROBLEMS = pytest.mark.parametrize(
    "kind", [IndependentGProblem, GFromDProblem, NaiveProblem], ids=lambda kind: kind.__name__
)
TIGHT = SolverSettings(tolerance=1e-10)


@pytest.fixture(scope="module")
def table(data):
    """A measured material at MERL's full resolution."""
    return neural.load(data / "merl_nbrdf.zip", "green-latex")


@pytest.fixture(scope="module")
def samples(table):
    """Its red channel on every ninth bin: centres of 10 bins are centres of MERL's 90."""
    thin = Table(
        np.ascontiguousarray(table.values[:, 4::9, 4::9, 4::9]), HalfDifference(10, 10, 20)
    )
    return channel_samples(thin, 0, Objective())


def started(kind, samples):
    problem = kind(samples if kind is NaiveProblem else fold(samples))
    D, F = factors_of_slices(problem.samples)
    if kind is GFromDProblem:
        return problem, problem.start(D, F)
    modulation = samples.grid.phi_d_bins if kind is NaiveProblem else G_THETA.size
    return problem, problem.state(D, F, np.ones(modulation))


@PROBLEMS
def test_the_objective_never_rises(table, kind):
    problem, start = started(kind, channel_samples(table, 1, Objective()))
    state, trace = gauss_newton.minimise(problem, "slices", start, SolverSettings(max_iterations=4))
    assert (np.diff(trace.objective) < 0).all()
    assert trace.objective[-1] < 0.9 * trace.objective[0]
    assert trace.objective[-1] == pytest.approx(problem.objective(state) / problem.energy)
    assert trace.iterations == len(trace.objective) - 1
    assert trace.gss_calls == 0


@PROBLEMS
def test_every_accepted_step_is_downhill_to_the_end(samples, kind):
    """From far away, and down to where only rounding is left to gain."""
    problem, near = started(kind, samples)
    start = problem.unpack(np.random.default_rng(6).uniform(-6, 0, problem.pack(near).size))
    _, trace = gauss_newton.minimise(problem, "random", start, SolverSettings(tolerance=1e-15))
    assert trace.iterations > 10
    assert (np.diff(trace.objective) < 0).all()


def residuals(problem, rho_s):
    """Root of the weight times model minus value, as a function of log factors and rho_d."""
    grid, samples = problem.samples.grid, problem.samples
    nh, nd, _ = grid.shape
    counts = samples.weight > 0
    root, value = np.sqrt(samples.weight[counts]), samples.value[counts]

    def of(x):
        D, F = np.exp(x[:nh]), np.exp(x[nh : nh + nd])
        if isinstance(problem, NaiveProblem):
            K = np.exp(x[nh + nd : -1])
        else:
            G = np.exp(x[nh + nd : -1])
            if isinstance(problem, GFromDProblem):
                G = masking_shadowing(D, grid, G_THETA)
            K = kernel(elevations(grid), G).reshape(nh, nd, -1)
        model = x[-1] + rho_s * D[:, None, None] * F[:, None] * K
        return root * (model[counts] - value)

    return of


def by_scipy(problem, state):
    """Objective of the minimum that SciPy's trust region finds from a state."""
    f = state.factors
    factors = [f.D, f.F] if isinstance(problem, GFromDProblem) else [f.D, f.F, f.modulation]
    # The factors take the scale of rho_s, which is held.
    x = np.concatenate([*(np.log(np.maximum(a, 1e-6)) for a in factors), [f.rho_d]])
    lower = np.append(np.full(x.size - 1, -30.0), 0.0)
    found = least_squares(
        residuals(problem, f.rho_s),
        np.maximum(x, lower + 1e-9),
        bounds=(lower, np.append(np.full(x.size - 1, 30.0), np.inf)),
        x_scale="jac",
        xtol=1e-15,
        ftol=1e-9,
        gtol=1e-15,
    )
    return 2 * found.cost + problem.samples.floor


@PROBLEMS
def test_scipy_reaches_the_same_minimum_from_the_same_start(samples, kind):
    """A solver that shares nothing with ours, on residuals of its own."""
    problem, start = started(kind, samples)
    state, trace = gauss_newton.minimise(problem, "slices", start, TIGHT)
    assert trace.status == "converged"
    assert by_scipy(problem, start) == pytest.approx(problem.objective(state), rel=1e-6)


@PROBLEMS
def test_awls_does_not_get_below(samples, kind):
    """By more than a thousandth, with as many iterations as it likes."""
    problem, start = started(kind, samples)
    state, _ = gauss_newton.minimise(problem, "slices", start, SolverSettings())
    slow, trace = awls.minimise(problem, "slices", start, SolverSettings("awls", 1e-9, 3000))
    assert trace.iterations > 20
    assert problem.objective(slow) > 0.999 * problem.objective(state)
    further, _ = awls.minimise(problem, "there", state, SolverSettings("awls", 1e-9, 300))
    assert problem.objective(further) > 0.999 * problem.objective(state)


@PROBLEMS
def test_the_gradient_vanishes_at_the_end(samples, kind):
    problem, start = started(kind, samples)
    state, _ = gauss_newton.minimise(problem, "slices", start, TIGHT)
    gradient, matrix = problem.normal_equations(state)
    free = np.append(problem.pack(state) > problem.lower + 1e-6, state.factors.rho_d > 0)
    free &= np.diag(matrix) > 0
    # What a Newton step along one unknown would still gain, as a share of the objective.
    gain = gradient[free] ** 2 / np.diag(matrix)[free]
    assert gain.max() < 1e-7 * problem.objective(state)


def test_a_factor_that_should_vanish_ends_at_its_bound():
    """A ring: D is 0 but for some bins, and the clamp is where they end."""
    grid = HalfDifference(18, 18, 36)
    ring = np.exp(-(((grid.theta_h - 0.5) / 0.15) ** 2)) * (np.abs(grid.theta_h - 0.5) < 0.3)
    value = np.where(grid.above_horizon, ring[:, None, None], -1.0)
    samples = fold(channel_samples(Table(value * np.ones((3, 1, 1, 1)), grid), 0, Objective()))
    problem = IndependentGProblem(samples)
    start = problem.state(np.ones(18), np.ones(18), np.ones(G_THETA.size))
    state, trace = gauss_newton.minimise(problem, "ones", start, SolverSettings(tolerance=1e-8))
    empty = (ring == 0) & problem.seen[0]
    assert empty.any()
    np.testing.assert_allclose(state.factors.D[empty], problem.clamp, rtol=1e-6)
    assert trace.objective[-1] < 1e-6


def test_only_the_best_start_goes_on_to_all_samples(samples):
    problem, good = started(IndependentGProblem, samples)
    rng = np.random.default_rng(4)
    poor = problem.state(rng.random(10), rng.random(10), rng.random(G_THETA.size))
    settings = SolverSettings(max_iterations=3)
    state, traces = gauss_newton.solve(problem, {"poor": poor, "good": good}, settings)
    assert {trace.start for trace in traces} == {"poor", "good"}
    reached = problem.objective(state) / problem.energy
    assert sum(trace.objective[-1] == pytest.approx(reached, rel=1e-9) for trace in traces) == 1
    assert {trace.status for trace in traces} == {"iteration cap"}


def test_the_start_that_goes_on_says_where_it_was_when_it_was_chosen(samples):
    """Where it stood on the samples that all starts were compared on."""
    problem, good = started(IndependentGProblem, samples)
    rng = np.random.default_rng(4)
    poor = problem.state(rng.random(10), rng.random(10), rng.random(G_THETA.size))
    settings = SolverSettings(tolerance=1e-5)
    _, (winner, loser) = gauss_newton.solve(problem, {"poor": poor, "good": good}, settings)
    starts = {"poor": poor, "good": good}
    loose = SolverSettings(tolerance=gauss_newton.COARSE_TOLERANCE * settings.tolerance)
    thinned = problem.thinned(gauss_newton.COARSE)
    for trace in (winner, loser):
        start = thinned.unpack(problem.pack(starts[trace.start]))
        _, alone = gauss_newton.minimise(thinned, trace.start, start, loose)
        assert trace.end == alone.objective[-1]
    assert winner.end <= loser.end + gauss_newton.TIE
    assert loser.end == loser.objective[-1]
    assert winner.end != winner.objective[-1]


def test_nothing_to_fit_ends_at_once():
    grid = HalfDifference(10, 10, 20)
    black = np.where(grid.above_horizon, 0.0, -1.0) * np.ones((3, 1, 1, 1))
    problem = NaiveProblem(channel_samples(Table(black, grid), 0, Objective()))
    start = problem.state(np.ones(10), np.ones(10), np.ones(20))
    _, trace = gauss_newton.minimise(problem, "ones", start, SolverSettings())
    assert (trace.status, trace.iterations, trace.objective) == ("converged", 0, (0.0,))
