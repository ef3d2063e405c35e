"""The library's factorisation against the appendix of Lawrence et al. 2004, and what is exact."""

import numpy as np
import pytest

from npfm.fitting.factorisation.nmf import factorised


def lobes(rows=60, columns=24):
    """Values with a moving peak, which no few terms are."""
    x, y = np.linspace(0, 1, rows)[:, None], np.linspace(0, 1, columns)
    return 5 * np.exp(-((x - 0.3 * y) ** 2) / 0.01) + 0.2 + x * y


def divergence(Y, model):
    """Generalised Kullback-Leibler divergence of Lawrence et al. 2004, equation 17."""
    seen = Y > 0
    logarithm = np.log(Y[seen] / np.maximum(model[seen], np.finfo(float).tiny))
    return float(np.sum(Y[seen] * logarithm) - Y.sum() + model.sum())


def appendix(Y, terms, updates, seed):
    """Equations 14 to 16, entry by entry as they stand there."""
    rng = np.random.default_rng(seed)
    G, F = rng.random((len(Y), terms)), rng.random((terms, Y.shape[1]))
    G /= G.sum(axis=0)
    for _ in range(updates):
        F = F * (G.T @ (Y / (G @ F)))
        G = G * ((Y / (G @ F)) @ F.T)
        G /= G.sum(axis=0)
    return G @ F


@pytest.mark.parametrize("terms", [1, 2, 3])
def test_it_diverges_no_more_than_the_updates_of_the_appendix(terms):
    Y = lobes()
    found = factorised(Y, terms)
    best = min(divergence(Y, appendix(Y, terms, 2000, seed)) for seed in range(3))
    assert divergence(Y, found.left @ found.right) <= 1.01 * best
    assert found.converged


def test_a_product_is_found_again():
    rng = np.random.default_rng(2)
    Y = rng.random((40, 2)) @ rng.random((2, 30))
    found = factorised(Y, 2)
    np.testing.assert_allclose(found.left @ found.right, Y, rtol=0.02)


def test_one_term_is_the_least_divergence():
    Y = lobes()
    found = factorised(Y, 1)
    product = found.left @ found.right
    rng = np.random.default_rng(4)
    for _ in range(20):
        left, right = (1 + 0.05 * rng.standard_normal(x.shape) for x in (found.left, found.right))
        assert divergence(Y, (found.left * left) @ (found.right * right)) > divergence(Y, product)


@pytest.mark.parametrize("terms", [1, 2, 4])
def test_rows_add_up_to_one_and_sums_are_kept(terms):
    found = factorised(lobes(), terms)
    np.testing.assert_allclose(found.right.sum(axis=1), 1)
    assert (found.left @ found.right).sum() == pytest.approx(lobes().sum(), rel=1e-4)


def test_more_terms_than_a_matrix_has_rows_are_empty():
    found = factorised(lobes(3, 10), 5)
    assert found.left.shape == (3, 5) and found.right.shape == (5, 10)
    assert (found.left[:, 3:] == 0).all() and (found.right[3:] == 0).all()
    np.testing.assert_allclose(found.left @ found.right, lobes(3, 10), rtol=0.05)


def test_nothing_stays_nothing():
    found = factorised(np.zeros((5, 4)), 2)
    assert found.converged and (found.left @ found.right == 0).all()


def test_the_same_seed_gives_the_same_factors():
    one, two = factorised(lobes(), 3, 7), factorised(lobes(), 3, 7)
    assert np.array_equal(one.left, two.left) and np.array_equal(one.right, two.right)


def test_the_divergence_of_equation_17():
    Y, model = np.array([[2.0, 0.0]]), np.array([[1.0, 0.5]])
    assert divergence(Y, model) == pytest.approx(2 * np.log(2) - 2 + 1 + 0.5)
    assert divergence(model, model) == 0
