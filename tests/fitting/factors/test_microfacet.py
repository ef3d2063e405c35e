"""Passes over the samples of equation 3, against plain NumPy that goes sample by sample."""

from dataclasses import replace

import numpy as np
import pytest

from npfm.datasets import synthetic
from npfm.fitting.factors import kernels
from npfm.fitting.factors.microfacet import G_NODES, G_THETA, elevations, kernel, tabulate_channel
from npfm.fitting.factors.problem import Factors, State
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import g_from_d
from npfm.models.g_from_d import GFromDProblem
from npfm.models.independent_g import IndependentGProblem
from npfm.models.naive import NaiveProblem
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import Table


def microfacet(grid, D, F, G, rho_d, rho_s):
    """Equation 3 at every cell, angles from the directions, G by `np.interp`."""
    centres = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d, indexing="ij")
    value = rho_s * D[:, None, None] * F[:, None] * np.ones(grid.shape)
    for direction in directions(*centres):
        theta = np.minimum(np.arccos(np.clip(direction[..., 2], -1, 1)), G_THETA[-1])
        value = value * np.interp(theta, G_THETA, G) / np.cos(np.maximum(theta, G_THETA[0]))
    return rho_d + value


def naive(grid, D, F, H, rho_d, rho_s):
    """Equation 4 at every cell."""
    return rho_d + rho_s * D[:, None, None] * F[:, None] * H


PASSES = [kernels.kernel_sums, kernels.masking_shadowing_equations, kernels.normal_equations]


@pytest.mark.parametrize("function", PASSES, ids=lambda function: function.__name__)
def test_nothing_is_compiled_while_a_fit_is_timed(function):
    """Each pass is there when its module is imported, and for no other types later."""
    assert len(function.signatures) == 1
    others = [np.float32(0)] * len(function.signatures[0])
    with pytest.raises(TypeError, match="No matching definition"):
        function(*others)
    assert len(function.signatures) == 1


VALUES = {IndependentGProblem: microfacet, GFromDProblem: microfacet, NaiveProblem: naive}
PROBLEMS = pytest.mark.parametrize("kind", list(VALUES), ids=lambda kind: kind.__name__)


def problem_of(kind, samples):
    return kind(samples if kind is NaiveProblem else fold(samples))


def random_state(problem, seed=3):
    """Factors of some range, with coefficients that are not the best."""
    rng = np.random.default_rng(seed)
    nh, nd, nphi = problem.samples.grid.shape
    modulation = nphi if isinstance(problem, NaiveProblem) else G_NODES
    D, F, modulation = (np.exp(rng.uniform(-2, 0, n)) for n in (nh, nd, modulation))
    state = problem.start(D, F) if isinstance(problem, GFromDProblem) else None
    return (state or problem.state(D, F, modulation)).with_factors(rho_d=0.4, rho_s=1.3)


def values(problem, state):
    f = state.factors
    whole = VALUES[type(problem)](problem.samples.grid, f.D, f.F, f.modulation, f.rho_d, f.rho_s)
    return whole[..., : problem.samples.weight.shape[-1]]


@PROBLEMS
@pytest.mark.parametrize("channel", [0, 2])
def test_objective_from_sums_is_the_sum_over_all_samples(table, kind, channel):
    """Collapsing phi_d and folding it change nothing, whatever the factors are."""
    samples = channel_samples(table, channel, Objective())
    problem = problem_of(kind, samples)
    state = random_state(problem)
    f = state.factors
    whole = VALUES[kind](table.grid, f.D, f.F, f.modulation, f.rho_d, f.rho_s)
    assert problem.objective(state) == pytest.approx(evaluate(samples, whole), rel=1e-11)
    best = state.with_coefficients()
    f = best.factors
    whole = VALUES[kind](table.grid, f.D, f.F, f.modulation, f.rho_d, f.rho_s)
    assert problem.objective(best) == pytest.approx(evaluate(samples, whole), rel=1e-11)


