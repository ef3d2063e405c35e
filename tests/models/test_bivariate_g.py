"""The model with a free B and G: its elimination, its derivatives, and what it subsumes."""

import numpy as np
import pytest
from scipy.optimize import least_squares, nnls

from npfm.datasets import neural
from npfm.fitting import registry
from npfm.fitting.factors.microfacet import G_NODES, G_THETA, kernel, tabulate_channel
from npfm.fitting.factors.problem import Sums
from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.fitting.solvers import gauss_newton
from npfm.fitting.solvers.choice import SOLVERS, chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import bivariate_g
from npfm.models.bivariate_g import BivariateGProblem, best_B, best_rho_d
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import INVALID, Table

solve = chosen(SolverSettings())


def samples_of(table, channel=0):
    return fold(channel_samples(table, channel, Objective()))


def shaped(grid, value):
    """The same value in all three channels, invalid below the horizon."""
    return Table(np.where(grid.above_horizon, value, INVALID) * np.ones((3, 1, 1, 1)), grid)


def thinned(table, every=5):
    """A measurement on every fifth bin, whose centres are centres of the whole grid's bins."""
    middle = slice(every // 2, None, every)
    grid = HalfDifference(*(bins // every for bins in table.grid.shape))
    return Table(table.values[:, middle, middle, middle], grid)


def smooth_G(seed):
    rng = np.random.default_rng(seed)
    steps = rng.normal(0, 0.3, 4) @ np.cos(np.arange(1, 5)[:, None] * 2 * G_THETA)
    return np.exp(steps) * np.minimum(1, 3 * np.cos(G_THETA))


@pytest.mark.parametrize("diffuse", [-0.3, 0.0, 0.4, 3.0])
def test_rho_d_and_B_are_those_of_non_negative_least_squares(diffuse):
    """Where rho_d is at 0, where no B is, and where some are."""
    rng = np.random.default_rng(3)
    cells, phi = 12, 7
    w, K = rng.random((cells, phi)), rng.uniform(0.1, 5, (cells, phi))
    r = np.maximum(diffuse + K * rng.normal(0.3, 0.5, (cells, 1)) + rng.normal(0, 0.1, K.shape), 0)
    sums = Sums(*(np.sum(x, 1) for x in (w, w * r, w * K, w * K * K, w * r * K)), np.sum(w * r * r))
    design = np.column_stack([np.ones(w.size), np.kron(np.eye(cells), np.ones((phi, 1)))])
    design[:, 1:] *= K.reshape(-1, 1)
    root = np.sqrt(w.ravel())
    expected, norm = nnls(design * root[:, None], r.ravel() * root)
    rho_d = best_rho_d(sums)
    assert rho_d == pytest.approx(expected[0], rel=1e-9, abs=1e-12)
    np.testing.assert_allclose(best_B(sums, rho_d), expected[1:], rtol=1e-8, atol=1e-10)
    assert sums.objective(best_B(sums, rho_d), rho_d, 1.0) == pytest.approx(norm**2, rel=1e-9)


def test_B_does_what_rho_d_can_where_K_does_not_vary():
    one = np.array([1.0, 2.0])
    sums = Sums(one, 0.7 * one, 3 * one, 9 * one, 2.1 * one, 0.49 * 3)
    assert best_rho_d(sums) == 0
    np.testing.assert_allclose(best_B(sums, 0.0), 0.7 / 3)


def test_the_gradient_is_that_of_the_eliminated_objective(table):
    problem = BivariateGProblem(samples_of(table))
    for seed in range(3):
        state = problem.start(smooth_G(seed))
        packed, (gradient, _) = problem.pack(state), problem.normal_equations(state)
        assert abs(gradient[-1]) < 1e-8 * problem.energy
        for node in (3, 30, 55, 70, 80, 86):
            step = 1e-5 * np.eye(G_NODES)[node]
            ends = [problem.objective(problem.unpack(packed + s)) for s in (step, -step)]
            slope = (ends[0] - ends[1]) / 2e-5
            assert 2 * gradient[node] == pytest.approx(slope, rel=1e-4, abs=1e-7 * problem.energy)


def test_the_matrix_is_the_schur_complement_of_that_of_all_unknowns(table):
    problem = BivariateGProblem(samples_of(thinned(table, 2)))
    state = problem.start(smooth_G(1))
    cells, weight = state.B.size, problem.weight.ravel()

    def model(log_B, log_G):
        K = kernel(problem.elevations, np.exp(log_G))
        return (state.rho_d + np.exp(log_B)[:, None] * K).ravel()

    logs = np.log(np.maximum(state.B.ravel(), 1e-300)), problem.pack(state)
    jacobian = np.zeros((weight.size, cells + G_NODES + 1))
    for column in range(cells + G_NODES):
        step = np.split(1e-6 * np.eye(cells + G_NODES)[column], [cells])
        ends = [model(*(x + s * y for x, y in zip(logs, step, strict=True))) for s in (1, -1)]
        jacobian[:, column] = (ends[0] - ends[1]) / 2e-6
    jacobian[:, -1] = 1
    whole = jacobian.T @ (weight[:, None] * jacobian)
    free = np.flatnonzero(np.diag(whole)[:cells] > 0)
    kept = np.arange(cells, cells + G_NODES + 1)
    cross = whole[np.ix_(free, kept)]
    expected = whole[np.ix_(kept, kept)] - cross.T @ (cross / np.diag(whole)[free, None])
    chain = np.eye(G_NODES + 1)
    chain[:-1, :-1] = bivariate_g.LEVELLING
    _, matrix = problem.normal_equations(state)
    expected = chain.T @ expected @ chain
    np.testing.assert_allclose(matrix, expected, atol=1e-6 * np.abs(expected).max())


def test_general_least_squares_find_the_same_minimum():
    """All of B, G and rho_d at once, from the same start; no bound is met."""
    grid = HalfDifference(8, 8, 40)
    lobe = np.exp(-((np.tan(grid.theta_h[:, None, None]) / 0.3) ** 2)) + 0.3
    cos_i, cos_o = (np.maximum(cosine, 0) for cosine in grid.cosines)
    fresnel = 0.05 + 0.95 * (1 - np.cos(grid.theta_d)[:, None]) ** 4
    value = 0.2 + 2 * lobe * fresnel * np.sqrt((0.1 + cos_i) * (0.1 + cos_o))
    value *= 1 + 0.03 * np.random.default_rng(11).standard_normal(grid.shape)
    problem = BivariateGProblem(samples_of(shaped(grid, value)))
    start = problem.start(np.cos(G_THETA) ** 0.5)
    root, cells = np.sqrt(problem.weight), start.B.size
    target = root * problem.samples.value.reshape(root.shape)

    def residuals(x):
        K = kernel(problem.elevations, np.exp(bivariate_g.LEVELLING @ x[cells:-1]))
        return (root * (x[-1] + x[:cells, None] * K) - target).ravel()

    packed = np.concatenate([start.B.ravel(), problem.pack(start), [start.rho_d]])
    slow = least_squares(residuals, packed, method="lm", ftol=1e-12, xtol=1e-12)
    state, trace = gauss_newton.minimise(problem, "half", start, SolverSettings(tolerance=1e-9))
    assert trace.status == "converged"
    assert state.B.min() > 0 and state.rho_d > 0
    expected = problem.samples.floor + 2 * slow.cost
    assert problem.objective(state) == pytest.approx(expected, rel=1e-8)


def test_equivalent_G_are_the_same_state(table):
    """B takes exp(a cos theta) over, but for the interpolation of G between its nodes."""
    problem = BivariateGProblem(samples_of(table))
    G = smooth_G(2)
    one, other = problem.start(G), problem.start(G * np.exp(1.5 * np.cos(G_THETA)))
    np.testing.assert_allclose(other.G, one.G, rtol=1e-10)
    sums = problem.sums(G)
    rho_d = best_rho_d(sums)
    held = problem.samples.floor + sums.objective(best_B(sums, rho_d), rho_d, 1.0)
    assert held == pytest.approx(problem.objective(one), rel=1e-2)
    trend = np.polyfit(np.cos(G_THETA), np.log(one.G), 1)[0]
    assert abs(trend) < 1e-10


@pytest.mark.parametrize("method", SOLVERS)
def test_any_start_leads_to_the_same_minimum(table, method):
    problem = BivariateGProblem(samples_of(table))
    rng = np.random.default_rng(4)
    starts = {"ones": np.ones(G_NODES), "cosine": np.cos(G_THETA)}
    starts |= {f"random-{k}": rng.uniform(0.1, 1, G_NODES) for k in range(2)}
    solver = chosen(SolverSettings(method, tolerance=1e-6))
    found = [
        problem.objective(solver(problem, {name: problem.start(G)})[0])
        for name, G in starts.items()
    ]
    assert max(found) == pytest.approx(min(found), rel=1e-3)


def test_the_bivariate_model_is_a_special_case(table):
    """G = cos theta makes K = 1: the start of that name is never worse."""
    samples = samples_of(table)
    weight = samples.weight.sum(-1)
    B = (samples.weight * samples.value).sum(-1) / np.where(weight > 0, weight, 1)
    start = BivariateGProblem(samples).start(np.cos(G_THETA))
    assert BivariateGProblem(samples).objective(start) <= 1.001 * evaluate(samples, B[..., None])


def test_tables_of_independent_g_are_fitted(grid):
    """But for the trend in cos(theta) of a G, which interpolation takes over inexactly."""
    D, F = np.exp(-((np.tan(grid.theta_h) / 0.3) ** 2)), 0.1 + np.sin(grid.theta_d) ** 4
    for seed in range(3):
        made = shaped(grid, tabulate_channel(grid, D, F, smooth_G(seed), 0.1, 2.0))
        _, _, traces = bivariate_g.fit_samples(samples_of(made), solve)
        assert traces[0].objective[-1] < 1e-6


@pytest.mark.parametrize("name", ["alum-bronze", "nylon"])
def test_real_materials_are_fitted_no_worse_than_by_what_it_subsumes(data, name):
    material = thinned(neural.load(data / "merl_nbrdf.zip", name))
    found = {}
    for model in ("bivariate-g", "bivariate", "independent-g"):
        module = registry.model(model)
        fitted = module.tabulate(module.fit(material, Objective(), solve, 1))
        samples = [channel_samples(material, channel, Objective()) for channel in range(3)]
        found[model] = [
            evaluate(s, fitted.values[c] / s.scale) / s.energy for c, s in enumerate(samples)
        ]
    for ours, bivariate, independent in zip(*found.values(), strict=True):
        assert ours <= min(bivariate, independent)
        assert ours < 0.9 * independent
