import numpy as np
import pytest
from scipy.integrate import quad

from npfm.datasets import formulas


def test_fresnel_of_glass_at_known_angles():
    assert formulas.fresnel(np.array(1.0), 1.5) == pytest.approx(0.04)
    assert formulas.fresnel(np.array(0.0), 1.5) == pytest.approx(1.0)
    # At Brewster's angle only the perpendicular half is reflected: ((n^2-1)/(n^2+1))^2 / 2.
    brewster = np.cos(np.arctan(1.5))
    assert formulas.fresnel(brewster, 1.5) == pytest.approx((1.25 / 3.25) ** 2 / 2)


def test_fresnel_of_a_metal_head_on():
    # ((n-1)^2 + k^2) / ((n+1)^2 + k^2)
    n, k = 0.375, 2.386
    expected = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    assert formulas.fresnel(np.array(1.0), n + 1j * k) == pytest.approx(expected)


@pytest.mark.parametrize("alpha", [0.02, 0.3, 0.8])
@pytest.mark.parametrize("kind", ["ggx", "beckmann"])
def test_facets_project_onto_the_unit_of_area_they_belong_to(kind, alpha):
    # Walter et al. 2007, equation 4; s = sqrt(theta) spreads a narrow peak.
    distribution = getattr(formulas, kind)

    def integrand(s):
        theta = s**2
        projected = distribution(np.cos(theta), alpha) * np.cos(theta)
        return projected * 2 * np.pi * np.sin(theta) * 2 * s

    area, _ = quad(integrand, 0, np.sqrt(np.pi / 2 - 1e-6), points=[np.sqrt(alpha)], limit=200)
    assert area == pytest.approx(1, abs=1e-5)


@pytest.mark.parametrize("alpha", [0.1, 0.5])
@pytest.mark.parametrize("kind", ["ggx", "beckmann"])
def test_shadowing_leaves_the_projected_area_of_the_surface(kind, alpha):
    # Smith's G1(o) is cos(o) over the integral of max(0, o.h) D(h): the facets that a direction
    # sees cover what the mean surface covers (Heitz 2014, equation 14).
    distribution, shadowing = getattr(formulas, kind), getattr(formulas, f"{kind}_shadowing")
    theta_o = np.radians(75.0)
    s, ds = np.linspace(0, np.sqrt(np.pi / 2), 2001, retstep=True)
    s = (s[:-1] + s[1:]) / 2
    phi = (np.arange(720) + 0.5) / 720 * np.pi
    theta = s[:, None] ** 2
    seen = np.sin(theta_o) * np.sin(theta) * np.cos(phi) + np.cos(theta_o) * np.cos(theta)
    solid_angle = np.sin(theta) * 2 * s[:, None] * ds * 2 * np.pi / phi.size
    visible = (np.maximum(seen, 0) * distribution(np.cos(theta), alpha) * solid_angle).sum()
    cosine = np.cos(theta_o)
    assert shadowing(cosine, alpha) == pytest.approx(cosine / visible, rel=1e-4)


def test_smooth_chalk_is_lambertian_and_rough_chalk_bright_towards_the_light():
    cos_i = np.cos(np.radians([60.0, 60.0]))
    # The view at 60 degrees too: once with the light, once opposite to it.
    cos_d = np.cos(np.radians([0.0, 60.0]))
    angles = formulas.Angles(np.cos(np.radians([60.0, 0.0])), cos_d, cos_i, cos_i)
    np.testing.assert_allclose(formulas.rough_diffuse(angles, 0.5, 0.0), 0.5 / np.pi)
    towards, away = formulas.rough_diffuse(angles, 0.5, 0.5)
    assert towards > 1.5 * away > 0
