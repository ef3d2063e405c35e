"""Sampling of factors: what is lost, what varies, and the bars of measured materials."""

import numpy as np
import pytest
from shaded import above_horizon, point

from npfm.datasets import neural
from npfm.errors import NpfmError
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.reflectance.factored import Angles, read, reflectance
from npfm.rendering.lights.environment import LUMINANCE
from npfm.rendering.sampling.factored import FactoredSampling
from npfm.rendering.sampling.shares import LEAST_COSINE
from npfm.rendering.shading import Shading

PAPER = Angles(True, False, (16, 16, 128, 16))
IMPROVED = Angles(True, True, (16, 1, 128, 16))


def facing(theta_o, azimuth=0.0):
    """A point with normal z and tangent x."""
    view = [np.sin(theta_o) * np.cos(azimuth), np.sin(theta_o) * np.sin(azimuth), np.cos(theta_o)]
    return Shading(normal=np.eye(3)[2:], view=np.array([view]), tangent=np.eye(3)[:1])


def variance(strategy, brdf, views=8):
    """Variance of one sample over the squared mean in constant light, the views of a sphere."""
    found = []
    for theta_o in np.arcsin(np.sqrt((np.arange(views) + 0.5) / views)):
        at = facing(theta_o)
        light, measure = above_horizon(at, 1 << 17)
        shown = brdf(light, np.broadcast_to(at.view, light.shape)) * light[:, 2]
        density = strategy.pdf(light[None], at)[0]
        assert (density > 0).all()
        found.append((shown**2 / density) @ measure / (shown @ measure) ** 2 - 1)
    return float(np.mean(found))


def product(light, view):
    """A BRDF that one term of the recipe `improved` is: D(theta_h) and a factor of the view."""
    h = light + view
    length = np.linalg.norm(h, axis=1)
    D = np.exp(-((np.arccos(np.clip(h[:, 2] / length, 0, 1)) / 0.1) ** 2))
    return np.stack([D * (1 + view[:, 2]) / (2 * length * light[:, 2])] * 3)


def test_a_product_is_sampled_with_no_more_variance_than_its_bins_leave():
    fine = Angles(True, True, (16, 1, 512, 8))
    strategy = FactoredSampling(factor(product, Recipe(fine, (1, 1))).factors)
    at = facing(0.3)
    light, measure = above_horizon(at)
    shown = product(light, np.broadcast_to(at.view, light.shape))[0] * light[:, 2]
    # Without the cosine's share, whose density is known.
    density = strategy.pdf(light[None], at)[0] - LEAST_COSINE * light[:, 2] / np.pi
    weight = shown / density * (1 - LEAST_COSINE) / (shown @ measure)
    bright = shown > 1e-2 * shown.max()
    np.testing.assert_allclose(weight[bright], 1, atol=0.2)


@pytest.mark.parametrize("theta_o", [0.0, 0.7, 1.3, 1.55])
@pytest.mark.parametrize("azimuths", [1, 8])
def test_nothing_is_lost_where_the_distributions_are_cut(theta_o, azimuths):
    angles = Angles(True, True, (8, azimuths, 64, 16))
    strategy = FactoredSampling(factor(product, Recipe(angles, (2, 1))).factors)
    at = facing(theta_o, 0.4)
    u = np.random.default_rng(1).random((1, 100_000, 2))
    lost = strategy.sample(u, at)[0] @ at.normal[0] < -1e-9
    assert lost.sum() == 0


@pytest.mark.parametrize("half", [True, False])
def test_the_density_of_the_printed_recipe_is_that_of_the_factors(half):
    """Equation 11: but for the cosine's share, the model times the Jacobian of the half vector."""
    angles = Angles(half, False, (8, 8, 32, 12))
    factors = read(factor(product, Recipe(angles, (2, 2))).factors.arrays())
    strategy, at = FactoredSampling(factors), facing(0.6, 1.1)
    # At the middles of bins, where both have the same values.
    theta, phi = (x.ravel() for x in np.meshgrid(angles.theta_p, angles.phi_p))
    sine = np.sin(theta)
    p = np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)
    light = 2 * (p @ at.view[0])[:, None] * p - at.view if half else p
    light = light[light[:, 2] > 0.05]
    density = strategy.pdf(light[None], at)[0] - LEAST_COSINE * light[:, 2] / np.pi
    model = reflectance(factors, light, np.broadcast_to(at.view, light.shape)).mean(axis=0)
    cos_d = np.sqrt((1 + light @ at.view[0]) / 2)
    expected = model * light[:, 2] / (4 * cos_d if half else 1)
    seen = expected > 1e-2 * expected.max()
    ratio = density[seen] / expected[seen]
    np.testing.assert_allclose(ratio / np.median(ratio), 1, atol=0.02)


def test_the_first_number_keeps_its_strata():
    """Sorted by it, samples of a term are sorted by their angle."""
    strategy = FactoredSampling(factor(product, Recipe(IMPROVED, (1, 1))).factors)
    at = facing(0.5)
    first = np.linspace(0, 1 - LEAST_COSINE, 500, endpoint=False)
    light = strategy.sample(np.stack([first, np.full(500, 0.3)], axis=-1)[None], at)[0]
    half = light + at.view
    assert (np.diff(half[:, 2] / np.linalg.norm(half, axis=1)) < 1e-12).all()


def test_black_is_sampled_as_white():
    factors = factor(lambda light, view: np.zeros((3, len(light))), Recipe(IMPROVED)).factors
    at = facing(0.5)
    light, _ = above_horizon(at, 1000)
    np.testing.assert_allclose(
        FactoredSampling(factors).pdf(light[None], at)[0], light[:, 2] / np.pi
    )


def test_azimuths_of_the_view_need_a_tangent():
    factors = factor(product, Recipe(Angles(True, True, (4, 4, 8, 8)), (1, 1))).factors
    at = Shading(normal=np.eye(3)[2:], view=point(0.0).view)
    with pytest.raises(NpfmError, match="tangent"):
        FactoredSampling(factors).pdf(np.eye(3)[None, 2:], at)


@pytest.mark.parametrize(
    ("material", "terms", "printed", "improved"),
    [
        ("nickel", (2, 1), 0.13, 0.035),
        ("maroon-plastic", (3, 1), 1.5, 0.055),
        ("blue-metallic-paint", (4, 1), 0.19, 0.04),
    ],
)
def test_variance_in_constant_light(data, material, terms, printed, improved):
    table = neural.load(data / "merl_nbrdf.zip", material)
    for angles, most, JK in ((PAPER, printed, terms), (IMPROVED, improved, (3, 2))):
        strategy = FactoredSampling(factor(table.lookup, Recipe(angles, JK)).factors)
        found = variance(strategy, lambda i, o: LUMINANCE @ table.lookup(i, o))
        assert found <= most
