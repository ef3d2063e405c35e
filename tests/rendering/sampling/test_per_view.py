"""Slices of the view, beyond what the harness asks of every strategy."""

from typing import ClassVar

import numpy as np
import pytest
from shaded import above_horizon, point

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.rendering.sampling.cosine import CosineSampling
from npfm.rendering.sampling.per_view import WHITE_SHARE, PerViewSampling

GRID = HalfDifference(18, 18, 36)


def constant(value):
    return Table(np.full((3, *GRID.shape), value), GRID)


def variance(strategy, at, table, count=200_000):
    """N Var of reflected even light: variance of one sample over the squared mean."""
    light = strategy.sample(np.random.default_rng(1).random((1, count, 2)), at)
    frame = at.view_frame[0].T
    view = np.broadcast_to(at.view @ frame, (count, 3))
    brdf = table.lookup(light[0] @ frame, view)[1]
    values = brdf * np.maximum(at.cosines(light), 0)[0] / strategy.pdf(light, at)[0]
    return values.var() / values.mean() ** 2


@pytest.mark.parametrize("value", [0.3, 0.0, INVALID])
def test_a_material_without_a_shape_is_sampled_by_the_cosine(value):
    at = point(35.0)
    light, _ = above_horizon(at, 1 << 12)
    density, expected = (
        s.pdf(light[None], at) for s in (PerViewSampling(constant(value)), CosineSampling())
    )
    # Each texel has the cosine of its middle, half a degree off at most.
    np.testing.assert_allclose(density, expected, atol=0.01 / np.pi)


@pytest.mark.parametrize("theta_o", [5.5, 40.5, 70.5])
def test_even_light_on_a_glossy_material_has_next_to_no_variance(theta_o):
    """At the middle of a slice, where only texels and the white share are inexact."""
    theta_h = MERL.theta_h[:, None, None]
    values = np.broadcast_to(0.05 + 3 * np.exp(-((theta_h / 0.15) ** 2)), (3, *MERL.shape))
    table, at = Table(np.array(values)), point(theta_o)
    found = variance(PerViewSampling(table), at, table)
    assert found < 0.02
    assert found < 0.05 * variance(CosineSampling(), at, table)


def test_a_share_of_the_directions_is_a_white_surfaces_whatever_the_material_is():
    values = np.zeros((3, *GRID.shape))
    values[:, :1] = 100.0
    at = point(41.0)
    light, _ = above_horizon(at, 1 << 12)
    density = PerViewSampling(Table(values, GRID)).pdf(light[None], at)[0]
    white = PerViewSampling(constant(1.0)).pdf(light[None], at)[0]
    assert (density >= WHITE_SHARE * white * (1 - 1e-9)).all()
    assert np.median(density / white) == pytest.approx(WHITE_SHARE)


def test_an_anisotropic_table_is_refused():
    class Turned(HalfDifference):
        anisotropic: ClassVar[bool] = True

    grid = Turned(4, 4, 4)
    with pytest.raises(NpfmError, match="is for isotropic tables, not for one on"):
        PerViewSampling(Table(np.ones((3, 4, 4, 4)), grid))
