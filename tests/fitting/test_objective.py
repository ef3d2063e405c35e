"""The objective: weights, the samples that count, folding."""

from decimal import Decimal, localcontext

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting.objective import (
    COMPRESSION_ALPHA,
    COMPRESSION_POWER,
    Objective,
    channel_samples,
    compressed,
    compressive_weight,
    counted,
    degeneracy,
    evaluate,
    fold,
    importance,
    solid_angles,
    volume_form,
    weighted_median,
)
from npfm.reflectance.angles import directions
from npfm.reflectance.grids import local_cells
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import Table

SMALL = HalfDifference(10, 12, 16)


def measured(grid, seed=0, missing=0.1):
    """A table of values over four orders of magnitude, with gaps."""
    rng = np.random.default_rng(seed)
    values = np.exp(rng.uniform(-5, 5, (3, *grid.shape)))
    present = grid.above_horizon & (rng.random(grid.shape) > missing)
    return Table(np.where(present, values, -1), grid)


def pair(angles):
    """Light and view as one vector of six components."""
    return np.concatenate(directions(*angles))


def test_volume_form_is_that_of_a_numerical_jacobian():
    """Square root of the determinant of the metric tensor of (h', d, p) -> (i, o)."""
    form, step = volume_form(SMALL), 1e-6
    rng = np.random.default_rng(1)
    for h, d, p in zip(*(rng.integers(0, n, 40) for n in SMALL.shape), strict=True):
        root = np.sqrt(SMALL.theta_h[h])  # theta_h' of equation 6
        at = np.array([root, SMALL.theta_d[d], SMALL.phi_d[p]])
        columns = []
        for axis in np.eye(3) * step:
            ahead, behind = at + axis, at - axis
            columns.append(pair((ahead[0] ** 2, *ahead[1:])) - pair((behind[0] ** 2, *behind[1:])))
        jacobian = np.stack(columns, axis=1) / (2 * step)
        expected = np.sqrt(np.linalg.det(jacobian.T @ jacobian))
        assert form[h, d, p] == pytest.approx(expected, rel=1e-7)


def test_volume_form_is_equation_9():
    """By its letters, at one cell: h = 13, d = 40, p = 100 of MERL's grid."""
    d, p = np.deg2rad(40.5), np.deg2rad(100.5)
    equation_9 = np.sqrt(8 * np.sin(d) ** 2 * (np.cos(d) ** 2 + np.sin(d) ** 2 * np.cos(p) ** 2))
    width = 2 * np.sqrt((13.5 / 90) ** 2 * np.pi / 2)  # d(theta_h) / d(theta_h')
    assert volume_form(MERL)[13, 40, 100] == pytest.approx(equation_9 * width, rel=1e-13)


def test_importance_is_the_product_of_the_cosines():
    centres = np.meshgrid(SMALL.theta_h, SMALL.theta_d, SMALL.phi_d, indexing="ij")
    light, view = directions(*centres)
    above = (light[..., 2] > 0) & (view[..., 2] > 0)
    expected = np.where(above, light[..., 2] * view[..., 2], 0)
    np.testing.assert_allclose(importance(SMALL), expected, atol=1e-15)


@pytest.mark.parametrize("x", [1e-300, 1e-17, 1e-9, 0.001, 1.0, 2.5, 40.0, 1e8, 1e200])
def test_compressive_weight_to_50_digits(x):
    with localcontext(prec=400):  # 1 - exp(-x) of x = 1e-300 loses 300 of them
        steep = Decimal(2).ln() * Decimal(x)
        expected = ((1 - (-steep).exp()) / steep) ** Decimal("1.4")
    assert compressive_weight(x) == pytest.approx(float(expected), rel=1e-14)


def test_compressive_weight_at_its_ends():
    assert compressive_weight(0.0) == 1
    assert compressive_weight(1.0) == pytest.approx((0.5 / np.log(2)) ** 1.4, rel=1e-15)
    falling = compressive_weight(np.geomspace(1e-3, 1e10, 200))
    assert (np.diff(falling) < 0).all()


