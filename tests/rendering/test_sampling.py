import numpy as np
import pytest

from npfm.reflectance.half_difference import MERL, Grid
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.strategies import (
    HalfVectorSampling,
    LightSampling,
    combine,
    low_discrepancy,
    rotate,
)

POINTS = 1 << 14


def unit(vector):
    return np.asarray(vector) / np.linalg.norm(vector)


def pair(theta_o, normal=(0.2, 0.9, -0.4)):
    """A view at `theta_o` degrees from a normal, both as one surface point."""
    normal = unit(normal)
    side = unit(np.cross(normal, [0.3, 0.2, 0.9]))
    view = np.cos(np.radians(theta_o)) * normal + np.sin(np.radians(theta_o)) * side
    return view[None], normal[None]


def environment(rows=8):
    radiance = np.random.default_rng(5).random((rows, 2 * rows, 3)) ** 4
    return Environment(radiance)


def integral(function, rows=400):
    """Integral over the sphere by a plain lattice."""
    theta = (np.arange(rows) + 0.5) * np.pi / rows
    phi = (np.arange(2 * rows) + 0.5) * np.pi / rows
    sine = np.sin(theta)[:, None]
    x, y, z = np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)[:, None])
    values = function(np.stack([x, y, z], axis=-1).reshape(-1, 3)).reshape(x.shape)
    return float((values * sine).sum() * (np.pi / rows) ** 2)


def smooth(normal, tilt):
    """Functions of the light that vanish at the horizon of `normal`."""
    return lambda light: np.maximum(light @ normal, 0) ** 2 * np.exp(light @ np.asarray(tilt))


@pytest.mark.parametrize("theta_o", [0.0, 20.0, 65.0, 87.0])
@pytest.mark.parametrize("tilt", [(0, 0, 0), (2, 0, 0), (0, -2, 1)])
def test_half_vector_samples_have_their_density(theta_o, tilt):
    view, normal = pair(theta_o)
    strategy, function = HalfVectorSampling(MERL), smooth(normal[0], tilt)
    light = strategy.sample(low_discrepancy(POINTS)[None], view, normal)
    estimate = (function(light) / strategy.pdf(light, view, normal)).mean()
    assert estimate == pytest.approx(integral(function), rel=0.01)


@pytest.mark.parametrize("theta_o", [0.0, 50.0, 88.0])
def test_half_vectors_fill_the_bins_evenly_and_all_lights_are_above_the_horizon(theta_o):
    view, normal = pair(theta_o)
    light = HalfVectorSampling(MERL).sample(low_discrepancy(POINTS)[None], view, normal)[0]
    np.testing.assert_allclose(np.linalg.norm(light, axis=1), 1)
    assert (light @ normal[0] > 0).all()
    half = light + view
    cosine = (half @ normal[0]) / np.linalg.norm(half, axis=1)
    bins = (np.sqrt(np.degrees(np.arccos(np.minimum(cosine, 1))) / 90) * 90).astype(int)
    count = int(np.ceil(90 * np.sqrt((45 + theta_o / 2) / 90)))
    np.testing.assert_allclose(np.bincount(bins), POINTS / count, rtol=0.03)


def test_half_vector_density_is_zero_below_the_horizon():
    view, normal = pair(40.0)
    light = unit(np.cross(normal[0], [1, 0, 0])) - 0.2 * normal[0]
    density = HalfVectorSampling(MERL).pdf(unit(light)[None, None], view, normal)
    np.testing.assert_array_equal(density, [[0]])


def test_half_vectors_follow_the_grid():
    view, normal = pair(30.0)
    strategy = HalfVectorSampling(Grid(10, 10, 20))
    light = strategy.sample(low_discrepancy(POINTS)[None], view, normal)
    function = smooth(normal[0], (0, 0, 0))
    estimate = (function(light) / strategy.pdf(light, view, normal)).mean()
    assert estimate == pytest.approx(integral(function), rel=0.01)


def test_light_samples_have_their_density():
    view, normal = pair(30.0)
    light_source = environment()
    strategy = LightSampling(light_source)
    light = strategy.sample(low_discrepancy(POINTS)[None], view, normal)
    density = strategy.pdf(light, view, normal)
    assert light.shape == (1, POINTS, 3)
    estimate = (light_source.lookup(light)[..., 0] / density).mean()
    expected = integral(lambda d: light_source.lookup(d)[:, 0])
    assert estimate == pytest.approx(expected, rel=0.01)


def test_combined_strategies_estimate_an_integral_that_neither_is_made_for():
    view, normal = (np.repeat(v, 2, axis=0) for v in pair(60.0))
    source = environment()
    strategies = [LightSampling(source), HalfVectorSampling(MERL)]
    points = np.stack([low_discrepancy(3000), rotate(low_discrepancy(3000), [0.3, 0.7])])
    light, density = combine(strategies, [points[:, :1000], points], view, normal)
    assert light.shape == (2, 4000, 3)

    def function(direction):
        lobe = np.exp(20 * (direction @ unit([0.5, 0.8, -0.1]) - 1))
        return source.lookup(direction)[..., 1] * lobe * np.maximum(direction @ normal[0], 0)

    estimate = (function(light) / density).sum(axis=1)
    np.testing.assert_allclose(estimate, integral(function), rtol=0.03)


@pytest.mark.parametrize("count", [1, 2, 64, 100])
def test_low_discrepancy_points_are_a_prefix_of_one_sequence(count):
    points = low_discrepancy(count)
    np.testing.assert_array_equal(points, low_discrepancy(128)[:count])


def test_low_discrepancy_points_form_nets():
    # A (0, 6, 2)-net in base 2: each elementary interval of area 1/64 holds one point, in any
    # aligned block of the sequence, so that each camera ray of a pixel gets a net of its own.
    for points in low_discrepancy(256).reshape(4, 64, 2):
        for columns in (1, 2, 4, 8, 16, 32, 64):
            index = np.floor(points * [columns, 64 // columns]).astype(int)
            assert len({tuple(i) for i in index}) == 64


def test_rotation_stays_in_the_unit_square_and_keeps_distances_on_the_torus():
    points = rotate(low_discrepancy(64), np.array([0.7, 0.2]))
    assert points.min() >= 0 and points.max() < 1
    back = rotate(points, -np.array([0.7, 0.2]))
    np.testing.assert_allclose(back, low_discrepancy(64), atol=1e-12)
