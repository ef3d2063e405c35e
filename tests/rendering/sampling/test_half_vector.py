import numpy as np
import pytest
from shaded import above_horizon, point, smooth, unit

from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.low_discrepancy import low_discrepancy

POINTS = 1 << 14


def integral(function, at):
    light, measure = above_horizon(at)
    return function(light) @ measure


@pytest.mark.parametrize("theta_o", [0.0, 20.0, 65.0, 87.0])
@pytest.mark.parametrize("tilt", [(0, 0, 0), (2, 0, 0), (0, -2, 1)])
def test_half_vector_samples_have_their_density(theta_o, tilt):
    at = point(theta_o)
    strategy, function = HalfVectorSampling(MERL), smooth(at, tilt)
    light = strategy.sample(low_discrepancy(POINTS)[None], at)
    estimate = (function(light) / strategy.pdf(light, at)).mean()
    assert estimate == pytest.approx(integral(function, at), rel=0.01)


@pytest.mark.parametrize("theta_o", [0.0, 50.0, 88.0])
def test_half_vectors_fill_the_bins_evenly_and_all_lights_are_above_the_horizon(theta_o):
    at = point(theta_o)
    light = HalfVectorSampling(MERL).sample(low_discrepancy(POINTS)[None], at)[0]
    np.testing.assert_allclose(np.linalg.norm(light, axis=1), 1)
    assert (light @ at.normal[0] > 0).all()
    half = light + at.view
    cosine = (half @ at.normal[0]) / np.linalg.norm(half, axis=1)
    bins = (np.sqrt(np.degrees(np.arccos(np.minimum(cosine, 1))) / 90) * 90).astype(int)
    count = int(np.ceil(90 * np.sqrt((45 + theta_o / 2) / 90)))
    np.testing.assert_allclose(np.bincount(bins), POINTS / count, rtol=0.03)


def test_half_vector_density_is_zero_below_the_horizon():
    at = point(40.0)
    light = unit(np.cross(at.normal[0], [1, 0, 0])) - 0.2 * at.normal[0]
    density = HalfVectorSampling(MERL).pdf(unit(light)[None, None], at)
    np.testing.assert_array_equal(density, [[0]])


def test_half_vectors_follow_the_grid():
    at = point(30.0)
    strategy = HalfVectorSampling(HalfDifference(10, 10, 20))
    light = strategy.sample(low_discrepancy(POINTS)[None], at)
    function = smooth(at, (0, 0, 0))
    estimate = (function(light) / strategy.pdf(light, at)).mean()
    assert estimate == pytest.approx(integral(function, at), rel=0.01)
