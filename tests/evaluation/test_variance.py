"""Variances of all ways by points that they share, against one way after another, many times."""

from dataclasses import replace

import numpy as np
import pytest
from shaded import above_horizon, point

from npfm.evaluation import variance
from npfm.evaluation.variance import Combined, Integral, repeated, single
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.rendering.lights.environment import LUMINANCE, Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given

GRID = HalfDifference(18, 18, 36)
NAMES = ("cosine", "uniform", "light", "half-vector", "per-view")
WAYS = (
    *(Combined((name,)) for name in NAMES),
    Combined(("light", "half-vector")),
    Combined(("per-view", "light", "uniform"), 2.0),
)


@pytest.fixture(scope="module")
def integral():
    """Two points of a glossy material in an uneven light."""
    theta_h, theta_d = GRID.theta_h[:, None, None], GRID.theta_d[:, None]
    lobe = 4 * np.exp(-((theta_h / 0.2) ** 2)) * (0.1 + 0.9 * (1 - np.cos(theta_d)) ** 5)
    colours = np.array([0.3, 1.0, 0.6]).reshape(3, 1, 1, 1)
    values = np.where(GRID.above_horizon, colours * (0.1 + lobe), INVALID)
    light = Environment(0.1 + np.random.default_rng(5).random((8, 16, 3)) ** 4)
    ends = [vars(point(theta_o)) for theta_o in (25.0, 65.0)]
    both = {name: np.concatenate([end[name] for end in ends]) for name in ends[0]}
    return Integral(replace(point(0.0), **both), light, Table(values, GRID))


@pytest.fixture(scope="module")
def strategies(integral):
    given = Given(integral.environment, GRID, integral.table)
    return dict(zip(NAMES, registry.make(NAMES, given), strict=True))


@pytest.fixture(scope="module")
def exact(integral, strategies):
    return single(WAYS, strategies, integral, ("light", "half-vector"), 2048, 1)


def test_the_mean_is_the_integral(integral, exact):
    for k in range(2):
        one = integral[k : k + 1]
        light, measure = above_horizon(one.at)
        (frame,) = one.at.view_frame
        local, view = light @ frame.T, np.broadcast_to(frame @ one.at.view[0], light.shape)
        brdf = one.table.lookup(local, view)
        reflected = (LUMINANCE[:, None] * brdf * one.environment.lookup(light).T).sum(0)
        assert exact[1][k] == pytest.approx(reflected * local[:, 2] @ measure, rel=2e-3)


@pytest.mark.parametrize("k", range(len(WAYS)))
def test_independent_trials_have_the_same_variance(integral, strategies, exact, k):
    samples, copies, repetitions = len(WAYS[k].strategies), 1000, 40
    many = replace(integral, at=integral.at[np.repeat([0, 1], copies)])
    trials, used, seconds = repeated(
        WAYS[k], strategies, many, samples, repetitions, 2, stratified=False
    )
    assert used == samples and seconds > 0
    trials = trials.reshape(repetitions, 2, copies).swapaxes(1, 2).reshape(-1, 2)
    squares = used * (trials - trials.mean(axis=0)) ** 2
    spread = squares.std(axis=0) / np.sqrt(len(trials))
    expected = exact[0][:, k].mean(axis=0)
    np.testing.assert_array_less(abs(squares.mean(axis=0) - expected), 4 * spread + 5e-3 * expected)
    error = trials.std(axis=0) / np.sqrt(len(trials))
    np.testing.assert_array_less(abs(trials.mean(axis=0) - exact[1]), 4 * error)


def test_what_a_strategy_follows_exactly_has_no_variance(integral, strategies):
    even = replace(
        integral,
        environment=Environment(np.ones((8, 16, 3))),
        table=Table(np.full((3, *GRID.shape), 0.2), GRID),
    )
    found, mean = single(WAYS[:2], strategies, even, ("light", "half-vector"), 1024, 1)
    # Cells at the horizon have no value, and cost a little.
    np.testing.assert_allclose(mean, 0.2 * np.pi, rtol=5e-3)
    np.testing.assert_allclose(found[:, 0] / mean**2, 0, atol=2e-2)
    # Of uniform directions: 4/3 - 1.
    np.testing.assert_allclose(found[:, 1].mean(axis=0) / mean**2, 1 / 3, rtol=1e-2)


def test_stratified_points_have_less_variance(integral, strategies):
    way = WAYS[3]
    even, alone = (
        repeated(way, strategies, integral, 64, 200, 3, stratified=stratified)[0]
        for stratified in (True, False)
    )
    assert (even.var(axis=0) < 0.5 * alone.var(axis=0)).all()


def test_blocks_of_points_change_nothing(integral, strategies, monkeypatch):
    arguments = WAYS, strategies, integral, ("light", "half-vector"), 64, 1
    whole = single(*arguments)
    monkeypatch.setattr(variance, "BLOCK", 1)
    for one, other in zip(single(*arguments), whole, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)


def test_samples_are_shared_evenly(integral, strategies):
    estimates, used, _ = repeated(WAYS[-1], strategies, integral, 10, 3, 1)
    assert used == 9 and estimates.shape == (3, 2)


def test_an_interval_is_two_standard_errors_about_the_mean():
    assert variance.interval(np.array([1.0, 2.0, 3.0])) == pytest.approx(
        (2, 2 - 2 / np.sqrt(3), 2 + 2 / np.sqrt(3))
    )