def test_kernel_at_every_cell():
    grid = HalfDifference(30, 30, 60)
    G = np.exp(np.random.default_rng(1).uniform(-3, 0, G_NODES))
    found = kernel(elevations(grid), G).reshape(30, 30, 30)
    expected = microfacet(grid, np.ones(30), np.ones(30), G, 0.0, 1.0)[..., :30]
    above = grid.above_horizon[..., :30]
    np.testing.assert_allclose(found[above], expected[above], rtol=1e-7)
    assert not found[~above].any()


def test_kernel_of_a_constant_g_is_bounded_at_grazing():
    """Beyond 89.5 degrees the last node stands for everything."""
    found = kernel(elevations(MERL), np.ones(G_NODES))
    assert found.max() <= np.cos(np.deg2rad(89.5)) ** -2


def test_tabulated_values_cell_by_cell(table):
    rng = np.random.default_rng(2)
    D, F, G = rng.random(18), rng.random(18), rng.random(G_NODES)
    found = tabulate_channel(table.grid, D, F, G, 0.25, 1.5)
    expected = microfacet(table.grid, D, F, G, 0.25, 1.5)
    above = table.grid.above_horizon
    np.testing.assert_allclose(found[above], expected[above], rtol=1e-9)
    assert (found[~above] == 0.25).all()
    assert (found == found[..., ::-1]).all()


@PROBLEMS
def test_sums_by_hand(table, kind):
    problem = problem_of(kind, channel_samples(table, 1, Objective()))
    state, samples = random_state(problem), problem.samples
    f = state.factors
    flat = replace(f, D=np.ones_like(f.D), F=np.ones_like(f.F), rho_d=0.0, rho_s=1.0)
    k = values(problem, replace(state, factors=flat))
    w, r = samples.weight, samples.value
    expected = {"w": w, "wr": w * r, "wk": w * k, "wkk": w * k * k, "wrk": w * r * k}
    for name, array in expected.items():
        np.testing.assert_allclose(
            getattr(state.sums, name), array.sum(-1), rtol=1e-9, err_msg=name
        )
    assert state.sums.wrr == pytest.approx(float((w * r * r).sum()), rel=1e-13)


@PROBLEMS
def test_which_components_are_seen(gappy, kind):
    """A component is seen if changing it changes a value that counts."""
    problem = problem_of(kind, channel_samples(gappy, 0, Objective(max_angle=70)))
    state = random_state(problem)
    before, counts = values(problem, state), problem.samples.weight > 0
    for name, seen in zip(("D", "F", "modulation"), problem.seen, strict=True):
        factor = getattr(state.factors, name)
        for k in range(factor.size):
            changed = factor.copy()
            changed[k] *= 2
            after = values(
                problem, replace(state, factors=replace(state.factors, **{name: changed}))
            )
            # Parts of 1e-12 and less are rounding of the angles.
            assert seen[k] == (np.abs(after - before)[counts] > 1e-10).any(), (name, k)
    assert not problem.seen[0].all()


