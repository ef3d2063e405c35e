"""Where digits can be lost, against arithmetic with 50 digits."""

import mpmath
import numpy as np
import pytest

from npfm.fitting.factors.problem import LEAST_SHARE, SINGULAR, Sums, coefficients
from npfm.fitting.objective import compressive_weight, weighted_median

mpmath.mp.dps = 50
SHAPE = (6, 5)


def system(spread, slope, seed):
    """Sums of K = 1 + `spread` noise, r = 1 + `slope` (K - 1) + noise, and the samples of them."""
    rng = np.random.default_rng(seed)
    w, noise, other = rng.uniform(0.1, 2, SHAPE), *rng.uniform(-1, 1, (2, *SHAPE))
    x = 1 + spread * noise
    r = 1 + slope * (x - 1) + 1e-3 * spread * other
    sums = Sums(w, w * r, w * x, w * x * x, w * r * x, float(np.sum(w * r * r)))
    return sums, w, x, r


def objective(w, x, r, rho_d, rho_s):
    """Of exact samples and coefficients, in 50 digits."""
    cells = zip(*(map(mpmath.mpf, a.ravel()) for a in (w, x, r)), strict=True)
    return mpmath.fsum(wi * (rho_d + rho_s * xi - ri) ** 2 for wi, xi, ri in cells)


def best(w, x, r):
    """Least squares with rho_d and rho_s not negative, in 50 digits."""
    cells = [tuple(map(mpmath.mpf, c)) for c in zip(w.ravel(), x.ravel(), r.ravel(), strict=True)]
    one, sx, sxx, sr, sxr = (
        mpmath.fsum(f(*c) for c in cells)
        for f in (
            lambda w, x, r: w,
            lambda w, x, r: w * x,
            lambda w, x, r: w * x * x,
            lambda w, x, r: w * r,
            lambda w, x, r: w * x * r,
        )
    )
    determinant = one * sxx - sx * sx
    pairs = [(sr / one, mpmath.mpf(0)), (mpmath.mpf(0), sxr / sxx)]
    if determinant > 0:
        pairs.append(((sr * sxx - sx * sxr) / determinant, (one * sxr - sx * sr) / determinant))
    allowed = [pair for pair in pairs if min(pair) >= 0]
    return min(allowed, key=lambda pair: objective(w, x, r, *pair))


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("slope", [0.3, 0.9, 1.5, -0.5])
@pytest.mark.parametrize("spread", [1.0, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 1e-12, 0.0])
def test_the_coefficients_lose_nothing_near_singularity(spread, slope, seed):
    """The objective is the least there is, to what rounding and the least rho_s leave of it."""
    sums, w, x, r = system(spread, slope, seed)
    rho_d, rho_s = coefficients(sums, np.ones(SHAPE))
    assert rho_d >= 0
    assert rho_s >= 0
    reached, least = objective(w, x, r, rho_d, rho_s), objective(w, x, r, *best(w, x, r))
    energy = objective(w, x, r, 0, 0)
    left = SINGULAR + (3 * LEAST_SHARE * spread**2 if slope < 0 else 0)
    assert reached - least <= energy * left


@pytest.mark.parametrize("spread", [1.0, 1e-2, 1e-3, 1e-4])
def test_the_coefficients_are_as_exact_as_their_condition_allows(spread):
    sums, w, x, r = system(spread, 0.5, 7)
    rho_d, rho_s = coefficients(sums, np.ones(SHAPE))
    expected = best(w, x, r)
    for found, value in zip((rho_d, rho_s), expected, strict=True):
        assert abs(found - value) <= 1e-14 / spread**2 * value


def test_no_variation_at_all_gives_everything_to_rho_s():
    """Equation 18, and nothing where there is no product."""
    sums, w, _, r = system(0.0, 0.0, 1)
    mean = mpmath.fsum(map(mpmath.mpf, (w * r).ravel())) / mpmath.fsum(map(mpmath.mpf, w.ravel()))
    rho_d, rho_s = coefficients(sums, np.ones(SHAPE))
    assert rho_d == 0
    assert abs(rho_s - mean) <= 1e-15 * mean
    rho_d, rho_s = coefficients(sums, np.zeros(SHAPE))
    assert rho_s == 0
    assert abs(rho_d - mean) <= 1e-15 * mean


@pytest.mark.parametrize(
    "x", [5e-324, 1e-300, 1e-17, 1e-8, 1e-3, 0.5, 1.0, 1 + 2**-52, 2.0, 1e3, 1e12, 1e100, 1e200]
)
def test_the_compressive_weight_has_all_digits(x):
    exponent = mpmath.log(2) * mpmath.mpf(x)
    expected = (-mpmath.expm1(-exponent) / exponent) ** mpmath.mpf(1.4)
    assert abs(float(compressive_weight(x)) - expected) <= 1e-15 * expected


def test_the_compressive_weight_at_its_ends():
    assert compressive_weight(0.0) == 1
    at_median = (1 / (2 * mpmath.log(2))) ** mpmath.mpf(1.4)
    assert float(compressive_weight(1.0)) == pytest.approx(float(at_median), rel=1e-15)
    assert compressive_weight(1e300) == 0  # 1e-420


def exact_median(value, weight):
    """Smallest value at which half of the weight is reached, in 50 digits."""
    order = np.argsort(value, kind="stable")
    half = mpmath.fsum(map(mpmath.mpf, weight)) / 2
    reached = mpmath.mpf(0)
    for k in order:
        reached += mpmath.mpf(weight[k])
        if reached >= half:
            return value[k]
    raise AssertionError


@pytest.mark.parametrize("seed", range(20))
def test_the_weighted_median_with_ties(seed):
    """Values that repeat, and weights whose sums double precision holds, so that half is half."""
    rng = np.random.default_rng(seed)
    value = rng.integers(0, 4, 24) / 4
    weight = rng.integers(0, 5, 24) * 2.0 ** rng.integers(-20, 20)
    assert weighted_median(value, weight) == exact_median(value[weight > 0], weight[weight > 0])


@pytest.mark.parametrize("seed", range(20))
def test_rounding_moves_the_weighted_median_by_no_more_than_itself(seed):
    """Weights that are not sums of powers of two: half is reached to 1e-15 of the whole."""
    rng = np.random.default_rng(seed)
    value, weight = rng.integers(0, 6, 50) / 3, 0.1 * rng.integers(1, 9, 50)
    median = weighted_median(value, weight)
    total = mpmath.fsum(map(mpmath.mpf, weight))
    below = mpmath.fsum(map(mpmath.mpf, weight[value < median]))
    up_to = mpmath.fsum(map(mpmath.mpf, weight[value <= median]))
    assert up_to >= total / 2 * (1 - mpmath.mpf(10) ** -15)
    assert below < total / 2 * (1 + mpmath.mpf(10) ** -15)


def test_a_tie_at_half_takes_the_smaller_value():
    assert weighted_median(np.array([2.0, 1.0]), np.array([1.0, 1.0])) == 1
    assert weighted_median(np.array([3.0, 1.0, 1.0, 3.0]), np.array([0.1, 0.1, 0.1, 0.1])) == 1