def slow_median(value, weight):
    """Add up the weights in the order of the values, one sample after the other."""
    order = sorted(range(len(value)), key=lambda k: value[k])
    total, reached = sum(weight), 0.0
    for k in order:
        reached += weight[k]
        if weight[k] > 0 and reached >= total / 2:
            return value[k]
    raise AssertionError


@pytest.mark.parametrize("seed", range(20))
def test_weighted_median_with_ties_against_a_loop(seed):
    rng = np.random.default_rng(seed)
    value = rng.integers(0, 6, 31).astype(float)
    weight = rng.integers(0, 4, 31).astype(float)
    assert weighted_median(value, weight) == slow_median(value.tolist(), weight.tolist())


def test_weighted_median_of_few():
    assert weighted_median(np.array([3.0]), np.array([0.1])) == 3
    assert weighted_median(np.array([1.0, 9.0]), np.array([1.0, 3.0])) == 9
    assert weighted_median(np.array([1.0, 9.0]), np.array([0.0, 1e-9])) == 9
    with pytest.raises(ValueError, match="no samples"):
        weighted_median(np.ones(3), np.zeros(3))


@pytest.mark.parametrize("limit", [89.0, 60.0, 90.0])
def test_angular_limit(limit):
    centres = np.meshgrid(MERL.theta_h[::9], MERL.theta_d, MERL.phi_d[::7], indexing="ij")
    thinned = counted(MERL, limit)[::9, :, ::7]
    light, view = directions(*centres)
    elevation = np.rad2deg(np.arccos(np.minimum(light[..., 2], view[..., 2])))
    clear = np.abs(elevation - limit) > 1e-9
    assert (thinned == (elevation <= limit))[clear].all()


def test_samples_by_hand():
    """Equation 8 sample by sample, in units of the weighted median."""
    table = measured(SMALL)
    samples = channel_samples(table, 1, Objective())
    cos_i, cos_o = SMALL.cosines
    counts = (table.values[1] >= 0) & (np.minimum(cos_i, cos_o) >= np.cos(np.deg2rad(89)))
    geometric = volume_form(SMALL) * cos_i * cos_o
    scale = slow_median(table.values[1][counts].tolist(), geometric[counts].tolist())
    assert samples.scale == scale
    assert samples.floor == 0
    x = table.values[1][counts] / scale
    compressive = ((1 - np.exp(-np.log(2) * x)) / (np.log(2) * x)) ** 1.4
    np.testing.assert_allclose(samples.weight[counts], geometric[counts] * compressive, rtol=1e-12)
    np.testing.assert_allclose(samples.value[counts], x, rtol=1e-14)
    assert not samples.weight[~counts].any()
    assert not samples.value[~counts].any()


def test_the_compressive_weight_can_be_left_out():
    table = measured(SMALL)
    plain = channel_samples(table, 0, Objective(compressive=False))
    counts = plain.weight > 0
    assert (plain.weight[counts] == (volume_form(SMALL) * importance(SMALL))[counts]).all()
    weighted = channel_samples(table, 0, Objective())
    assert weighted.scale == plain.scale
    assert (weighted.weight[counts] < plain.weight[counts]).all()


def test_cells_may_count_by_their_solid_angles():
    table = measured(SMALL)
    samples = channel_samples(table, 0, Objective(compressive=False, cells="solid-angle"))
    counts = samples.weight > 0
    assert (counts == (channel_samples(table, 0, Objective()).weight > 0)).all()
    expected = (solid_angles(SMALL) * importance(SMALL))[counts]
    np.testing.assert_allclose(samples.weight[counts], expected, rtol=1e-14)
    with pytest.raises(NpfmError, match="unknown weight of cells 'solid'"):
        Objective(cells="solid")


def test_solid_angles_by_pairs_of_directions():
    """Random pairs fall into cells as often as their solid angles say."""
    rng = np.random.default_rng(2)
    grid = HalfDifference(4, 4, 4)
    z = rng.random((2, 400_000))
    phi = rng.uniform(0, 2 * np.pi, z.shape)
    sin = np.sqrt(1 - z**2)
    light, view = np.stack([sin * np.cos(phi), sin * np.sin(phi), z], axis=-1)
    cells, _ = local_cells(grid, light, view)
    share = np.bincount(cells, minlength=grid.size).reshape(grid.shape) / z.shape[1]
    # Cells that the horizon does not cut: all their pairs are among those drawn.
    whole = np.zeros(grid.shape, dtype=bool)
    whole[:2, :2] = True
    fine = HalfDifference(4 * 40, 4 * 40, 4)
    expected = solid_angles(fine).reshape(4, 40, 4, 40, 4).mean(axis=(1, 3))
    expected = expected / expected[whole].sum() * share[whole].sum()
    shares, wanted = (np.where(whole, x, 0).sum(axis=-1)[:2, :2] for x in (share, expected))
    np.testing.assert_allclose(shares, wanted, rtol=0.1)


