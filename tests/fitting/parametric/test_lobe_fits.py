"""Fits of lobes from several starts."""

from dataclasses import replace

import numpy as np
import pytest

from npfm.datasets import synthetic
from npfm.errors import NpfmError
from npfm.evaluation.hard_cases import CASES
from npfm.evaluation.stability import violations
from npfm.fitting import registry
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.parametric.author_metrics import Goal
from npfm.fitting.parametric.lobe_fits import COARSE, thinned
from npfm.reflectance.half_difference import HalfDifference


def goal(weight, grid):
    return Goal(weight, np.ones_like(weight), np.ones(len(weight)), False, grid)


@pytest.mark.parametrize("bins", [(90, 90, 180), (18, 18, 36)])
def test_the_samples_that_starts_are_compared_on_are_a_fair_part(bins):
    """Each bin of each angle has the share of them that it has of all samples."""
    grid = HalfDifference(*bins)
    counts = grid.above_horizon
    kept = np.zeros(grid.shape, dtype=bool)
    kept.flat[thinned(goal(counts[None], grid), COARSE)] = True
    assert kept.sum() == pytest.approx(COARSE, rel=0.01)
    assert not (kept & ~counts).any()
    for others in ((1, 2), (0, 2), (0, 1)):
        expected = kept.sum() * counts.sum(others) / counts.sum()
        # Of independent draws some would be further off than three times the root.
        assert (np.abs(kept.sum(others) - expected) <= 2 * np.sqrt(expected)).all()


def test_few_samples_are_all_kept(grid):
    weight = np.zeros((3, *grid.shape))
    weight[:, 3, 4, 5:9] = 1.0
    assert thinned(goal(weight, grid), COARSE).tolist() == np.flatnonzero(weight[0]).tolist()
    assert thinned(goal(0 * weight, grid), COARSE).size == 0


def test_no_channel_is_left_without_a_sample(grid):
    weight = np.stack([np.ones(grid.shape), np.zeros(grid.shape)])
    weight[1, 0, 0, 1] = 1.0
    assert weight[1].flat[thinned(goal(weight, grid), 100)].any()


@pytest.mark.parametrize("name", ["abc-ours", "ggx-fitted", "shifted-gamma"])
def test_no_fit_is_worse_than_a_constant(name):
    """Nor by a hair, though the shape is sought on some of the samples."""
    table = CASES["noise"](HalfDifference(45, 45, 90))
    fit = registry.model(name).fit(table, Objective(), None, 1)
    assert violations(table, fit, registry.model(name)) == []
    for channel, record in enumerate(fit.records):
        samples = channel_samples(table, channel, Objective())
        for scale in (0.999, 1.001):
            for key in ("rho_d", "rho_s"):
                other = replace(fit, parameters=fit.parameters | {key: fit.parameters[key] * scale})
                values = registry.model(name).tabulate(other).values[channel] / samples.scale
                assert evaluate(samples, values) / samples.energy >= record.objective - 1e-9


def test_samples_beyond_the_authors_angles_alone_are_refused(grid):
    table = CASES["only-grazing"](grid)
    with pytest.raises(NpfmError, match="red channel has no sample within the angles that cook"):
        registry.model("cook-torrance").fit(table, Objective(), None, 1)


def test_a_mirror_is_fitted_as_well_in_each_channel():
    """Started from one bin of phi_d alone, blue ended at 0.0333."""
    table = synthetic.load("mirror-metal", 1)
    fit = registry.model("shifted-gamma").fit(table, Objective(), None, 1)
    assert [record.objective for record in fit.records] == pytest.approx(3 * [0.0118], abs=2e-4)
