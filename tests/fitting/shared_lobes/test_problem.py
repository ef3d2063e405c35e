"""Passes, coefficients and updates of shared lobes against slow, independent ones."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from npfm.fitting.factors.microfacet import G_NODES, G_THETA
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.shared_lobes import kernels
from npfm.fitting.shared_lobes.alternating import best_component, updated_D, updated_F, updated_G
from npfm.fitting.shared_lobes.coefficients import bounded_least_squares
from npfm.fitting.shared_lobes.isotropic import SharedLobesProblem, with_diagonal
from npfm.fitting.shared_lobes.places import places
from npfm.fitting.solvers import awls, gauss_newton
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.half_difference import MERL

PASSES = [
    kernels.kernel_sums,
    kernels.coefficient_equations,
    kernels.normal_equations,
    kernels.gradient_and_diagonal,
    kernels.one_lobe,
    kernels.node_quartic,
]
both_readings = pytest.mark.parametrize("spline", [False, True])


@pytest.fixture(scope="module")
def samples(table):
    return [fold(channel_samples(table, channel, Objective())) for channel in range(3)]


def problem_and_state(samples, spline=False, lobes=3, seed=0):
    problem, rng = SharedLobesProblem(samples, lobes, spline), np.random.default_rng(seed)
    nh, nd, _ = problem.grid.shape
    factors = (rng.uniform(0.1, 1, shape) for shape in ((lobes, nh), (3, nd), (lobes, G_NODES)))
    return problem, problem.state(*factors)


def model(problem, state):
    """Equation 3 of Peng et al. 2017, sample by sample, shape (channels, rows, phi_d)."""
    nh, nd, _ = problem.grid.shape
    total = np.zeros_like(problem.weight)
    for c in range(3):
        total[c] = state.rho_d[c]
        for lobe in range(problem.lobes):
            B = np.outer(state.D[lobe], state.F[c]).reshape(nh * nd, 1)
            total[c] += state.rho_s[c, lobe] * B * problem.places.kernel(state.G[lobe])
    return total


def slow_objective(problem, state):
    counts, value = problem.weight > 0, np.zeros_like(problem.weight)
    np.divide(problem.weighted_value, problem.weight, out=value, where=counts)
    floor = np.mean([s.floor / s.energy for s in problem.samples])
    return floor + np.sum(problem.weight * (model(problem, state) - value) ** 2)


@pytest.mark.parametrize("function", PASSES, ids=lambda function: function.__name__)
def test_nothing_is_compiled_while_a_fit_is_timed(function):
    assert len(function.signatures) == 1
    with pytest.raises(TypeError, match="No matching definition"):
        function(*[np.float32(0)] * len(function.signatures[0]))


@both_readings
@pytest.mark.parametrize("lobes", [1, 3])
def test_the_objective_is_the_mean_share_of_the_channels(samples, spline, lobes):
    problem, state = problem_and_state(samples, spline, lobes)
    assert problem.objective(state) == pytest.approx(slow_objective(problem, state), rel=1e-10)
    assert problem.energy == pytest.approx(1.0, rel=1e-12)


@both_readings
def test_normal_equations_are_the_derivatives(samples, spline):
    problem, state = problem_and_state(samples, spline)
    logs = np.log(np.concatenate([x.ravel() for x in (state.D, state.F, state.G, state.rho_s)]))
    x, shapes = np.append(logs, state.rho_d), [state.D.shape, state.F.shape, state.G.shape, (3, 3)]
    ends = np.cumsum([np.prod(shape) for shape in shapes])

    def at(x):
        parts = [
            np.exp(part).reshape(shape)
            for part, shape in zip(np.split(x, ends)[:4], shapes, strict=True)
        ]
        moved = type(state)(*parts, x[ends[-1] :], state.sums)
        return model(problem, moved)

    gradient, matrix = kernels.normal_equations(
        *problem._arrays, state.D, state.F, state.G, state.rho_s, state.rho_d
    )
    rng = np.random.default_rng(3)
    directions = rng.standard_normal((3, x.size))
    moved = [(at(x + 1e-5 * v) - at(x - 1e-5 * v)) / 2e-5 for v in directions]
    residual = problem.weight * model(problem, state) - problem.weighted_value
    for v, change in zip(directions, moved, strict=True):
        assert gradient @ v == pytest.approx(np.vdot(residual, change), rel=1e-6, abs=1e-9)
        for u, other in zip(directions, moved, strict=True):
            found = v @ matrix @ u
            assert found == pytest.approx(np.vdot(problem.weight * change, other), rel=1e-6)


@both_readings
def test_gradient_and_diagonal_are_those_of_the_whole(samples, spline):
    problem, state = problem_and_state(samples, spline)
    at = state.D, state.F, state.G, state.rho_s, state.rho_d
    gradient, matrix = kernels.normal_equations(*problem._arrays, *at)
    found, diagonal = kernels.gradient_and_diagonal(*problem._arrays, *at)
    np.testing.assert_allclose(found, gradient, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(diagonal, np.diag(matrix), rtol=1e-9, atol=1e-15)


def test_coefficients_at_their_floor_follow_it(samples):
    """The gradient is that of the objective with the best coefficients, floors included."""
    problem, rng = SharedLobesProblem(samples, 3, floor=0.02), np.random.default_rng(5)
    widths = np.array([[0.1], [0.3], [0.9]])
    D = np.exp(-((problem.theta_h / widths) ** 2)) * rng.uniform(0.8, 1, (3, problem.sizes[0]))
    F, G = (rng.uniform(0.8, 1, (3, n)) for n in problem.sizes[1:])
    state = problem.state(D, F, G)
    floors = problem._at_floor(state)
    assert floors.any() and not floors.all()
    gradient, matrix = problem.normal_equations(state)
    packed = problem.pack(state)
    assert np.linalg.eigvalsh(matrix)[0] > -1e-9 * np.diag(matrix).max()
    for _ in range(6):
        v = np.where(np.diag(matrix)[: packed.size] > 0, rng.standard_normal(packed.size), 0)
        ahead, behind = (
            problem.objective(problem.unpack(packed + step * v)) for step in (1e-5, -1e-5)
        )
        found = 2 * gradient[: packed.size] @ v
        assert found == pytest.approx((ahead - behind) / 2e-5, rel=1e-3)


def test_a_matrix_of_fewer_samples_leads_to_the_same_minimum(samples, monkeypatch):
    _, state = problem_and_state(samples)
    found = []
    for bins in (10, 6):
        monkeypatch.setattr("npfm.fitting.shared_lobes.isotropic.MATRIX_BINS", bins)
        fresh = SharedLobesProblem(samples, 3)
        assert (fresh._matrix_problem is fresh) == (bins == 10)
        settings = SolverSettings(tolerance=1e-7)
        found.append(gauss_newton.minimise(fresh, "one", state, settings)[1].objective[-1])
    assert found[1] == pytest.approx(found[0], rel=1e-3)


def test_a_matrix_is_given_its_diagonal():
    matrix, diagonal = np.array([[4.0, 2, 0], [2, 9, 0], [0, 0, 0]]), np.array([1.0, 36, 5])
    expected = [[1, 2 * 0.5 * 2, 0], [2, 36, 0], [0, 0, 5]]
    np.testing.assert_allclose(with_diagonal(matrix, diagonal), expected)


@pytest.mark.parametrize("seed", range(20))
def test_bounded_least_squares(seed):
    rng = np.random.default_rng(seed)
    A, y = rng.standard_normal((30, 4)) + 0.5, rng.standard_normal(30)
    lower = rng.choice([0.0, 0.1], 4)
    found = bounded_least_squares(A.T @ A, A.T @ y, lower)
    expected = lsq_linear(A, y, (lower, np.inf), tol=1e-14).x
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_coefficients_of_equal_or_absent_products_are_finite():
    A = np.ones((5, 3))
    A[:, 2] = 0
    found = bounded_least_squares(A.T @ A, A.T @ np.full(5, 2.0), np.zeros(3))
    assert found[0] + found[1] == pytest.approx(2)
    assert found[2] == 0


def test_a_spline_goes_through_the_nodes_and_reads_parabolas_exactly():
    """At its ends the slope is that to the neighbour, so that there it is a parabola's no more."""
    at = places(MERL, 1, True)
    for G in (np.ones(G_NODES), G_THETA):
        linear, spline = places(MERL).kernel(G), at.kernel(G)
        np.testing.assert_allclose(spline, linear, rtol=1e-12)
    # theta = 30 degrees, between two nodes.
    theta = 30 * np.pi / 180
    node = int((theta - G_THETA[0]) / (G_THETA[1] - G_THETA[0]))
    row, p = np.argwhere((at.first_i == node - 1) & (at.inverse_cosines > 0))[0]
    read = np.sum(at.taps_i[row, p] * (G_THETA[node - 1 : node + 3]) ** 2)
    place = np.sum(at.taps_i[row, p] * G_THETA[node - 1 : node + 3])
    assert read == pytest.approx(place**2, rel=1e-12)


