import numpy as np
import pytest

from npfm.reflectance.anisotropic_slopes import Normals, beckmann_scale, ggx_scale
from npfm.reflectance.directional import directions
from npfm.reflectance.microsurfaces import (
    anisotropic_beckmann,
    anisotropic_ggx,
    roughness,
    turned_scale,
)
from npfm.reflectance.tabulated_slopes import (
    as_beckmann,
    as_ggx,
    at_normals,
    elevations,
    looked_up,
    neighbours,
    rougher,
)

NORMALS = Normals(90, 48)
SCALE = turned_scale((0.1, 0.4), 0.5)


def nodes(count=11, azimuths=48):
    return directions(elevations(count)[:, None], np.arange(azimuths) / azimuths * 2 * np.pi)


def test_elevations_are_half_as_far_apart_as_those_of_the_utia_database():
    np.testing.assert_allclose(np.rad2deg(elevations(11)), np.arange(0, 76, 7.5))


def test_between_elevations_ggx_is_met_exactly():
    D, exact = anisotropic_ggx(nodes(), SCALE), anisotropic_ggx(NORMALS.directions, SCALE)
    inside = NORMALS.theta_h <= elevations(11)[-1]
    np.testing.assert_allclose(at_normals(D, NORMALS)[inside], exact[inside], rtol=1e-10)
    held = np.broadcast_to(D[-1], exact[~inside].shape)
    np.testing.assert_allclose(at_normals(D, NORMALS)[~inside], held, rtol=1e-12)
    np.testing.assert_allclose(as_ggx(D, NORMALS), exact, rtol=1e-10)


def test_between_elevations_beckmann_is_met_exactly():
    scale = turned_scale((0.3, 0.6), 0.5)
    D, exact = (anisotropic_beckmann(h, scale) for h in (nodes(), NORMALS.directions))
    bright = exact > 1e-5 * exact.max()
    np.testing.assert_allclose(as_beckmann(D, NORMALS)[bright], exact[bright], rtol=1e-9)


@pytest.mark.parametrize("alpha", [(0.05, 0.05), (0.1, 0.4), (0.2, 0.6), (0.6, 0.6)])
@pytest.mark.parametrize("turn", [0, 10, 45])
def test_roughness_is_found_at_the_elevations_of_the_utia_database(alpha, turn):
    scale = turned_scale(alpha, np.deg2rad(turn))
    for density, between, measured in (
        (anisotropic_ggx, as_ggx, ggx_scale),
        (anisotropic_beckmann, as_beckmann, beckmann_scale),
    ):
        found = roughness(measured(between(density(nodes(), scale), NORMALS), NORMALS))
        assert found[:2] == pytest.approx(roughness(scale)[:2], rel=5e-3)
        assert found[2] == pytest.approx(roughness(scale)[2], abs=0.01)


def test_looked_up_at_its_own_normals_a_distribution_is_itself():
    rng = np.random.default_rng(3)
    D = rng.random((7, 10))
    D[0] = D[0, 0]
    h = nodes(7, 10).reshape(-1, 3)
    np.testing.assert_allclose(looked_up(D, *neighbours(h, D.shape)), D.ravel(), rtol=1e-9)


def test_half_way_between_azimuths_the_roots_are_halved():
    D = np.array([[1.0, 1, 1, 1], [4, 1, 4, 1], [1, 1, 1, 1]])
    h = directions(elevations(3)[1], np.array([np.pi / 4]))
    found = looked_up(D, *neighbours(h.reshape(-1, 3), D.shape))
    assert found == pytest.approx([((0.5 + 1) / 2) ** -2])


def test_zeros_are_next_to_nothing_and_finite():
    D = np.zeros((5, 8))
    D[0] = 2.0
    found = at_normals(D, Normals(90, 8))
    assert np.isfinite(found).all()
    assert (found[NORMALS.theta_h > 0.4] < 1e-11).all()


@pytest.mark.parametrize("factors", [(1, 1), (2, 2), (1.5, 0.8), (0.7, 2)])
def test_stretched_ggx_is_ggx_of_stretched_roughness(factors):
    """Exactly along the meridians; elsewhere up to the interpolation between azimuths."""
    D = anisotropic_ggx(nodes(), turned_scale((0.3, 0.5), 0.0))
    expected = anisotropic_ggx(nodes(), turned_scale((0.3 * factors[0], 0.5 * factors[1]), 0.0))
    np.testing.assert_allclose(rougher(D, factors)[:9, ::12], expected[:9, ::12], rtol=1e-9)
    np.testing.assert_allclose(rougher(D, factors)[:9], expected[:9], rtol=0.03)
