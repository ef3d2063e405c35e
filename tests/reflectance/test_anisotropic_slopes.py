import numpy as np
import pytest

from npfm.reflectance import microsurfaces
from npfm.reflectance.anisotropic_slopes import (
    Normals,
    beckmann_scale,
    facing,
    ggx_scale,
    normalised,
    projected,
    too_narrow,
)
from npfm.reflectance.microsurfaces import (
    anisotropic_beckmann,
    anisotropic_beckmann_area,
    anisotropic_ggx,
    anisotropic_ggx_area,
    roughness,
    scale_matrix,
    turned_scale,
)

NORMALS = Normals()
SURFACES = {
    "ggx": (anisotropic_ggx, anisotropic_ggx_area, ggx_scale),
    "beckmann": (anisotropic_beckmann, anisotropic_beckmann_area, beckmann_scale),
}
every_surface = pytest.mark.parametrize("name", SURFACES)
every_alpha = pytest.mark.parametrize(
    "alpha", [(0.05, 0.6), (0.6, 0.05), (0.1, 0.3), (0.3, 0.6), (0.05, 0.05), (0.6, 0.6)]
)
every_turn = pytest.mark.parametrize("turn", [0, 1, 2, 3, 17, 45, 61.3, 90, 170])


def elevations(normals):
    return tuple(normals.theta_h.tolist())


@pytest.mark.parametrize("shape", [(6, 8), (5, 9), (7, 1)])
@pytest.mark.parametrize("clamped", [False, True])
def test_areas_by_fourier_transforms_are_those_by_sums(shape, clamped):
    normals, theta_o = Normals(*shape), (0.0, 0.4, 1.5)
    D = np.random.default_rng(1).random(shape)
    found = projected(facing(normals, theta_o, clamped), D)
    for i, theta in enumerate(theta_o):
        for j, phi in enumerate(normals.phi_h):
            o = np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)
            cosine = normals.directions @ o
            seen = np.maximum(cosine, 0) if clamped else np.abs(cosine)
            expected = np.sum(seen * D * normals.solid_angle[:, None])
            assert found[i, j] == pytest.approx(expected, rel=1e-12)


@every_surface
@every_alpha
@pytest.mark.parametrize("turn", [0, 2, 17])
def test_the_area_of_a_formula_is_that_of_its_facets(name, alpha, turn):
    density, area, _ = SURFACES[name]
    scale, o = turned_scale(alpha, np.deg2rad(turn)), NORMALS.directions
    D = normalised(density(o, scale), NORMALS)
    found = (projected(facing(NORMALS, elevations(NORMALS)), D) + o[..., 2]) / 2
    np.testing.assert_allclose(found, area(o, scale), rtol=4e-3, atol=5e-4)


@every_surface
def test_equal_roughness_is_the_isotropic_formula(name):
    density, area, _ = SURFACES[name]
    scale, h = turned_scale((0.3, 0.3), 1.0), NORMALS.directions
    isotropic = getattr(microsurfaces, name), getattr(microsurfaces, f"{name}_area")
    for found, expected in zip((density, area), isotropic, strict=True):
        np.testing.assert_allclose(found(h, scale), expected(h[..., 2], 0.3), rtol=1e-9)


def test_slopes_have_the_densities_of_appendix_c():
    x, y = np.meshgrid(np.linspace(-0.9, 0.9, 7), np.linspace(-0.5, 1.2, 6))
    scale = scale_matrix(0.2, 0.5, 0.6)
    inverse = np.linalg.inv(scale)
    form = inverse[0, 0] * x**2 + 2 * inverse[0, 1] * x * y + inverse[1, 1] * y**2
    peak = 1 / (np.pi * np.sqrt(np.linalg.det(scale)))
    h = np.stack([-x, -y, np.ones_like(x)], axis=-1) / np.sqrt(1 + x**2 + y**2)[..., None]
    for density, expected in (
        (anisotropic_ggx, peak / (1 + form) ** 2),
        (anisotropic_beckmann, peak * np.exp(-form)),
    ):
        np.testing.assert_allclose(density(h, scale) * h[..., 2] ** 4, expected, rtol=1e-12)


@every_surface
def test_formulas_are_finite_at_grazing_angles(name):
    density, area, _ = SURFACES[name]
    across = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]])
    for scale in (turned_scale((0.01, 0.6), 0.4), turned_scale((0.5, 0.5), 0)):
        assert np.isfinite(density(across, scale)).all()
        assert (area(across, scale) > 0).all()


def test_roughness_of_a_scale_matrix_and_back():
    assert roughness(scale_matrix(0.2, 0.5, -0.6)) == pytest.approx((0.2, 0.5, -0.6))
    assert roughness(turned_scale((0.2, 0.5), np.pi / 2)) == pytest.approx((0.5, 0.2, 0))
    for wrong in ((0, 0.1, 0), (0.1, -1, 0), (0.1, 0.1, 1.0), (0.1, np.nan, 0)):
        with pytest.raises(ValueError, match="no surface has alpha"):
            scale_matrix(*wrong)


@every_surface
@every_alpha
@every_turn
def test_roughness_of_a_formula(name, alpha, turn):
    density, _, measured = SURFACES[name]
    scale = turned_scale(alpha, np.deg2rad(turn))
    found = roughness(measured(3 * density(NORMALS.directions, scale), NORMALS))
    expected = roughness(scale)
    assert found[:2] == pytest.approx(expected[:2], rel=5e-3)
    assert found[2] == pytest.approx(expected[2], abs=0.01)


@every_surface
def test_what_is_turned_by_whole_bins_has_a_turned_matrix(name):
    measured = SURFACES[name][2]
    D = np.random.default_rng(2).random(NORMALS.shape) ** 8
    for bins in (1, 17, 45, 80):
        turn = bins * 2 * np.pi / 90
        axes = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        turned = measured(np.roll(D, bins, axis=1), NORMALS)
        np.testing.assert_allclose(turned, axes @ measured(D, NORMALS) @ axes.T, rtol=1e-9)


@every_surface
def test_too_few_azimuths_are_noticed(name):
    density = SURFACES[name][0]
    for turn in np.deg2rad([0, 1, 2, 17, 45]):
        for alpha, narrow in (((0.01, 0.6), True), ((0.02, 0.6), True), ((0.05, 0.6), False)):
            D = density(NORMALS.directions, turned_scale(alpha, turn))
            assert too_narrow(D, NORMALS) == narrow
    assert not too_narrow(np.ones((90, 1)), Normals(90, 1))
