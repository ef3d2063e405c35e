import numpy as np
import pytest
from shaded import above_horizon, point, unit

from npfm.reflectance.half_difference import MERL
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.combination import combine
from npfm.rendering.sampling.cosine import CosineSampling
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate
from npfm.rendering.sampling.uniform import UniformSampling
from npfm.rendering.shading import Shading

LIGHT = Environment(np.random.default_rng(5).random((8, 16, 3)) ** 4)


@pytest.mark.parametrize("power", [1, 2, 7.5, 1000])
def test_combined_strategies_estimate_an_integral_that_neither_is_made_for(power):
    at = point(60.0)
    both = Shading(normal=np.repeat(at.normal, 2, axis=0), view=np.repeat(at.view, 2, axis=0))
    strategies = [LightSampling(LIGHT), HalfVectorSampling(MERL)]
    points = np.stack([low_discrepancy(12000), rotate(low_discrepancy(12000), [0.3, 0.7])])
    light, density = combine(strategies, [points[:, :4000], points], both, power)
    assert light.shape == (2, 16000, 3)

    def function(direction):
        lobe = np.exp(20 * (direction @ unit([0.5, 0.8, -0.1]) - 1))
        return LIGHT.lookup(direction)[..., 1] * lobe * np.maximum(direction @ at.normal[0], 0)

    estimate = (function(light) / density).sum(axis=1)
    directions, measure = above_horizon(at)
    np.testing.assert_allclose(estimate, function(directions) @ measure, rtol=0.03)


@pytest.mark.parametrize("power", [1, 2, 3.5])
def test_weights_are_those_of_equation_21(power):
    """Of three strategies with numbers of their own; the density is n p over the weight."""
    at, numbers = point(40.0), [5, 3, 8]
    strategies = [CosineSampling(), UniformSampling(), HalfVectorSampling(MERL)]
    rng = np.random.default_rng(4)
    points = [rng.random((1, number, 2)) for number in numbers]
    _, density = combine(strategies, points, at, power)
    expected = []
    for k, (strategy, number) in enumerate(zip(strategies, numbers, strict=True)):
        for direction in strategy.sample(points[k], at)[0]:
            pdfs = [float(s.pdf(direction[None, None], at)[0, 0]) for s in strategies]
            terms = [(n * p) ** power for n, p in zip(numbers, pdfs, strict=True)]
            expected.append(number * pdfs[k] * sum(terms) / terms[k])
    np.testing.assert_allclose(density[0], expected, rtol=1e-10)


@pytest.mark.parametrize("power", [1, 2])
def test_samples_without_a_density_of_any_strategy_have_none(power):
    class Downwards(CosineSampling):
        def sample(self, u, at):
            return -super().sample(u, at)

    at, points = point(40.0), [low_discrepancy(16)[None]] * 2
    _, density = combine([Downwards(), CosineSampling()], points, at, power)
    np.testing.assert_array_equal(density[0, :16], 0)
    assert (density[0, 16:] > 0).all()
