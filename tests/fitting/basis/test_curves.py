"""A basis of log-factors against an eigenproblem, and what it must leave as it is."""

import numpy as np
import pytest

from npfm.fitting.basis.curves import basis_of, coefficients, log_factors, reconstruct

RNG = np.random.default_rng(4)
LOGS, WEIGHTS = RNG.standard_normal((12, 9)), RNG.uniform(0.1, 1, 9)


def distances(found, logs, weights):
    """Weighted mean square of what is left of each row, the best scale taken out."""
    share = weights / weights.sum()
    rest = np.log(found) - logs
    rest -= rest @ share[:, None]
    return rest**2 @ share


def rebuilt(count, logs=LOGS, weights=WEIGHTS):
    basis = basis_of(logs, weights, count)
    return reconstruct(basis, coefficients(basis, logs))


def test_what_is_left_is_what_an_eigenproblem_leaves():
    share = WEIGHTS / WEIGHTS.sum()
    level = LOGS - LOGS @ share[:, None]
    deviation = (level - level.mean(0)) * np.sqrt(share)
    values = np.linalg.eigvalsh(deviation.T @ deviation)[::-1]
    for count in range(9):
        left = distances(rebuilt(count), LOGS, WEIGHTS).sum()
        assert left == pytest.approx(values[count:].sum(), rel=1e-9, abs=1e-12)


def test_factors_of_few_curves_come_back_exactly_and_their_scale_does_not_matter():
    made = RNG.standard_normal((12, 3)) @ LOGS[:3] + RNG.standard_normal((12, 1))
    for logs in (made, made + 5):
        assert distances(rebuilt(3, logs), logs, WEIGHTS).max() < 1e-12
    assert rebuilt(2).max(1) == pytest.approx(1)


def test_curves_are_orthonormal_and_a_small_basis_begins_a_large_one():
    large = basis_of(LOGS, WEIGHTS, 6)
    assert (large.curves * large.weights) @ large.curves.T == pytest.approx(np.eye(6))
    small = basis_of(LOGS, WEIGHTS, 2)
    assert large.count == 6 and small.count == 2
    assert large.first(2).curves == pytest.approx(small.curves)


def test_no_more_curves_than_rows_allow():
    assert basis_of(LOGS[:3], WEIGHTS, 20).count == 2
    assert distances(rebuilt(20, LOGS[:3]), LOGS[:3], WEIGHTS).max() < 1e-12


def test_what_is_not_seen_does_not_count():
    weights = np.where(np.arange(9) < 6, 1.0, 0.0)
    noise = np.where(weights > 0, 0, 3 * RNG.standard_normal(LOGS.shape))
    for count in (1, 3):
        plain, noisy = (rebuilt(count, LOGS + extra, weights) for extra in (0, noise))
        assert np.diff(np.log(plain[:, :6])) == pytest.approx(
            np.diff(np.log(noisy[:, :6])), abs=1e-3
        )


def test_coefficients_by_weights_of_their_own_are_the_nearest_by_these():
    basis, own = basis_of(LOGS, WEIGHTS, 3), RNG.uniform(0.1, 1, LOGS.shape)
    best = coefficients(basis, LOGS, own)
    for row, (logs, weights, found) in enumerate(zip(LOGS, own, best, strict=True)):
        least = distances(reconstruct(basis, found), logs, weights)
        moved = found + 0.01 * np.vstack([np.eye(3), -np.eye(3)])
        assert (distances(reconstruct(basis, moved), logs, weights) > least).all(), row


def test_logarithms_have_a_floor():
    logs = log_factors([[0, 2, 4], [0, 0, 0]], 1e-3)
    assert np.exp(logs) == pytest.approx(np.array([[1e-3, 0.5, 1], [1, 1, 1]]))


@pytest.mark.parametrize(
    ("logs", "weights", "count"),
    [(LOGS[:0], WEIGHTS, 1), (LOGS, WEIGHTS[:3], 1), (LOGS, WEIGHTS, -1), (LOGS, 0 * WEIGHTS, 1)],
)
def test_what_is_no_basis_is_refused(logs, weights, count):
    with pytest.raises(ValueError):
        basis_of(logs, weights, count)
