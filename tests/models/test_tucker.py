"""The tensor behind tucker-20: its nodes, its decomposition, its size, and how good it is."""

import numpy as np
import pytest

from npfm.datasets import neural
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import bivariate, naive, tucker
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import Table

SOLVE = chosen(SolverSettings(max_iterations=20))


def relative_objective(table, fitted, channel):
    samples = channel_samples(table, channel, Objective())
    return evaluate(samples, fitted.values[channel] / samples.scale) / samples.energy


def test_the_size_is_that_of_the_original():
    """77 KB a material in double precision (Bagher et al. 2016, section 2)."""
    assert round(8 * tucker.parameter_count(MERL), -3) == 77_000


@pytest.mark.parametrize("grid", [HalfDifference(18, 18, 36), HalfDifference(6, 10, 12)])
def test_nodes_interpolate_what_is_linear_in_the_angles(grid):
    """By trigonometry on the vectors themselves, cell by cell."""
    light, view = directions(grid.theta_h[:, None, None], grid.theta_d[:, None], grid.phi_d)
    half_vector = light + view
    theta_o = np.arctan2(np.hypot(view[..., 0], view[..., 1]), view[..., 2])
    crossed = half_vector[..., 0] * view[..., 1] - half_vector[..., 1] * view[..., 0]
    along = half_vector[..., 0] * view[..., 0] + half_vector[..., 1] * view[..., 1]
    azimuth = np.abs(np.arctan2(crossed, along))
    elevations = np.linspace(0, np.pi / 2, tucker.THETA_O_NODES)[:, None]
    azimuths = np.linspace(0, np.pi, tucker.PHI_H_NODES)
    linear = np.tile((1 + 2 * elevations + 3 * azimuths).ravel(), (grid.theta_h_bins, 1))
    found, above = tucker.nodes(grid).values(linear), grid.above_horizon
    np.testing.assert_allclose(found[above], (1 + 2 * theta_o + 3 * azimuth)[above], atol=1e-7)
    assert (tucker.nodes(grid).share >= 0).all()
    np.testing.assert_allclose(tucker.nodes(grid).share.sum(0), 1, rtol=1e-12)


def test_the_nodes_are_the_least_squares_solution(table):
    """Against dense equations, where the smoothness is a sum over pairs of neighbours."""
    samples = channel_samples(table, 0, Objective())
    logarithm, row = np.log1p(samples.value), 4
    cells = samples.weight[row] > 0
    shape = tucker.THETA_O_NODES, tucker.PHI_H_NODES
    numbers = np.arange(np.prod(shape)).reshape(shape)
    pairs = [*zip(numbers[1:].flat, numbers[:-1].flat, strict=True)]
    pairs += zip(numbers[:, 1:].flat, numbers[:, :-1].flat, strict=True)
    steps = np.zeros((len(pairs), numbers.size))
    for k, (one, other) in enumerate(pairs):
        steps[k, one], steps[k, other] = np.sqrt(tucker.SMOOTHNESS), -np.sqrt(tucker.SMOOTHNESS)
    matrix = tucker.nodes(table.grid).matrix(row, cells).toarray()
    right = np.concatenate([logarithm[row, cells], np.zeros(len(pairs))])
    expected = np.linalg.lstsq(np.vstack([matrix, steps]), right, rcond=None)[0]
    np.testing.assert_allclose(tucker.resampled(samples, logarithm)[row], expected, atol=1e-8)


def test_bins_without_a_sample_are_those_of_the_nearest(gappy):
    samples = channel_samples(gappy, 0, Objective())
    tensor = tucker.resampled(samples, np.log1p(samples.value))
    assert np.array_equal(tensor[[5, 6, 17]], tensor[[4, 7, 16]])


def separable(terms, shape=(8, 5, 7, 1)):
    """A tensor that is a sum of so many products with orthogonal factors, each half the last."""
    rng = np.random.default_rng(3)
    factors = [np.linalg.qr(rng.standard_normal((n, n)))[0] for n in shape[:3]]
    weights = 0.5 ** np.arange(terms)
    a, b, c = (factor[:, :terms] for factor in factors)
    return np.einsum("r,ir,jr,kr->ijk", weights, a, b, c)[..., None]


def summed(factors):
    return np.einsum("ir,jr,kr,lr->ijkl", *factors)


@pytest.mark.parametrize("terms", [0, 1, 3])
def test_orthogonal_products_are_found_one_by_one(terms):
    tensor = separable(terms)
    factors = tucker.products(tensor, 0)
    np.testing.assert_allclose(summed(factors), tensor, atol=1e-6)
    found = [np.einsum("i,j,k,l->ijkl", *(f[:, r] for f in factors)) for r in range(4)]
    sizes = np.linalg.norm(np.reshape(found, (4, -1)), axis=1)
    expected = np.where(np.arange(4) < terms, 0.5 ** np.arange(4), 0)
    np.testing.assert_allclose(sizes, expected, atol=1e-4)


def test_each_product_leaves_less_and_sweeps_leave_less_again():
    tensor = np.random.default_rng(5).standard_normal((9, 6, 8, 1))
    factors = tucker.products(tensor, 0)
    left = [
        np.linalg.norm(tensor - summed([f[:, :count] for f in factors]))
        for count in range(tucker.TERMS + 1)
    ]
    assert (np.diff(left) < 0).all()
    joint = np.linalg.norm(tensor - summed(tucker.products(tensor, 20)))
    assert joint < 0.9 * left[-1]


def test_noise_is_not_fitted(table):
    """The table has 3 % of noise, half of which the 18 x 45 x 25 nodes could not follow."""
    fitted = tucker.tabulate(tucker.fit(table, Objective(), None, 1))
    for channel in range(3):
        assert relative_objective(table, fitted, channel) < 1e-3


def test_nothing_below_the_horizon_or_missing_is_looked_at(table):
    samples = channel_samples(table, 0, Objective())
    logarithm = np.log1p(samples.value)
    spoilt = np.where(samples.weight > 0, logarithm, 1e9)
    assert np.array_equal(tucker.resampled(samples, logarithm), tucker.resampled(samples, spoilt))


@pytest.mark.parametrize(("name", "better"), [("alum-bronze", bivariate), ("nylon", naive)])
def test_it_is_a_worthy_opponent(data, name, better):
    """More products than the models that it is compared with have: so it is to be nearer."""
    table = neural.load(data / "merl_nbrdf.zip", name)
    thinned = HalfDifference(90, 30, 60)
    table = Table(table.values[:, :, 1::3, 1::3], thinned)
    fits = [model.fit(table, Objective(), SOLVE, 1) for model in (tucker, better)]
    ours, theirs = (
        np.mean([relative_objective(table, model.tabulate(fit), c) for c in range(3)])
        for model, fit in zip((tucker, better), fits, strict=True)
    )
    assert ours < theirs
