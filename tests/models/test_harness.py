"""What every model of the registry must do, on one small measurement."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from npfm.fitting import fits, registry
from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.fitting.solvers.choice import SOLVERS, chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import CHANNELS, INVALID, Table

#: Bytes of a material (section 3 of Bagher et al. 2016, and its rule for the others).
BYTES = {"independent-g": 3264, "g-from-d": 2184, "naive": 4344, "bivariate": 97200}
#: The paper's starts of independent-g (section 5), one of our own among them.
STARTS = {
    "independent-g": {
        *(f"random-{k}" for k in range(1, 5)),
        "ones",
        "g-from-d",
        "slices",
        "slices-smith",
    },
    "g-from-d": {"slices", "slices-flat"},
    "naive": {"ones"},
    "bivariate": {"closed form"},
}
#: Parameters that are curves of maximum 1.
FACTORS = {"D", "F", "G", "H"}
#: What is read from a file of its authors is no fit.
MODELS = {name: model for name, model in registry.models().items() if not model.published}

every_model = pytest.mark.parametrize("name", MODELS)
every_minimiser = pytest.mark.parametrize("name", [n for n in MODELS if MODELS[n].objective])
#: A model that is made out of the fit of another has no parameter to spare for a single sample.
every_fitted_model = pytest.mark.parametrize("name", [n for n in MODELS if not MODELS[n].converted])
every_solved_model = pytest.mark.parametrize("name", [n for n in MODELS if MODELS[n].solver])


@pytest.fixture(scope="session")
def fitted(table):
    """Fit of the shared table by the name of a model, made once."""

    @cache
    def fit(name):
        return fit_with(name, table)

    return fit


@pytest.fixture(scope="session")
def refitted(fitted):
    """Fit of the table of that fit, which a model of its kind meets exactly."""

    @cache
    def fit(name):
        return fit_with(name, tabulate(fitted(name)))

    return fit


def fit_with(name, table, seed=1, **settings):
    model = registry.model(name)
    return model.fit(table, Objective(), chosen(SolverSettings(**settings)), seed)


def tabulate(fit):
    return registry.model(fit.model).tabulate(fit)


def relative_objective(table, model, channel):
    """Sample by sample, nothing folded: the independent word on a fit."""
    samples = channel_samples(table, channel, Objective())
    return evaluate(samples, model.values[channel] / samples.scale) / (samples.energy or 1.0)


def best_constant(table, channel):
    samples = channel_samples(table, channel, Objective())
    mean = np.sum(samples.weight * samples.value) / np.sum(samples.weight)
    return evaluate(samples, np.full(table.grid.shape, mean)) / (samples.energy or 1.0)


def shaped(grid, *channels):
    """A table of three channels, invalid below the horizon."""
    return Table(np.stack([np.where(grid.above_horizon, v, INVALID) for v in channels]), grid)


@every_model
def test_parameters_are_what_they_should_be(fitted, name):
    fit = fitted(name)
    assert fit.model == name
    assert set(MODELS[name].coefficients) <= fit.parameters.keys()
    for key, array in fit.parameters.items():
        assert array.dtype == np.float32
        assert array.shape[0] == (1 if key in MODELS[name].shared else 3)
        assert np.isfinite(array).all()
        assert key in MODELS[name].signed or (array >= 0).all(), key
    clamp = np.float32(getattr(registry.model(name), "CLAMP", 0))
    for key in FACTORS & fit.parameters.keys():
        assert (fit.parameters[key].max(axis=-1) == 1).all(), key
        assert (fit.parameters[key] >= clamp).all(), key


@every_model
def test_tables_are_valid_above_the_horizon_and_nowhere_else(fitted, name):
    fit = fitted(name)
    table = tabulate(fit)
    assert table.grid == fit.grid
    assert np.isfinite(table.values).all()
    assert (table.valid == fit.grid.above_horizon).all()


@every_model
def test_reciprocity(fitted, name):
    values = tabulate(fitted(name)).values
    assert np.array_equal(values, values[..., ::-1]) == MODELS[name].reciprocal


@every_model
def test_a_fit_of_its_own_table_is_exact(fitted, refitted, name):
    """Whatever a model has fitted it can fit again, without the noise."""
    table, again = tabulate(fitted(name)), tabulate(refitted(name))
    for channel in range(3):
        assert relative_objective(table, again, channel) < MODELS[name].own_table


@every_model
def test_parameter_count(fitted, name):
    fit = fitted(name)
    count = registry.model(name).parameter_count
    assert fit.parameter_count == count(fit.grid)
    assert fit.parameter_bytes == 4 * count(fit.grid)
    if name in BYTES:
        assert 4 * count(MERL) == BYTES[name]


def test_the_papers_models_are_all_there():
    assert BYTES.keys() <= set(MODELS)


@every_model
def test_the_same_seed_gives_the_same_bytes_and_any_seed_where_no_start_is_random(
    tmp_path, table, fitted, name
):
    fits.save(tmp_path / "one.npz", fitted(name))
    fits.save(tmp_path / "two.npz", fit_with(name, table, seed=1 if MODELS[name].random else 2))
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()


@every_model
def test_permuted_channels_give_permuted_fits(table, fitted, name):
    order = [2, 0, 1]
    permuted = fit_with(name, Table(table.values[order], table.grid))
    if MODELS[name].shared:
        # The channels are summed in another order, and in a flat valley a run ends elsewhere.
        found, expected = tabulate(permuted).values, tabulate(fitted(name)).values[order]
        np.testing.assert_allclose(found, expected, rtol=0.1)
        for record, channel in zip(permuted.records, order, strict=True):
            before = fitted(name).records[channel].objective
            assert record.objective == pytest.approx(before, rel=2e-3)
        return
    for key, array in fitted(name).parameters.items():
        assert np.array_equal(permuted.parameters[key], array[order]), key


@every_model
def test_a_brighter_table_has_larger_coefficients_and_nothing_else(table, fitted, name):
    """By a power of two, so that not even rounding differs."""
    brighter = fit_with(name, Table(np.where(table.valid, 8 * table.values, INVALID), table.grid))
    factors = {key: 8 if key in MODELS[name].coefficients else 1 for key in brighter.parameters}
    same = [
        np.array_equal(brighter.parameters[key], factors[key] * array)
        for key, array in fitted(name).parameters.items()
    ]
    assert all(same) == MODELS[name].scale_free


@every_model
def test_invalid_entries_do_not_matter(table, fitted, name):
    """Neither what negative number marks them, nor what lies beyond 89 degrees."""
    lowest = np.minimum(*table.grid.cosines)
    values = np.where(table.valid, table.values, -1e30)
    values[:, lowest < np.cos(np.deg2rad(89))] = 1e6
    other = fit_with(name, Table(values, table.grid))
    for key, array in fitted(name).parameters.items():
        assert np.array_equal(other.parameters[key], array), key


@every_minimiser
@pytest.mark.parametrize("channel", range(3))
def test_a_fit_beats_the_best_constant(table, fitted, name, channel):
    found = relative_objective(table, tabulate(fitted(name)), channel)
    assert found < best_constant(table, channel)


def odd_tables(grid):
    """Values that leave a model little to hold on to, one a channel."""
    theta_h, (cos_i, cos_o) = grid.theta_h[:, None, None], grid.cosines
    noise = np.random.default_rng(5).random(grid.shape)
    one_cell = np.arange(grid.size).reshape(grid.shape) == 1111
    return {
        "white, noise, dark spot": (1 / np.pi, noise, 1 - 0.9 * np.exp(-30 * theta_h**2)),
        "dark or bright at grazing angles, a mirror": (
            np.minimum(cos_i, cos_o),
            1 / (0.05 + np.abs(cos_i * cos_o)),
            1e-3 + 1e3 * (theta_h < 0.02),
        ),
        "one bright cell, black but for a highlight, a step": (
            0.7 * one_cell,
            1.0 * (theta_h < 0.3),
            1.0 + (cos_i > cos_o),
        ),
    }


@every_minimiser
@pytest.mark.parametrize("kinds", odd_tables(HalfDifference(18, 18, 36)))
def test_odd_tables_are_fitted_no_worse_than_by_a_constant(grid, name, kinds):
    table = shaped(grid, *odd_tables(grid)[kinds])
    fit = fit_with(name, table)
    assert all(np.isfinite(array).all() for array in fit.parameters.values())
    for channel in range(3):
        found = relative_objective(table, tabulate(fit), channel)
        assert found <= best_constant(table, channel) + 1e-8


@every_model
def test_black_is_black(grid, name):
    fit = fit_with(name, shaped(grid, 0.0, 0.0, 0.0))
    values = tabulate(fit).values
    assert (values[:, grid.above_horizon] == 0).all()
    assert all(record.objective == record.objective_floor == 0 for record in fit.records)


@every_fitted_model
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_single_sample_is_met(grid, name, solver):
    """Everything else has to be filled in; nothing may divide by what is not there."""
    values = np.full((3, *grid.shape), INVALID)
    values[:, 3, 4, 5] = [0.5, 1.0, 2.0]
    table = Table(values, grid)
    fit = fit_with(name, table, method=solver)
    model = tabulate(fit).values
    assert np.isfinite(model).all()
    np.testing.assert_allclose(model[:, 3, 4, 5], values[:, 3, 4, 5], rtol=1e-4)


@every_model
def test_gaps_are_filled_in(table, name):
    """The fit's table is what was fitted: the record says the same of it."""
    values = table.values.copy()
    values[0, :, :4] = INVALID  # near retro-reflection
    values[1, [0, 1, 7, 16, 17]] = INVALID  # half vectors
    values[2, np.maximum(*table.grid.cosines) > 0.5] = INVALID  # all but grazing angles
    gaps = Table(values, table.grid)
    fit = fit_with(name, gaps)
    model = tabulate(fit)
    assert (model.valid == table.grid.above_horizon).all()
    for channel, record in enumerate(fit.records):
        found = relative_objective(gaps, model, channel)
        assert found == pytest.approx(record.objective, rel=1e-5)
        if MODELS[name].objective:
            assert found < best_constant(gaps, channel)


