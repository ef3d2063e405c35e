"""What is special about shared lobes; the rest is in the harness."""

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import independent_g, shared_lobes
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table


def fit_with(table, seed=1, solver="gauss-newton", **settings):
    return shared_lobes.fit(table, Objective(), chosen(SolverSettings(solver)), seed, **settings)


@pytest.fixture(scope="module")
def fitted(table):
    return fit_with(table)


def test_the_paper_counts_822_numbers_six_more_than_independent_g():
    assert shared_lobes.parameter_count(MERL) == 822
    assert shared_lobes.parameter_count(MERL) - independent_g.parameter_count(MERL) == 6


def test_three_lobes_explain_more_than_one(table, fitted):
    one = fit_with(table, lobes=1)
    three = np.mean([record.objective for record in fitted.records])
    assert three < 0.5 * np.mean([record.objective for record in one.records])


def test_lobes_are_sorted_by_width_and_none_is_dead(table, fitted):
    widths = (fitted.parameters["D"][0] @ table.grid.theta_h) / fitted.parameters["D"][0].sum(1)
    assert (np.diff(widths) > 0).all()
    assert (fitted.parameters["rho_s"] > 0).all()


def test_permuted_channels_give_permuted_fits_to_the_last_bit(table, fitted):
    order = [1, 2, 0]
    permuted = fit_with(Table(table.values[order], table.grid))
    for name, array in fitted.parameters.items():
        expected = array if len(array) == 1 else array[order]
        assert np.array_equal(permuted.parameters[name], expected), name


def test_a_spline_is_kept_with_the_fit(table, fitted):
    splined = fit_with(table, spline=1, starts=1)
    assert splined.parameters["spline"] == [1]
    assert splined.parameter_count == shared_lobes.parameter_count(table.grid, spline=1)
    for channel, record in enumerate(splined.records):
        samples = channel_samples(table, channel, Objective())
        made = shared_lobes.tabulate(splined).values[channel] / samples.scale
        assert evaluate(samples, made) / samples.energy == pytest.approx(record.objective)
    assert "spline" not in fitted.parameters


def test_lobes_of_its_own_fit_each_channel_by_itself(table, fitted):
    own = fit_with(table, shared=0, starts=2)
    assert own.parameters["D"].shape == (3, *fitted.parameters["D"].shape[1:])
    assert own.parameter_count == shared_lobes.parameter_count(table.grid, shared=0)
    for channel, record in enumerate(own.records):
        alone = fit_with(Table(table.values[[channel] * 3], table.grid), shared=0, starts=2)
        for name, array in own.parameters.items():
            assert np.array_equal(alone.parameters[name][0], array[channel]), name
        samples = channel_samples(table, channel, Objective())
        made = shared_lobes.tabulate(own).values[channel] / samples.scale
        assert evaluate(samples, made) / samples.energy == pytest.approx(record.objective)
        assert record.objective < 1.02 * fitted.records[channel].objective


@pytest.mark.parametrize(
    "wrong",
    [{"lobes": 0}, {"lobes": 6}, {"starts": 0}, {"starts": 4}, {"spline": 2}, {"shared": 2}],
)
def test_settings_out_of_range_are_refused(table, wrong):
    with pytest.raises(NpfmError, match=f"shared-lobes with {next(iter(wrong))}"):
        fit_with(table, **wrong)