def test_equations_of_g_by_hand(table):
    """Tridiagonal equations against a dense design matrix of both places."""
    problem = problem_of(IndependentGProblem, channel_samples(table, 1, Objective()))
    f, grid = random_state(problem).factors, table.grid
    other = np.exp(np.random.default_rng(5).uniform(-1, 0, G_NODES))
    diagonal, beside, right = kernels.masking_shadowing_equations(
        problem.weight,
        problem.weighted_value,
        *problem.elevations.arrays,
        f.rho_s * np.outer(f.D, f.F).ravel(),
        f.rho_d,
        other,
    )
    half, counts = grid.phi_d_bins // 2, problem.samples.weight > 0
    centres = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d[:half], indexing="ij")
    theta = [np.arccos(d[..., 2][counts]) for d in directions(*centres)]
    w, r = problem.samples.weight[counts], problem.samples.value[counts]
    slope = (f.rho_s * f.D[:, None, None] * f.F[:, None] * np.ones(centres[0].shape))[counts]
    hats = [np.array([np.interp(t, G_THETA, row) for row in np.eye(G_NODES)]).T for t in theta]
    matrix, expected = np.zeros((G_NODES, G_NODES)), np.zeros(G_NODES)
    for sought, far in ((0, 1), (1, 0)):
        y = slope * (hats[far] @ other) / (np.cos(theta[0]) * np.cos(theta[1]))
        design = hats[sought] * y[:, None]
        matrix += design.T @ (design * w[:, None])
        expected += design.T @ (w * (r - f.rho_d))
    np.testing.assert_allclose(diagonal, np.diag(matrix), rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(beside[1:], np.diag(matrix, 1), rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(right, expected, rtol=1e-8, atol=1e-10)


def unknowns(problem, state):
    """Logarithms of the free factors, then rho_d, and the model values they give."""
    f, nh = state.factors, state.factors.D.size
    seen, bins = problem.seen[0], np.arange(nh)
    nd = f.F.size

    def at(x):
        D, F, modulation = np.exp(x[:nh]), np.exp(x[nh : nh + nd]), np.exp(x[nh + nd : -1])
        if isinstance(problem, GFromDProblem):
            D = np.interp(bins, bins[seen], D[seen])  # bins without a sample are filled in
            G = masking_shadowing(D, problem.samples.grid, G_THETA)
            modulation = G / G.max()
        return values(problem, State(Factors(D, F, modulation, x[-1], f.rho_s), state.sums))

    factors = [f.D, f.F] if isinstance(problem, GFromDProblem) else [f.D, f.F, f.modulation]
    return np.append(np.log(np.concatenate(factors)), f.rho_d), at


@PROBLEMS
@pytest.mark.parametrize("holes", [False, True])
def test_normal_equations_by_differences(table, gappy, kind, holes):
    """Gradient J'Wr and matrix J'WJ with J by central differences of the slow model."""
    samples = channel_samples(gappy if holes else table, 1, Objective())
    problem = problem_of(kind, samples)
    state = random_state(problem)
    if kind is GFromDProblem:  # G scaled over all its nodes, as the slow model scales it
        G = problem.smith(state.factors.D)
        state = State(replace(state.factors, modulation=G), problem.sums(G))
    gradient, matrix = problem.normal_equations(state)
    x, at = unknowns(problem, state)
    assert gradient.shape == x.shape
    counts, step = problem.samples.weight > 0, 1e-5
    w, r = problem.samples.weight[counts], problem.samples.value[counts]
    jacobian = np.stack(
        [(at(x + e) - at(x - e))[counts] / (2 * step) for e in np.eye(x.size) * step], axis=1
    )
    expected = jacobian.T @ (w * (at(x)[counts] - r))
    np.testing.assert_allclose(gradient, expected, atol=1e-7 * np.abs(expected).max())
    expected = jacobian.T @ (jacobian * w[:, None])
    np.testing.assert_allclose(matrix, expected, atol=1e-7 * np.abs(expected).max())
    scale = np.sqrt(np.maximum(np.diag(expected), 1e-300))
    np.testing.assert_allclose(
        matrix / scale / scale[:, None], expected / scale / scale[:, None], atol=1e-5
    )


@PROBLEMS
def test_gradient_is_that_of_the_objective(table, kind):
    """Half the derivative of the objective itself, coefficients fixed."""
    samples = channel_samples(table, 0, Objective())
    problem = problem_of(kind, samples)
    state = random_state(problem)
    if kind is GFromDProblem:
        G = problem.smith(state.factors.D)
        state = State(replace(state.factors, modulation=G), problem.sums(G))
    gradient, _ = problem.normal_equations(state)
    x, at = unknowns(problem, state)
    rng = np.random.default_rng(9)
    for _ in range(5):
        direction = rng.standard_normal(x.size)
        step = 1e-6 * direction
        ahead, behind = (evaluate(problem.samples, at(x + s)) for s in (step, -step))
        assert 2 * gradient @ direction == pytest.approx((ahead - behind) / 2e-6, rel=1e-5)


@pytest.mark.parametrize("kind", [IndependentGProblem, GFromDProblem])
def test_a_thinned_problem_is_that_of_its_samples(table, kind):
    """Every sixth bin of phi_d from the middle of the first six."""
    folded = fold(channel_samples(table, 1, Objective()))
    problem = kind(folded).thinned(6)
    state = random_state(problem)
    f = state.factors
    model = microfacet(table.grid, f.D, f.F, f.modulation, f.rho_d, f.rho_s)[..., 3:18:6]
    expected = np.sum(folded.weight[..., 3::6] * (model - folded.value[..., 3::6]) ** 2)
    assert problem.objective(state) == pytest.approx(expected + folded.floor / 6, rel=1e-11)


def test_a_thinned_problem_stands_for_the_whole():
    """Its relative objective is about that of all samples, so that starts can be compared."""
    grid = HalfDifference(18, 18, 180)
    cos_i, cos_o = grid.cosines
    value = 0.2 + np.maximum(cos_i * cos_o, 0) + np.exp(-20 * grid.theta_h[:, None, None] ** 2)
    table = Table(np.where(grid.above_horizon, value, -1) * np.ones((3, 1, 1, 1)), grid)
    problem = IndependentGProblem(fold(channel_samples(table, 0, Objective())))
    coarse = problem.thinned(6)
    smooth = np.exp(-5 * grid.theta_h), 1 + grid.theta_d, np.cos(G_THETA)
    relative = [p.objective(p.state(*smooth)) / p.energy for p in (problem, coarse)]
    assert relative[1] == pytest.approx(relative[0], rel=0.01)


def test_the_naive_model_is_not_thinned(table):
    problem = NaiveProblem(channel_samples(table, 1, Objective()))
    assert problem.thinned(6) is problem


def test_steps_of_g_along_a_line_are_a_polynomial(table):
    """Of degree 4, for nothing else changes: exact between its five points too."""
    problem = problem_of(IndependentGProblem, channel_samples(table, 1, Objective()))
    state = random_state(problem)
    G = np.exp(np.random.default_rng(8).uniform(-2, 0, G_NODES))
    after = State(replace(state.factors, modulation=G), problem.sums(G))
    along = problem.along(state, after)
    for t in (0.0, 0.1, 0.37, 0.9, 1.0):
        expected = evaluate(problem.samples, values(problem, problem.between(state, after, t)))
        assert along(t) == pytest.approx(expected, rel=1e-9)


def test_g_of_d_between_states_is_that_of_the_d_between(table):
    problem = problem_of(GFromDProblem, channel_samples(table, 1, Objective()))
    before, after = random_state(problem, 1), random_state(problem, 2)
    middle = problem.between(before, after, 0.3)
    G = masking_shadowing(middle.factors.D, table.grid, G_THETA)
    np.testing.assert_allclose(middle.factors.modulation, G / G.max(), rtol=1e-13)
    assert problem.objective(middle) == pytest.approx(
        evaluate(problem.samples, values(problem, middle)), rel=1e-11
    )


def test_g_from_d_finds_the_tail_of_a_mirror():
    """From its slices alone it ends where G, and with it the whole lobe, is wrong."""
    mirror = synthetic.load("mirror-metal", 1)
    thin = Table(
        np.ascontiguousarray(mirror.values[:, 1::3, 1::3, 1::3]), HalfDifference(30, 30, 60)
    )
    samples = fold(channel_samples(thin, 0, Objective()))
    reached = {
        count: g_from_d.fit_samples(samples, chosen(SolverSettings()), starts=count)[1][0]
        for count in (1, 2)
    }
    assert reached[1].objective[-1] > 0.02
    assert reached[2].objective[-1] < 0.002
    assert reached[2].start == "slices-flat"
