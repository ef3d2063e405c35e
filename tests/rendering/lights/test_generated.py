import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.rendering.lights import generated
from npfm.rendering.lights.environment import LUMINANCE
from npfm.rendering.lights.generated import LIGHTS, generate
from npfm.rendering.lights.places import shapes


@pytest.fixture(scope="module")
def lights():
    """Every light, small and with few directions a texel."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(generated, "FINE_ROWS", 128)
        return {name: generate(name, 64) for name in LIGHTS}


def mean(light) -> np.ndarray:
    return np.einsum("rck,r->k", light.radiance, light.solid_angle) / (4 * np.pi)


def quantile(light, fraction: float) -> float:
    """Luminance below which the given share of the sphere lies."""
    luminance = (light.radiance @ LUMINANCE).ravel()
    order = np.argsort(luminance)
    share = np.cumsum(np.repeat(light.solid_angle, light.radiance.shape[1])[order])
    return luminance[order][np.searchsorted(share, fraction * share[-1])]


def test_there_are_four_places_and_no_place_of_the_wanted_size(lights):
    assert list(lights) == ["cathedral", "house", "grove", "basilica", "constant"]
    assert (lights["constant"].radiance == 1).all()
    for light in lights.values():
        assert light.radiance.shape == (64, 128, 3)


@pytest.mark.parametrize("name", LIGHTS)
def test_the_same_place_at_another_height(lights, name, monkeypatch):
    monkeypatch.setattr(generated, "FINE_ROWS", 128)
    coarse = generate(name, 32)
    np.testing.assert_allclose(mean(coarse), mean(lights[name]), rtol=1e-9)
    halved = lights[name].radiance.reshape(32, 2, 64, 2, 3)
    weight = lights[name].solid_angle.reshape(32, 2) / coarse.solid_angle[:, None]
    merged = np.einsum("rsctk,rs->rck", halved, weight)
    np.testing.assert_allclose(merged, coarse.radiance, rtol=1e-9)


def test_a_light_is_the_same_every_time(lights, monkeypatch):
    monkeypatch.setattr(generated, "FINE_ROWS", 128)
    shapes._lattice.cache_clear()
    assert (generate("grove", 64).radiance == lights["grove"].radiance).all()


def test_the_cathedral_is_dark_with_small_brilliant_windows(monkeypatch):
    monkeypatch.setattr(generated, "FINE_ROWS", 512)
    light = generate("cathedral", 256)
    luminance = light.radiance @ LUMINANCE
    assert luminance.max() > 1e4 * quantile(light, 0.5)
    bright = luminance > 100 * quantile(light, 0.5)
    share = light.solid_angle @ bright.sum(axis=1) / (4 * np.pi)
    energy = light.solid_angle @ (luminance * bright).sum(axis=1)
    assert share < 0.05
    assert energy > 0.7 * (light.solid_angle @ luminance.sum(axis=1))


def test_lights_have_the_character_of_the_papers(lights):
    house, grove, basilica = lights["house"], lights["grove"], lights["basilica"]
    red, _, blue = np.median(house.radiance.reshape(-1, 3), axis=0)
    assert red > 2 * blue  # warm
    # The house has large windows: ahead, across, and brilliant.
    assert quantile(house, 0.98) > 100 * quantile(house, 0.5)
    # The grove gets its light from above, out of gaps that are bluer than the ground.
    above, below = (mean_of_rows(grove, rows) for rows in (slice(0, 32), slice(32, 64)))
    assert above @ LUMINANCE > 3 * (below @ LUMINANCE)
    assert above[2] / above[0] > 1.3 * below[2] / below[0]
    # The basilica is the brightest inside, the cathedral the darkest.
    dark = lights["cathedral"]
    assert quantile(basilica, 0.1) > 3 * quantile(dark, 0.5)


def mean_of_rows(light, rows: slice) -> np.ndarray:
    weight = light.solid_angle[rows]
    return np.einsum("rck,r->k", light.radiance[rows], weight) / weight.sum()


@pytest.mark.parametrize(("name", "exposure"), [("cathedral", 0.02), ("house", 1.0)])
def test_the_papers_exposure_shows_a_white_ball(lights, name, exposure):
    radiance = mean(lights[name]) @ LUMINANCE
    assert 0.15 < 1 - 2 ** (-exposure * radiance) < 0.75


def test_a_light_that_does_not_exist():
    with pytest.raises(NpfmError, match=r"unknown generated light 'desert'.*cathedral.*house"):
        generate("desert", 64)


def test_noise_is_continuous_and_repeats():
    points = np.random.default_rng(0).random((1000, 3)) * shapes.PERIOD
    here = shapes.noise(points, 1, 3)
    assert np.abs(shapes.noise(points + 1e-6, 1, 3) - here).max() < 1e-4
    np.testing.assert_allclose(shapes.noise(points + shapes.PERIOD, 1, 3), here, atol=1e-9)
    assert here.min() >= 0 and here.max() <= 1
    assert abs(here.mean() - 0.5) < 0.02
    assert np.abs(here - shapes.noise(points, 9, 3)).max() > 0.2


def test_rays_end_on_the_surfaces_of_vault_and_dome():
    eye = np.array([0.3, 0.0, 0.5])
    direction = np.random.default_rng(1).normal(size=(2000, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    distance, normal = shapes.vault(eye, direction, 2.0, 1.0, (-3.0, 4.0))
    x, y, z = (eye + distance[:, None] * direction).T
    reach = np.where(y > 1, np.hypot(x, y - 1), np.abs(x))
    on_end = np.isclose(z, -3) | np.isclose(z, 4)
    assert np.isclose(reach[~on_end], 2).all()
    assert (reach[on_end] < 2 + 1e-9).all()
    distance, other = shapes.dome(eye, direction, 2.0, 1.0)
    x, y, z = (eye + distance[:, None] * direction).T
    radius = np.sqrt(x * x + z * z + np.maximum(y - 1, 0) ** 2)
    np.testing.assert_allclose(radius, 2)
    for inward in (normal, other):
        np.testing.assert_allclose(np.linalg.norm(inward, axis=1), 1)
        assert (np.einsum("ij,ij->i", inward, direction) < 0).all()


def test_a_pillar_is_met_on_its_near_side():
    ahead = np.array([[0.0, 0.0, -1.0], [0.0, 0.6, -0.8], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    distance, normal = shapes.pillar(np.zeros(3), ahead, 0.0, -5.0, 1.0)
    np.testing.assert_allclose(distance, [4.0, 5.0, np.inf, np.inf])
    np.testing.assert_allclose(normal[:2], [[0, 0, 1], [0, 0, 1]], atol=1e-12)


def test_lamps_light_by_distance_and_cosine():
    points, normal = np.zeros((2, 3)), np.array([[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]])
    lamp = [[0.0, 10.0, 0.0, 200.0, 100.0, 50.0]]
    light = shapes.lit(points, normal, [0.1, 0.1, 0.1], lamp)
    np.testing.assert_allclose(light, [[2.1, 1.1, 0.6], [0.1, 0.1, 0.1]], rtol=2e-3)