@every_model
def test_records_are_complete(fitted, name):
    fit = fitted(name)
    assert tuple(record.channel for record in fit.records) == CHANNELS
    for record in fit.records:
        starts = [trace.start for trace in record.traces]
        assert len(starts) == len(set(starts))
        assert set(starts) == STARTS.get(name, set(starts))
        assert record.best_start in starts
        assert record.status == "converged"
        assert record.seconds > 0
        for trace in record.traces:
            assert len(trace.seconds) == len(trace.objective) >= 1
            assert list(trace.seconds) == sorted(trace.seconds)
            assert list(trace.objective) == sorted(trace.objective, reverse=True)
            assert trace.seconds[-1] <= record.seconds
            assert trace.iterations >= len(trace.objective) - 1


@every_model
def test_the_record_is_true(table, fitted, name):
    """Its objective is that of the stored table, its best start the one that led there."""
    fit = fitted(name)
    model = tabulate(fit)
    for channel, record in enumerate(fit.records):
        found = relative_objective(table, model, channel)
        assert record.objective == pytest.approx(found, rel=1e-5)
        best = next(trace for trace in record.traces if trace.start == record.best_start)
        if MODELS[name].shared and MODELS[name].solver:  # all channels are fitted in one run
            mean = np.mean([record.objective for record in fit.records])
            assert best.objective[-1] == pytest.approx(mean, rel=1e-5)
        else:
            assert best.objective[-1] == record.objective
        assert best.status == record.status