def test_energy_is_the_objective_of_nothing():
    samples = channel_samples(measured(SMALL), 0, Objective())
    nothing = np.zeros(SMALL.shape)
    assert samples.energy == pytest.approx(evaluate(samples, nothing), rel=1e-14)
    folded = fold(samples)
    assert folded.energy == pytest.approx(samples.energy, rel=1e-13)


def test_black_has_the_unit_1_per_sr():
    """The weighted median of black is 0 and no unit to divide by."""
    values = np.where(SMALL.above_horizon, 0.0, -1.0) * np.ones((3, 1, 1, 1))
    samples = channel_samples(Table(values, SMALL), 2, Objective())
    assert samples.scale == 1
    assert samples.energy == 0
    assert np.isfinite(samples.weight).all()


@pytest.mark.parametrize("dark", [0.0, 1e-300, 1e-13])
def test_where_most_is_black_the_unit_is_that_of_the_rest(dark):
    """One cell in eight is not black: the unit is their median, and grows with the table."""
    bright = np.arange(SMALL.size).reshape(SMALL.shape) % 8 == 0
    table = measured(SMALL, missing=0)
    values = np.where(bright | ~SMALL.above_horizon, table.values, dark)
    samples = channel_samples(Table(values, SMALL), 0, Objective())
    rest = np.where(bright, table.values, -1)
    assert samples.scale == channel_samples(Table(rest, SMALL), 0, Objective()).scale
    brighter = np.where(values >= 0, 2.0**40 * values, -1)
    other = channel_samples(Table(brighter, SMALL), 0, Objective())
    assert other.scale == 2.0**40 * samples.scale
    assert (other.weight == samples.weight).all()


@pytest.mark.parametrize("compressive", [True, False])
def test_no_table_overflows(compressive):
    """From 1e-300 to 1e300, which no square in double precision holds."""
    rng = np.random.default_rng(3)
    values = 10.0 ** rng.uniform(-300, 300, (3, *SMALL.shape))
    folded = fold(channel_samples(Table(values, SMALL), 0, Objective(compressive)))
    assert np.isfinite([folded.floor, folded.energy]).all()
    assert 0 < folded.floor < folded.energy


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_is_refused(wrong):
    table = measured(SMALL)
    table.values[1, 3, 4, 5] = wrong
    with pytest.raises(NpfmError, match="green channel has entries that are NaN or infinite"):
        channel_samples(table, 1, Objective())
    assert channel_samples(table, 0, Objective()).energy > 0


@pytest.mark.parametrize("angle", [0, -5, 90, np.nan, np.inf])
def test_an_angle_that_leaves_nothing_is_refused(angle):
    with pytest.raises(NpfmError, match="largest angle"):
        Objective(max_angle=angle)


def only(where, values=None):
    """Samples where a condition on the indices of a cell holds."""
    cells = np.broadcast_to(where(*np.indices(SMALL.shape)), (3, *SMALL.shape))
    values = measured(SMALL, missing=0).values if values is None else values
    table = Table(np.where(cells, values, -1), SMALL)
    return fold(channel_samples(table, 0, Objective()))


def test_degenerate_samples_are_told_from_others():
    one = np.ones((3, *SMALL.shape))
    assert degeneracy(only(lambda h, d, p: (h == 3) & (d == 4) & (p == 5))) == "one sample"
    assert degeneracy(only(lambda h, d, p: h >= 0, 0 * one)) == "every sample is 0"
    assert degeneracy(only(lambda h, d, p: h >= 0, 0.3 * one)) == "all samples are equal"
    assert degeneracy(only(lambda h, d, p: h == 3)) == "samples in one bin of theta_h only"
    assert degeneracy(only(lambda h, d, p: d == 3)) == "samples in one bin of theta_d only"
    assert degeneracy(only(lambda h, d, p: (h == 3) | (d == 3))) is None
    # What only differs between a sample and its mirror image is not all equal.
    mirrored = 1.0 + (SMALL.cosines[0] > SMALL.cosines[1]) * one
    assert degeneracy(only(lambda h, d, p: h >= 0, mirrored)) is None