@both_readings
def test_each_update_of_awls_is_the_best_for_its_component(samples, spline):
    problem, state = problem_and_state(samples, spline)
    for updated in (
        updated_D(problem, 1, state),
        updated_F(problem, state),
        updated_G(problem, 2, 0.0, state),
    ):
        before, after = problem.objective(state), problem.objective(updated)
        assert after < before
    # The last component of G has seen all others at their ends: nothing near it is better.
    best = updated_G(problem, 2, 0.0, state)
    for factor in (0.99, 1.01):
        G = best.G.copy()
        G[2, -1] *= factor
        assert problem.objective(problem._with_G(best, G)) >= (1 - 1e-9) * problem.objective(best)


@pytest.mark.parametrize("seed", range(10))
def test_the_best_component_is_the_least_of_its_polynomial(seed):
    rng = np.random.default_rng(seed)
    quartic = np.append(rng.standard_normal(3) * [2, 3, 3], rng.uniform(0.1, 1))
    found = best_component(quartic, 0.5, 1e-6)
    x = np.linspace(1e-6, 40, 400_001)
    values = np.polyval([*quartic[::-1], 0], x)
    assert np.polyval([*quartic[::-1], 0], found) <= values.min() + 1e-9 * np.abs(values.min())


def test_nothing_is_changed_where_no_sample_reads_a_node():
    assert best_component(np.zeros(4), 0.3, 1e-6) == 0.3


@both_readings
@pytest.mark.parametrize("smooth", [False, True])
def test_awls_never_raises_the_objective(samples, spline, smooth, monkeypatch):
    monkeypatch.setattr("npfm.fitting.shared_lobes.problem.SPECULAR", 0.0 if smooth else np.inf)
    problem, state = problem_and_state(samples, spline)
    assert len(problem.stages) == (2 if smooth else 1)
    current = problem.objective(state)
    for stage in problem.stages:
        for _ in range(3):
            for update in stage:
                state, reached, _ = awls._guarded(problem, state, current, update)
                assert reached <= current
                current = reached
            state = problem.normalised(state)
            assert problem.objective(state) == pytest.approx(current, rel=1e-9)
    _, trace = awls.minimise(problem, "one", state, SolverSettings("awls", max_iterations=5))
    assert list(trace.objective) == sorted(trace.objective, reverse=True)
