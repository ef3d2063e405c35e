"""What one-product models share: sums, coefficients, updates, packing."""

from dataclasses import replace

import numpy as np
import pytest

from npfm.fitting.factors.problem import Sums, coefficients, quotient, updated_D, updated_F
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.models.naive import NaiveProblem


@pytest.fixture(scope="module")
def problem(table):
    """The naive model, whose K is its modulation itself."""
    return NaiveProblem(channel_samples(table, 1, Objective()))


@pytest.fixture
def state(problem):
    rng = np.random.default_rng(3)
    return problem.state(*(rng.uniform(0.2, 1, n) for n in problem.samples.grid.shape))


def model(state):
    """Values sample by sample."""
    f = state.factors
    return f.rho_d + f.rho_s * np.einsum("h,d,p->hdp", f.D, f.F, f.modulation)


def lines(seed):
    """A regression y = a + b x with weights, as arrays and as the sums over phi_d."""
    rng = np.random.default_rng(seed)
    w, k = rng.random((2, 4, 5, 6))
    product = rng.random((4, 5))
    return rng, w, k, product, product[..., None] * k


def summed(w, k, y):
    return Sums(
        w.sum(-1),
        (w * y).sum(-1),
        (w * k).sum(-1),
        (w * k * k).sum(-1),
        (w * y * k).sum(-1),
        float((w * y * y).sum()),
    )


@pytest.mark.parametrize("seed", range(5))
def test_coefficients_are_those_of_least_squares(seed):
    rng, w, k, product, x = lines(seed)
    y = 0.7 + 2.5 * x + 0.1 * rng.standard_normal(x.shape)
    root = np.sqrt(w).ravel()
    design = np.stack([root, root * x.ravel()], axis=1)
    expected = np.linalg.lstsq(design, root * y.ravel(), rcond=None)[0]
    assert expected.min() > 0
    np.testing.assert_allclose(coefficients(summed(w, k, y), product), expected, rtol=1e-11)


def test_coefficients_without_cancellation():
    """A lobe of 1e-6 over a diffuse part of 1: Cramer's rule as printed keeps few digits."""
    _, w, k, product, x = lines(1)
    y = 1 + 1e-6 * x
    rho_d, rho_s = coefficients(summed(w, k, y), product)
    assert rho_d == pytest.approx(1, rel=1e-9)
    assert rho_s == pytest.approx(1e-6, rel=1e-6)