def test_scaling_the_table_scales_the_unit_only():
    table = measured(SMALL)
    larger = Table(np.where(table.valid, 8 * table.values, -1), SMALL)
    one, other = (channel_samples(t, 0, Objective()) for t in (table, larger))
    assert other.scale == 8 * one.scale
    assert (other.weight == one.weight).all()
    assert (other.value == one.value).all()


@pytest.mark.parametrize("compressive", [True, False])
@pytest.mark.parametrize("missing", [0.0, 0.3])
def test_folding_keeps_the_objective_of_a_reciprocal_model(compressive, missing):
    samples = channel_samples(measured(SMALL, 4, missing), 0, Objective(compressive))
    folded = fold(samples)
    half = np.random.default_rng(7).uniform(0, 3, (*SMALL.shape[:2], SMALL.phi_d_bins // 2))
    whole = np.concatenate([half, half[..., ::-1]], axis=-1)
    expected = evaluate(samples, whole)
    assert evaluate(folded, half) == pytest.approx(expected, rel=1e-12)


def test_the_floor_is_what_the_best_reciprocal_model_leaves():
    """The best value of each pair by itself is its weighted mean; found here by search."""
    samples = channel_samples(measured(SMALL, 4), 0, Objective())
    w1, r1 = samples.weight, samples.value
    w2, r2 = w1[..., ::-1], r1[..., ::-1]
    low, high = np.minimum(r1, r2), np.maximum(r1, r2)
    for _ in range(200):  # ternary search, all pairs at once
        a, b = low + (high - low) / 3, high - (high - low) / 3
        left = w1 * (a - r1) ** 2 + w2 * (a - r2) ** 2
        right = w1 * (b - r1) ** 2 + w2 * (b - r2) ** 2
        low, high = np.where(left > right, a, low), np.where(left > right, high, b)
    best = evaluate(samples, (low + high) / 2)
    assert best > 0
    assert fold(samples).floor == pytest.approx(best, rel=1e-10)


def test_a_pair_with_one_missing_sample_leaves_nothing():
    values = np.full((3, *SMALL.shape), -1.0)
    values[:, 3, 4, 5] = 2.0
    folded = fold(channel_samples(Table(values, SMALL), 0, Objective()))
    assert folded.floor == 0
    assert np.count_nonzero(folded.weight) == 1
    assert folded.value[3, 4, 5] == 1


def test_a_reciprocal_table_has_no_floor():
    values = measured(SMALL, missing=0).values
    symmetric = Table(np.maximum(values, values[..., ::-1]), SMALL)
    samples = fold(channel_samples(symmetric, 0, Objective()))
    assert samples.floor <= 1e-28 * samples.energy


@pytest.mark.parametrize(("channel", "name"), [(0, "red"), (2, "blue")])
def test_no_sample_within_the_limit(channel, name):
    table = measured(SMALL)
    lowest = np.minimum(*SMALL.cosines)
    table.values[channel, lowest > np.cos(np.deg2rad(60))] = -1
    with pytest.raises(NpfmError, match=f"{name} channel has no valid sample .* 60 degrees"):
        channel_samples(table, channel, Objective(max_angle=60))
    assert channel_samples(table, 1, Objective(max_angle=60)).energy > 0


def test_the_compressive_function_maps_1_to_the_middle_and_nears_its_bounds():
    assert compressed(1.0) == pytest.approx(0.5 / COMPRESSION_ALPHA)
    np.testing.assert_allclose(compressed([1e-9, 1e9], alpha=0.3), [1e-9, 1 / 0.3])
    x = np.array([0.3, 1.0, 40.0])
    np.testing.assert_allclose(compressive_weight(x), (compressed(x) / x) ** COMPRESSION_POWER)
