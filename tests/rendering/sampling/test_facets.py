import numpy as np
import pytest
from shaded import point

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.microsurfaces import beckmann, beckmann_area, ggx, ggx_area
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.low_discrepancy import low_discrepancy
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.sampling.visible_slopes import _azimuth

NAMES = ("quantiles", "visible-slopes")
LIGHT = Environment(np.ones((4, 8, 3)))
COS_H = np.cos(MERL.theta_h)
POINTS = low_discrepancy(1 << 15)[None]


def made(name, D):
    given = Given(LIGHT, MERL, None, {"D": np.atleast_2d(D).astype(np.float32)})
    [strategy] = registry.make([name], given)
    return strategy


def half_cosines(light, at):
    half = light + at.view[:, None]
    return (half @ at.normal[0] / np.linalg.norm(half, axis=-1))[0]


@pytest.mark.parametrize("alpha", [0.05, 0.15, 0.4])
def test_the_mean_slope_is_that_of_the_surface(alpha):
    """Of Beckmann facets alpha sqrt(pi) / 2; seen from above, so that nearly all can be seen."""
    at = point(0.0)
    light = made("quantiles", beckmann(COS_H, alpha)).sample(POINTS, at)
    slope = np.tan(np.arccos(np.clip(half_cosines(light, at), -1, 1)))
    assert slope.mean() == pytest.approx(alpha * np.sqrt(np.pi) / 2, rel=0.01)


@pytest.mark.parametrize("alpha", [0.05, 0.3])
@pytest.mark.parametrize("theta_o", [0.0, 40.0, 75.0])
@pytest.mark.parametrize(("D", "area"), [(ggx, ggx_area), (beckmann, beckmann_area)])
def test_densities_are_those_of_the_formulas(alpha, theta_o, D, area):
    """Of light directions D cos(theta_h) / (4 o.h), or D over four times the area that is seen."""
    at = point(theta_o)
    surface = D(COS_H, alpha)
    for name in NAMES:
        strategy = made(name, surface)
        light = strategy.sample(POINTS, at)
        light = light[:, light[0] @ at.normal[0] > 0]
        k = MERL.theta_h_bin(np.arccos(np.clip(half_cosines(light, at), -1, 1)))
        cos_d = np.linalg.norm(light + at.view[:, None], axis=-1)[0] / 2
        if name == "quantiles":
            expected = surface[k] * half_cosines(light, at) / (4 * cos_d)
        else:
            expected = surface[k] / (4 * area(at.cos_o[0], alpha))
        found = strategy.pdf(light, at)[0]
        inside = k < 60  # beyond, bins are wide and hold next to no facet
        np.testing.assert_allclose(found[inside], expected[inside], rtol=0.05)
        assert np.mean(found[inside] / expected[inside]) == pytest.approx(1, abs=0.01)


def test_visible_slopes_lose_less_below_the_horizon():
    at = point(80.0)
    lost = {
        name: np.mean(made(name, ggx(COS_H, 0.5)).sample(POINTS, at)[0] @ at.normal[0] <= 0)
        for name in NAMES
    }
    assert lost["visible-slopes"] < 0.6 * lost["quantiles"]


def test_azimuths_solve_their_equation():
    rng = np.random.default_rng(1)
    theta_o, theta_h = rng.uniform(0, np.pi / 2, (2, 4000))
    u = rng.random(4000)
    phi = _azimuth(theta_o, theta_h, u)
    a, b = np.cos(theta_o) * np.cos(theta_h), np.sin(theta_o) * np.sin(theta_h)
    last = np.arccos(np.clip(-a / b, -1, 1))
    share = (a * phi + b * np.sin(phi)) / (a * last + b * np.sin(last))
    np.testing.assert_allclose(share, 2 * u - 1, atol=1e-7)
    assert (np.abs(phi) <= last).all()


@pytest.mark.parametrize("name", NAMES)
def test_a_mirror_reflects_to_its_mirror_direction(name):
    at = point(50.0)
    light = made(name, np.eye(90)[0]).sample(POINTS, at)[0]
    mirror = 2 * at.cos_o[:, None] * at.normal - at.view
    assert (light @ mirror[0] > np.cos(2 * MERL.theta_h_edges[1] + 1e-6)).all()


@pytest.mark.parametrize("name", NAMES)
def test_without_a_fit_there_are_no_facets(name):
    with pytest.raises(NpfmError, match=f"the strategy '{name}' needs the parameters"):
        registry.make([name], Given(LIGHT, MERL))
    with pytest.raises(NpfmError, match="the fit has no factor D"):
        registry.make([name], Given(LIGHT, MERL, None, {"B": np.ones((3, 90, 90))}))
