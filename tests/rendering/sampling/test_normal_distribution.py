"""Sampling by D, beyond what every strategy has to do."""

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID, Table
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.normal_distribution import half_vectors, mixture
from npfm.rendering.sampling.strategy import Given

GGX = 1 / (np.cos(MERL.theta_h) ** 4 * (1 + (np.tan(MERL.theta_h) / 0.1) ** 2) ** 2)


def test_shares_are_those_that_a_material_is_made_of():
    """A surface that reflects D about theta_h alone has that D for half vectors."""
    wide = np.exp(-(MERL.theta_h**2))
    cos_i, cos_o = (np.maximum(c, 1e-3) for c in MERL.cosines)
    measure = half_vectors(Table(np.broadcast_to(1 / (cos_i * cos_o), (3, *MERL.shape)), MERL))
    whole = -np.diff(np.cos(MERL.theta_h_edges)) * np.cos(MERL.theta_h)
    brdf = (GGX + 0.2 * wide)[:, None, None] / (cos_i * cos_o)
    brdf = brdf * (whole / np.maximum(measure, 1e-9))[:, None, None]
    values = np.where(MERL.above_horizon, brdf, INVALID)
    found = mixture(Table(np.broadcast_to(values, (3, *MERL.shape)), MERL), np.stack([GGX, wide]))
    inner = MERL.theta_h < 1.2
    expected = (GGX + 0.2 * wide)[inner]
    np.testing.assert_allclose(found[inner] / found[0], expected / expected[0], rtol=0.02)


def test_a_black_material_is_sampled_by_all_lobes():
    black = Table(np.where(MERL.above_horizon, np.zeros((3, *MERL.shape)), INVALID), MERL)
    assert (mixture(black, np.stack([GGX, GGX**0.1])) > 0).all()


def test_a_fit_without_a_d_is_refused():
    given = Given(Environment(np.ones((4, 8, 3))), MERL, Table(np.zeros((3, *MERL.shape)), MERL))
    with pytest.raises(NpfmError, match="needs the parameters"):
        registry.make(["normal-distribution"], given)
    given = Given(given.environment, MERL, given.table, {"B": np.ones((3, 90, 90))})
    with pytest.raises(NpfmError, match="needs a fit with a D"):
        registry.make(["normal-distribution"], given)


def test_strategies_of_one_d_refuse_several():
    table = Table(np.zeros((3, *MERL.shape)), MERL)
    given = Given(Environment(np.ones((4, 8, 3))), MERL, table, {"D": np.ones((1, 3, 90))})
    with pytest.raises(NpfmError, match="choose 'normal-distribution'"):
        registry.make(["quantiles"], given)
