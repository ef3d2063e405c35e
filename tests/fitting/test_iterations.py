"""What a fit went through: nothing but its own states, and without a change of them."""

from dataclasses import replace

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting import iterations, registry
from npfm.fitting.iterations import FACTORS, Recorder
from npfm.fitting.objective import Objective
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.table import CHANNELS, Table

OF_STATES = ("channel", "start", "run", "objective", *FACTORS)


def fitted(table, model="independent-g", method="gauss-newton", **own):
    """A fit and its iterations."""
    recorder = Recorder(chosen(SolverSettings(method, 1e-3, 12)))
    fit = registry.model(model).fit(table, Objective(), recorder, 1, **own)
    return fit, recorder.iterations(fit)


def states(found, channel, start, run):
    """Which states are of a run."""
    of_start = found.start == found.names.index(start)
    return np.flatnonzero((found.channel == channel) & of_start & (found.run == run))


@pytest.fixture(scope="module")
def followed(table):
    return fitted(table)


@pytest.mark.parametrize("method", ["gauss-newton", "awls"])
def test_following_changes_nothing(table, method):
    fit, _ = fitted(table, method=method, starts=2)
    solve = chosen(SolverSettings(method, 1e-3, 12))
    alone = registry.model("independent-g").fit(table, Objective(), solve, 1, starts=2)
    for name, array in alone.parameters.items():
        assert array.tobytes() == fit.parameters[name].tobytes()
    for one, other in zip(alone.records, fit.records, strict=True):
        assert [t.objective for t in one.traces] == [t.objective for t in other.traces]


def test_each_run_has_the_objectives_of_its_trace(followed):
    fit, found = followed
    assert set(found.names) == {trace.start for trace in fit.records[0].traces}
    for channel, record in enumerate(fit.records):
        for trace in record.traces:
            last = trace.start == record.best_start
            at = states(found, channel, trace.start, int(last))
            np.testing.assert_array_equal(found.objective[at], trace.objective)
            coarse = states(found, channel, trace.start, 0)
            assert found.objective[coarse[-1]] == trace.end
            # A state each iteration, and the start of every run.
            assert len(coarse) - 1 + len(at) * last - last == trace.iterations


def test_the_last_state_of_the_best_start_is_the_fit(followed):
    fit, found = followed
    for channel, record in enumerate(fit.records):
        end = states(found, channel, record.best_start, 1)[-1]
        for name in FACTORS:
            factor = fit.parameters[name][channel]
            np.testing.assert_allclose(getattr(found, name)[end], factor / factor.max(), rtol=1e-6)


def test_a_lone_start_has_two_runs_one_after_the_other(table):
    fit, found = fitted(table, starts=1)
    assert found.names == ("random-1",)
    for channel, record in enumerate(fit.records):
        runs = found.run[found.channel == channel]
        assert (np.diff(runs) >= 0).all() and set(runs) == {0, 1}
        assert (runs == 1).sum() == len(record.traces[0].objective)


def test_awls_has_one_run_a_start_and_never_rises(table):
    _, found = fitted(table, method="awls", starts=2)
    assert set(found.run) == {0}
    for channel in range(len(CHANNELS)):
        for start in found.names:
            assert (np.diff(found.objective[states(found, channel, start, 0)]) <= 0).all()


def test_channels_that_are_black_are_kept_apart(table):
    values = table.values.copy()
    values[1:] = np.where(values[1:] >= 0, 0.0, -1.0)
    _, found = fitted(Table(values, table.grid), starts=2)
    _, counts = np.unique(found.channel, return_counts=True)
    assert len(counts) == 3 and counts[1] == counts[2] < counts[0]


def test_g_that_follows_from_d_is_followed_as_well(table):
    fit, found = fitted(table, "g-from-d")
    assert set(found.names) == {trace.start for trace in fit.records[0].traces}
    assert (np.diff(found.G, axis=1) <= 1e-12).all()


@pytest.mark.parametrize("model", ["naive", "low-rank-b"])
def test_models_without_the_three_factors_are_refused(table, model):
    with pytest.raises(NpfmError, match=r"no D, G and F .* leave --iterations out"):
        fitted(table, model)


def test_angles_are_those_of_the_components(followed, table):
    _, found = followed
    np.testing.assert_allclose(found.angles["D"], np.degrees(table.grid.theta_h))
    np.testing.assert_allclose(found.angles["F"], np.degrees(table.grid.theta_d))
    np.testing.assert_allclose(found.angles["G"], np.arange(90) + 0.5)


def test_a_record_comes_back_from_its_file(followed, tmp_path):
    _, found = followed
    iterations.save(tmp_path / "a.npz", found)
    back = iterations.load(tmp_path / "a.npz")
    assert back.names == found.names
    for name in OF_STATES:
        np.testing.assert_allclose(getattr(back, name), getattr(found, name), rtol=1e-7)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"channel": lambda a: a + 1}, "channel is not from 0 to 2"),
        ({"start": lambda a: a[:-1]}, "start is of shape"),
        ({"run": lambda a: a.astype(float)}, "run is of shape .* and type"),
        ({"objective": lambda a: a * np.nan}, "objective is not a finite number"),
        ({"D": lambda a: -a}, "D has values that no factor has"),
        ({"G": lambda a: a[:, :80]}, "G has 80 nodes, not 90"),
        ({"F": lambda a: a[0]}, "F is of shape"),
        ({"iterations": lambda a: np.array("other")}, "not a record of format"),
        ({"names": None}, "names"),
    ],
)
def test_a_damaged_record_is_refused_in_one_line(followed, tmp_path, change, message):
    _, found = followed
    iterations.save(tmp_path / "a.npz", replace(found))
    with np.load(tmp_path / "a.npz") as archive:
        arrays = dict(archive)
    for name, changed in change.items():
        array = arrays.pop(name)
        arrays |= {name: changed(array)} if changed else {}
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(NpfmError, match=message) as refused:
        iterations.load(tmp_path / "a.npz")
    assert "\n" not in str(refused.value) and "a.npz" in str(refused.value)