@every_model
def test_the_floor_is_that_of_the_table(table, fitted, name):
    for channel, record in enumerate(fitted(name).records):
        samples = fold(channel_samples(table, channel, Objective()))
        assert record.objective_floor == pytest.approx(samples.floor / samples.energy, rel=1e-12)
        assert record.objective_floor > 0
        if MODELS[name].reciprocal:
            assert record.objective >= record.objective_floor


@every_model
def test_no_objective_is_negative(refitted, name):
    """Of a table that the model fits exactly only rounding is left, and no less than 0."""
    for record in refitted(name).records:
        assert min(min(trace.objective) for trace in record.traces) >= 0


@every_solved_model
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_run_that_meets_the_cap_says_so(table, name, solver):
    one = Table(table.values[[0, 0, 0]], table.grid)
    fit = fit_with(name, one, method=solver, max_iterations=2, tolerance=1e-12)
    for record in fit.records:
        said = {trace.status for trace in record.traces}
        assert record.status in said
        # AWLS may find nothing lower before it meets the cap.
        assert "iteration cap" in said <= {"iteration cap", "stalled"}


@every_solved_model
def test_awls_stops_when_nothing_is_left(grid, name):
    """Rounding is no reason to go on: a table without error is fitted before the cap."""
    fit = fit_with(name, shaped(grid, 0.1, 0.2, 0.3), method="awls", max_iterations=50)
    if fit.records[0].objective < 1e-14:
        assert fit.records[0].traces[0].status == "converged"


@every_model
def test_a_fit_comes_back_from_its_file(tmp_path, fitted, name):
    fit = fitted(name)
    fits.save(tmp_path / "fit.npz", fit)
    back = fits.load(tmp_path / "fit.npz")
    assert replace(fit, records=()).model == back.model
    assert np.array_equal(tabulate(back).values, tabulate(fit).values)


def test_random_starts_follow_the_seed(table):
    one, other = (
        fit_with("independent-g", Table(table.values, table.grid), seed, max_iterations=1)
        for seed in (1, 2)
    )
    first, second = (
        {trace.start: trace.objective[0] for trace in fit.records[0].traces} for fit in (one, other)
    )
    assert first["ones"] == second["ones"]
    assert all(first[f"random-{k}"] != second[f"random-{k}"] for k in range(1, 5))
