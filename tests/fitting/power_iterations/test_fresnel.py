import numpy as np
import pytest

from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.fitting.power_iterations.fresnel import WAYS, fresnel
from npfm.fitting.power_iterations.mirrors import mirrors
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import beckmann, ggx, ggx_area
from npfm.reflectance.slopes import ELEVATIONS, normalised, projected_area
from npfm.reflectance.table import INVALID, Table

GRID = HalfDifference(18, 18, 36)
RISE = 0.04 + 0.96 * (1 - np.cos(GRID.theta_d)) ** 5


def ideal(alpha, grid=GRID):
    return mirrors(ggx(np.cos(grid.theta_h), alpha), ggx_area(np.cos(ELEVATIONS), alpha), grid)


def samples_of(half, grid=GRID):
    whole = np.concatenate([half, half[..., ::-1]], axis=-1)
    values = np.where(grid.above_horizon, whole, INVALID)
    return fold(channel_samples(Table(np.stack([values] * 3), grid), 0, Objective()))


def test_mirrors_are_equation_19_with_smiths_correlated_shadowing():
    """From light and view directions, D and G1 by their integrals, sample by sample."""
    D = normalised(np.random.default_rng(1).random(18), GRID)
    found = mirrors(D, projected_area(D, GRID), GRID)
    light, view = directions(
        GRID.theta_h[:, None, None], GRID.theta_d[:, None], GRID.phi_d[: GRID.phi_d_bins // 2]
    )
    above = GRID.above_horizon[..., : GRID.phi_d_bins // 2]
    assert (found[~above] == 0).all()
    areas = projected_area(D, GRID)
    for cell in [(2, 3, 4), (9, 0, 10), (14, 7, 17), (0, 16, 1)]:
        cos_i, cos_o = light[cell][2], view[cell][2]
        G_i, G_o = (c / np.interp(np.arccos(c), ELEVATIONS, areas) for c in (cos_i, cos_o))
        G = G_i * G_o / (G_i + G_o - G_i * G_o)
        assert found[cell] == pytest.approx(D[cell[0]] * G / (4 * cos_i * cos_o), rel=1e-12)


@pytest.mark.parametrize("way", WAYS)
def test_every_way_finds_the_factor_of_a_product(way):
    unit = ideal(0.3)
    samples = samples_of(unit * RISE[:, None])
    found = fresnel(samples, unit, way) * samples.scale
    np.testing.assert_allclose(found, RISE, rtol=1e-9)


def test_least_squares_minimise_the_objective():
    rng = np.random.default_rng(2)
    unit = ideal(0.3)
    samples = samples_of(unit * RISE[:, None] * rng.uniform(0.5, 2, unit.shape))
    found = fresnel(samples, unit, "least-squares")
    least = evaluate(samples, found[:, None] * unit)
    for way in ("mean", "median"):
        assert evaluate(samples, fresnel(samples, unit, way)[:, None] * unit) > least
    for _ in range(10):
        other = found * rng.uniform(0.9, 1.1, found.shape)
        assert evaluate(samples, other[:, None] * unit) > least


def test_the_mean_of_ratios_explodes_where_there_is_next_to_no_lobe():
    """Beckmann facets under a little diffuse light; least squares stay below the zero model."""
    cosine = np.cos(GRID.theta_h)
    D = normalised(beckmann(cosine, 0.2), GRID)
    unit = mirrors(D, projected_area(D, GRID), GRID)
    samples = samples_of(unit + 0.01)
    reached = {
        way: evaluate(samples, fresnel(samples, unit, way)[:, None] * unit) / samples.energy
        for way in WAYS
    }
    assert reached["mean"] > 1e6
    assert reached["least-squares"] < 1


def test_bins_without_samples_follow_their_neighbours():
    unit = ideal(0.3)
    values = np.concatenate([unit * RISE[:, None]] * 2, axis=-1)
    values = np.where(GRID.above_horizon, values, INVALID)
    values[:, [0, 1, 5, 16, 17]] = INVALID
    samples = fold(channel_samples(Table(np.stack([values] * 3), GRID), 0, Objective()))
    found = fresnel(samples, unit, "least-squares") * samples.scale
    assert found[0] == found[1] == found[2]
    assert found[5] == pytest.approx((found[4] + found[6]) / 2)
    assert found[16] == found[17] == found[15]


def test_without_mirrors_to_see_the_factor_is_1():
    samples = samples_of(ideal(0.3))
    assert (fresnel(samples, np.zeros_like(samples.value), "mean") == 1).all()
