"""Readings, passes and updates on a directional grid against slow, independent ones."""

import numpy as np
import pytest

from npfm.datasets import synthetic_anisotropic
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.shared_lobes import pair_kernels, sphere
from npfm.fitting.shared_lobes.alternating import updated_D, updated_F, updated_G
from npfm.fitting.shared_lobes.directional import DirectionalLobesProblem
from npfm.fitting.solvers import awls
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.directional import Directional

GRID = Directional(3, 8, 3, 8)


@pytest.fixture(scope="module")
def samples():
    table = synthetic_anisotropic.load("shot-silk", 1, GRID)
    return [fold(channel_samples(table, channel, Objective())) for channel in range(3)]


def problem_and_state(samples, lobes=3, seed=0):
    # With a floor no lobe is so faint that its best D would be beyond the clamp.
    problem, rng = DirectionalLobesProblem(samples, lobes, 0.1), np.random.default_rng(seed)
    nodes, f_nodes, _ = problem.sizes
    factors = (rng.uniform(0.1, 1, s) for s in ((lobes, nodes), (3, f_nodes), (lobes, nodes)))
    return problem, problem.state(*factors)


def model(problem, state):
    """Values of all samples, shape (channels, rows)."""
    D, F, G = problem.D_at(state.D), problem.F_at(state.F), state.G
    K = np.stack([problem.places.kernel(g)[:, 0] for g in G], axis=-1)
    return state.rho_d[:, None] + F * np.einsum("cl,rl->cr", state.rho_s, D * K)


def slow_objective(problem, state):
    weight, product = problem.weight[..., 0], problem.weighted_value[..., 0]
    value = np.divide(product, weight, out=np.zeros_like(product), where=weight > 0)
    floor = np.mean([s.floor / s.energy for s in problem.samples])
    return floor + np.sum(weight * (model(problem, state) - value) ** 2)


@pytest.mark.parametrize("function", [pair_kernels.relaxed, pair_kernels.equations_of_pairs])
def test_nothing_is_compiled_while_a_fit_is_timed(function):
    assert len(function.signatures) == 1


def test_the_objective_is_the_mean_share_of_the_channels(samples):
    problem, state = problem_and_state(samples)
    assert problem.objective(state) == pytest.approx(slow_objective(problem, state), rel=1e-10)
    assert problem.energy == pytest.approx(1.0, rel=1e-12)


def test_normal_equations_are_the_derivatives(samples):
    problem, state = problem_and_state(samples)
    logs = np.log(np.concatenate([x.ravel() for x in (state.D, state.F, state.G, state.rho_s)]))
    x, shapes = np.append(logs, state.rho_d), [state.D.shape, state.F.shape, state.G.shape, (3, 3)]
    ends = np.cumsum([np.prod(shape) for shape in shapes])

    def at(x):
        parts = zip(np.split(x, ends)[:4], shapes, strict=True)
        factors = [np.exp(part).reshape(shape) for part, shape in parts]
        return model(problem, type(state)(*factors, x[ends[-1] :], state.sums))

    gradient, matrix, _ = problem.derivatives(state)
    rng = np.random.default_rng(3)
    directions = rng.standard_normal((3, x.size))
    moved = [(at(x + 1e-5 * v) - at(x - 1e-5 * v)) / 2e-5 for v in directions]
    weight = problem.weight[..., 0]
    residual = weight * model(problem, state) - problem.weighted_value[..., 0]
    for v, change in zip(directions, moved, strict=True):
        assert gradient @ v == pytest.approx(np.vdot(residual, change), rel=1e-6, abs=1e-9)
        for u, other in zip(directions, moved, strict=True):
            assert v @ matrix @ u == pytest.approx(np.vdot(weight * change, other), rel=1e-6)


def test_coefficients_at_their_floor_follow_it(samples):
    """The gradient is that of the objective with the best coefficients, floors included."""
    problem, rng = DirectionalLobesProblem(samples, 3, 0.02), np.random.default_rng(5)
    state = problem.state(*(rng.uniform(0.3, 1, (3, n)) for n in problem.sizes))
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


def updates(problem):
    for lobe in range(3):
        yield lambda state, lobe=lobe: updated_D(problem, lobe, state)
        yield lambda state, lobe=lobe: updated_G(problem, lobe, 0.0, state)
    yield lambda state: updated_F(problem, state)


def test_no_update_raises_the_objective(samples):
    problem, state = problem_and_state(samples)
    for _ in range(3):
        for update in updates(problem):
            changed = update(state)
            assert problem.objective(changed) <= problem.objective(state) * (1 + 1e-12)
            state = changed


def test_a_component_is_the_best_that_there_is(samples):
    """After its update no other value of the last component that was updated is better."""
    problem, state = problem_and_state(samples)
    for factor, update in (("D", updated_D), ("G", lambda p, k, s: updated_G(p, k, 0.0, s))):
        changed = update(problem, 1, state)
        last = getattr(changed, factor)
        now = problem.objective(changed)
        at_clamp = last[1, -1] <= 1.001e-6 * last[1].max()
        for share in (1.1,) if at_clamp else (0.9, 1.1):
            other = last.copy()
            other[1, -1] *= share
            moved = problem.between(
                changed, type(changed)(**{**changed.__dict__, factor: other}), 1.0
            )
            assert problem.objective(moved) >= now * (1 - 1e-12)


def test_awls_never_raises_the_objective(samples):
    problem, state = problem_and_state(samples)
    settings = SolverSettings("awls", max_iterations=6)
    _, [trace] = awls.solve(problem, {"one": state}, settings)
    assert list(trace.objective) == sorted(trace.objective, reverse=True)
    assert trace.objective[-1] < 0.5 * trace.objective[0]


def test_the_normal_is_one_node():
    assert sphere.node_count(GRID) == 1 + 2 * 8
    values = np.arange(17.0)
    spread = sphere.spread(values, GRID)
    assert spread.shape == (3, 8)
    assert (spread[0] == 0).all()
    assert np.array_equal(sphere.gathered(spread), values)


def test_readings_turn_with_the_azimuth_and_do_not_tell_light_from_view():
    at = sphere.reading_of_all(GRID)
    lobe = np.random.default_rng(1).random((2, sphere.node_count(GRID)))
    values = at.D_at(lobe).T.reshape(2, *GRID.shape)
    assert np.array_equal(values, values.transpose(0, 3, 4, 1, 2))
    turned = sphere.gathered(np.roll(sphere.spread(lobe, GRID), 3, axis=-1))
    again = at.D_at(turned).T.reshape(2, *GRID.shape)
    np.testing.assert_allclose(again, np.roll(values, (3, 3), (2, 4)), rtol=1e-9)
    assert np.abs(at.D_taps.sum(1) - 1).max() < 1e-12
    assert np.abs(at.F_taps.sum(1) - 1).max() < 1e-12


def test_what_no_sample_reads_is_taken_from_the_neighbours(samples):
    problem, _ = problem_and_state(samples)
    lobe = np.arange(1.0, 18.0)
    seen = np.ones(17, dtype=bool)
    seen[[0, 3]] = False
    filled = sphere.spread(problem.filled(lobe, seen), GRID) * 17
    assert filled[1, 2] == pytest.approx((3 + 5) / 2)
    assert filled[0, 0] == pytest.approx(filled[1].mean(), rel=1e-12)
    assert (problem.filled(lobe, np.zeros(17, dtype=bool)) == 1).all()
