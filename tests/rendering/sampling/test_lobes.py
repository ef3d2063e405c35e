"""Sampling by fitted lobes: the fits of two models, and what is none of theirs."""

import numpy as np
import pytest
from shaded import above_horizon, point

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import HalfDifference
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given

FLAT = {"rho_d": np.full(3, 0.1), "rho_s": np.ones((3, 2)), "n": np.array([[40.0, 5.0]])}
PARAMETERS = {
    "lafortune": {**FLAT, "C_xy": -np.ones((1, 2)), "C_z": np.ones((1, 2))},
    "blinn-phong": {**FLAT, "F_0": np.array([[0.1, 0.5]])},
    "quantiles": {"D": np.ones((3, 18))},
}


def made(name, parameters):
    given = Given(Environment(np.ones((4, 8, 3))), HalfDifference(18, 18, 36), None, parameters)
    (strategy,) = registry.make([name], given)
    return strategy


@pytest.mark.parametrize("name", ["lafortune", "blinn-phong"])
def test_parameters_of_another_model_are_told_in_one_line(name):
    for wrong in ("quantiles", *{"lafortune", "blinn-phong"} - {name}):
        with pytest.raises(NpfmError, match="give one of that model"):
            made(name, PARAMETERS[wrong])


@pytest.mark.parametrize("name", ["lafortune", "blinn-phong"])
def test_a_fit_without_highlight_is_sampled_as_white(name):
    dull = {**PARAMETERS[name], "rho_s": np.zeros_like(PARAMETERS[name]["rho_s"])}
    at = point(40.0)
    light, _ = above_horizon(at, 1000)
    density = made(name, dull).pdf(light[None], at)[0]
    np.testing.assert_allclose(density, light @ at.normal[0] / np.pi)


def test_a_sharp_lobe_has_its_peak_in_the_mirror_direction():
    sharp = {**PARAMETERS["lafortune"], "n": np.full((1, 2), 5000.0)}
    sharp |= {"rho_d": np.zeros(3)}
    sharp["rho_s"] = np.tile([1.0, 0.0], (3, 1))
    at = point(50.0)
    light = made("lafortune", sharp).sample(np.array([[[0.5, 0.2]]]), at)[0, 0]
    mirror = 2 * at.cos_o * at.normal[0] - at.view[0]
    assert light @ mirror > 0.999
