import numpy as np
import pytest
from scipy.integrate import quad

from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.microsurfaces import beckmann, beckmann_area, ggx, ggx_area
from npfm.reflectance.slopes import (
    ELEVATIONS,
    bands,
    beckmann_roughness,
    facing,
    ggx_roughness,
    normalised,
    projected_area,
    rougher,
)

COS_H = np.cos(MERL.theta_h)
ROUGHNESS = [0.005, 0.02, 0.1, 0.3, 0.6]
SURFACES = {
    "ggx": (ggx, ggx_area, ggx_roughness),
    "beckmann": (beckmann, beckmann_area, beckmann_roughness),
}
every_surface = pytest.mark.parametrize("name", SURFACES)
every_roughness = pytest.mark.parametrize("alpha", ROUGHNESS)


@pytest.mark.parametrize("elevation", [0.0, 0.4, 1.2, np.pi / 2])
@pytest.mark.parametrize("theta_h", [1e-4, 0.3, 1.0, 1.5])
def test_the_azimuth_integral_is_that_of_quadrature(elevation, theta_h):
    def cosine(phi):
        across = np.sin(elevation) * np.sin(theta_h) * np.cos(phi)
        return max(0.0, np.cos(elevation) * np.cos(theta_h) + across)

    found = float(facing(elevation, theta_h))
    assert found == pytest.approx(2 * quad(cosine, 0, np.pi, limit=200)[0], rel=1e-7, abs=1e-12)


@every_surface
@every_roughness
def test_roughness_of_a_formula(name, alpha):
    D, _, roughness = SURFACES[name]
    assert roughness(D(COS_H, alpha), MERL) == pytest.approx(alpha, rel=1e-4)


@every_surface
@every_roughness
def test_formulas_are_normalised(name, alpha):
    D = SURFACES[name][0](COS_H, alpha)
    np.testing.assert_allclose(normalised(D, MERL), D, rtol=1e-4)


@every_surface
@every_roughness
def test_projected_area_of_a_formula(name, alpha):
    D, area, _ = SURFACES[name]
    found = projected_area(normalised(D(COS_H, alpha), MERL), MERL)
    np.testing.assert_allclose(found, area(np.cos(ELEVATIONS), alpha), rtol=2e-4, atol=2e-6)


@every_surface
def test_formulas_of_areas_are_integrals(name):
    """By brute force over the hemisphere."""
    D, area, _ = SURFACES[name]
    theta = (np.arange(4000) + 0.5) / 4000 * np.pi / 2
    weight = D(np.cos(theta), 0.4) * np.sin(theta) * np.pi / 2 / 4000
    for elevation in (0.0, 0.7, 1.5):
        expected = np.sum(facing(elevation, theta) * weight)
        assert area(np.cos(elevation), 0.4) == pytest.approx(expected, rel=1e-5)


def test_the_area_of_the_whole_surface_is_its_base():
    """Seen from above, where every facet is visible, whatever D is."""
    D = np.random.default_rng(1).random(90)
    assert projected_area(normalised(D, MERL), MERL)[0] == pytest.approx(1, rel=1e-12)


def test_bands_cover_the_hemisphere():
    assert 2 * np.pi * bands(MERL).sum() == pytest.approx(2 * np.pi, rel=1e-4)


@every_surface
@pytest.mark.parametrize("factor", [0.25, 0.5, 1.0, 2.0, 3.0])
def test_a_rougher_formula_is_that_of_a_larger_alpha(name, factor):
    D, _, roughness = SURFACES[name]
    made = rougher(D(COS_H, 0.1), MERL, factor)
    assert 2 * np.pi * np.sum(bands(MERL) * COS_H * made) == pytest.approx(1, rel=3e-3)
    assert roughness(made, MERL) == pytest.approx(0.1 * factor, rel=3e-3)
    expected = D(COS_H, 0.1 * factor)
    np.testing.assert_allclose(made, expected, rtol=5e-3, atol=1e-5 * expected.max())


def test_a_factor_of_1_changes_nothing():
    D = np.random.default_rng(2).random(90)
    np.testing.assert_allclose(rougher(D, MERL, 1.0), D, rtol=1e-12)


def test_where_there_are_no_facets_there_are_none_at_another_roughness():
    D = np.where(MERL.theta_h < 0.5, 1.0, 0.0)
    made = rougher(D, MERL, 2.0)
    assert np.isfinite(made).all()
    assert (made[np.tan(MERL.theta_h) > 2.2 * np.tan(0.5)] < 1e-100).all()


def test_a_mirrors_roughness_is_no_more_than_its_first_bins():
    grid = HalfDifference(30, 30, 60)
    D = np.eye(30)[0]
    assert ggx_roughness(D, grid) < 2 * grid.theta_h[1]
    assert beckmann_roughness(D, grid) < 2 * grid.theta_h[1]