def test_a_negative_rho_d_is_clamped_and_rho_s_solved_again():
    _, w, k, product, x = lines(2)
    y = x - 0.05  # the line that fits has a negative intercept
    rho_d, rho_s = coefficients(summed(w, k, y), product)
    root = np.sqrt(w).ravel()
    alone = np.linalg.lstsq(root[:, None] * x.reshape(-1, 1), root * y.ravel(), rcond=None)[0]
    assert rho_d == 0
    assert rho_s == pytest.approx(alone[0], rel=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_coefficients_never_lose_to_a_constant(seed):
    """Where the product falls as the measurement rises, no rho_s > 0 helps."""
    rng, w, k, product, x = lines(seed)
    y = 3 - x + 0.1 * rng.random(x.shape)
    sums = summed(w, k, y)
    constant = sums.objective(product, float((w * y).sum() / w.sum()), 0.0)
    assert sums.objective(product, *coefficients(sums, product)) <= constant + 1e-6 * sums.wrr


def test_where_the_product_does_not_vary_rho_s_takes_it_all():
    _, w, _, _, _ = lines(3)
    flat = np.full(w.shape, 0.5)
    y = np.full(w.shape, 3.0)
    assert coefficients(summed(w, flat, y), np.ones((4, 5))) == (0, pytest.approx(6, rel=1e-12))


def test_black_has_no_coefficients():
    _, w, k, product, _ = lines(4)
    assert coefficients(summed(w, k, np.zeros_like(k)), product) == (0, 0)


def test_the_objective_from_sums_is_the_direct_one(problem, state):
    assert problem.objective(state) == pytest.approx(
        evaluate(problem.samples, model(state)), rel=1e-12
    )
    other = state.with_factors(rho_d=0.3, rho_s=1.7)
    assert problem.objective(other) == pytest.approx(
        evaluate(problem.samples, model(other)), rel=1e-12
    )


def test_scaled_sums_are_the_sums_of_a_scaled_factor(problem, state):
    scaled, direct = state.sums.scaled(3.0), problem.sums(3.0 * state.factors.modulation)
    for name in ("wk", "wkk", "wrk"):
        np.testing.assert_allclose(getattr(scaled, name), getattr(direct, name), rtol=1e-12)


@pytest.mark.parametrize(("update", "axis"), [(updated_D, 0), (updated_F, 1)])
def test_an_update_is_least_squares_for_each_component(problem, state, update, axis):
    """Equation 14 by `lstsq` on the samples of each component, those at the clamp included."""
    clamp = 0.7  # so high that some components end there
    found = update(state, clamp).factors
    found = (found.D, found.F)[axis]
    f, samples = state.factors, problem.samples
    others = [f.D, f.F, f.modulation]
    others[axis] = np.ones_like(others[axis])
    y = np.moveaxis(f.rho_s * np.einsum("h,d,p->hdp", *others), axis, 0)
    w, r = (np.moveaxis(a, axis, 0) for a in (samples.weight, samples.value))
    expected, seen = np.zeros(found.size), np.zeros(found.size, bool)
    for k in range(found.size):
        root = np.sqrt(w[k]).ravel()
        seen[k] = root.any()
        expected[k] = np.linalg.lstsq(
            (root * y[k].ravel())[:, None], root * (r[k] - f.rho_d).ravel(), rcond=None
        )[0][0]
    expected = np.maximum(expected, clamp * expected[seen].max())
    assert (expected[seen] == clamp * expected[seen].max()).any()
    np.testing.assert_allclose(found[seen], expected[seen], rtol=1e-9)


@pytest.mark.parametrize("update", [updated_D, updated_F])
def test_an_update_does_not_raise_the_objective(problem, state, update):
    assert problem.objective(update(state, 0.0)) < problem.objective(state)


def test_a_quotient_fills_what_no_sample_touches():
    numerator, denominator = np.array([0.0, 2, 0, 4, 0]), np.array([0.0, 1, 0, 1, 0])
    found = quotient(numerator, denominator, np.ones(5), 0.0)
    assert found.tolist() == [2, 2, 3, 4, 4]


def test_a_quotient_is_clamped_below_its_largest():
    found = quotient(np.array([-3.0, 2, 4]), np.ones(3), np.ones(3), 0.125)
    assert found.tolist() == [0.5, 2, 4]


@pytest.mark.parametrize("numerator", [[-1.0, -2.0], [0.0, 0.0]])
def test_a_quotient_without_anything_positive_stays(numerator):
    before = np.array([0.3, 0.4])
    assert quotient(np.array(numerator), np.ones(2), before, 0.0) is before
    assert quotient(np.array(numerator), np.zeros(2), before, 0.0) is before


def test_a_state_is_normalised_filled_and_clamped(gappy):
    problem = NaiveProblem(channel_samples(gappy, 1, Objective()))
    assert np.flatnonzero(~problem.seen[0]).tolist() == [5, 6, 17]
    D = np.full(18, 4.0)
    D[0], D[~problem.seen[0]], D[7] = 1e-9, 99.0, 1.0
    found = problem.state(D, np.ones(18), np.ones(36)).factors.D
    assert found.max() == 1
    assert found[0] == problem.clamp
    # Interpolated from 1 and 1/4, or the nearest at the end, and not what stood there.
    np.testing.assert_allclose(found[[5, 6, 17]], [0.75, 0.5, 1])


def test_a_normalised_state_is_the_same_model(problem, state):
    f = state.factors
    larger = replace(f, D=3 * f.D, F=0.5 * f.F, modulation=7 * f.modulation)
    larger = replace(state, factors=larger, sums=problem.sums(larger.modulation))
    found = problem.normalised(larger)
    assert (found.factors.D.max(), found.factors.F.max(), found.factors.modulation.max()) == (
        1,
        1,
        1,
    )
    np.testing.assert_allclose(model(found), model(larger), rtol=1e-13)
    assert problem.objective(found) == pytest.approx(problem.objective(larger), rel=1e-12)


def test_packing_there_and_back(problem, state):
    back = problem.unpack(problem.pack(state))
    for name in ("D", "F", "modulation"):
        np.testing.assert_allclose(
            getattr(back.factors, name), getattr(state.factors, name), rtol=1e-13
        )
    assert problem.objective(back) == pytest.approx(problem.objective(state), rel=1e-12)


def test_tops_point_at_the_largest_of_each_factor(problem, state):
    packed = problem.pack(state)
    tops = problem.tops(packed)
    assert tops.size == packed.size
    assert (tops[:18] == np.argmax(packed[:18])).all()
    assert (tops[18:36] == 18 + np.argmax(packed[18:36])).all()
    assert (tops[36:] == 36 + np.argmax(packed[36:])).all()


def test_the_way_between_states(problem, state):
    after = updated_F(updated_D(state, 1e-6), 1e-6).with_coefficients()
    assert problem.objective(problem.between(state, after, 0.0)) == pytest.approx(
        problem.objective(state), rel=1e-12
    )
    assert problem.objective(problem.between(state, after, 1.0)) == pytest.approx(
        problem.objective(after), rel=1e-10
    )
    middle = problem.between(state, after, 0.25)
    np.testing.assert_allclose(
        middle.factors.D, 0.75 * state.factors.D + 0.25 * after.factors.D, rtol=1e-14
    )
    along = problem.along(state, after)
    assert along(0.25) == pytest.approx(evaluate(problem.samples, model(middle)), rel=1e-11)
