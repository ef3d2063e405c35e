"""What must hold of every fit, for each hard case, model and solver, on a small grid."""

import os
import subprocess
import sys
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
import pytest

from npfm.commands.stability import fitted, methods
from npfm.errors import NpfmError
from npfm.evaluation import stability
from npfm.evaluation.hard_cases import CASES
from npfm.evaluation.metrics import psnr
from npfm.fitting import channels, fits, registry
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.merl import write_binary
from npfm.reflectance.table import CHANNELS, INVALID, Table
from npfm.rendering import assembly, transport
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene

ROOT = Path(__file__).parents[2]
GRID = HalfDifference(8, 8, 16)
STARTS = 2
#: Cases that are refused, and what the refusal says.
REFUSED = {
    "nan-entries": "red channel has entries that are NaN or infinite",
    "infinite-entries": "red channel has entries that are NaN or infinite",
    "too-dark-to-store": "red channel needs a coefficient",
}
FITTED = [case for case in CASES if case not in REFUSED]
#: Refused by some models only: their authors leave angles out.
OUT_OF_RANGE = {
    (model, "only-grazing"): "red channel has no sample within the angles"
    for model in ("blinn-phong", "cook-torrance", "ward")
}
#: Searches of SciPy's, and a logarithm taken in a unit of its own: rounding, or the order in
#: which channels are summed, can lead them elsewhere.
OTHERS = {
    "abc-e2",
    "abc-ours",
    "ashikhmin-shirley",
    "blinn-phong",
    "cook-torrance",
    "ggx-fitted",
    "lafortune",
    "shifted-gamma",
    "tucker-20",
    "ward",
}
#: An exponent of thousands makes the rounding of its base to float32 show in the objective; what is
#: recorded is of the rounded fit, which is not the unrounded one that is rounded afterwards.
ROUNDED_FIRST = {"lafortune"}
COEFFICIENTS = {"rho_d", "rho_s", "B", "U"}
#: Decibels beyond which two pictures count as the same.
EQUAL_DB = 100.0

MODELS = registry.fitted()
RUNS = [(model, method) for model in MODELS for method in methods(model)]

EXACT_RUNS = [run for run in RUNS if run[0] not in OTHERS]

every_case = pytest.mark.parametrize("case", FITTED)
every_run = pytest.mark.parametrize(("model", "method"), RUNS)
every_exact_run = pytest.mark.parametrize(("model", "method"), EXACT_RUNS)


def settings(method):
    return SolverSettings(method or SolverSettings.method, max_iterations=15)


def unrounded(table, model, solver):
    """A fit before it is rounded to float32."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(channels, "STORED", np.float64)
        return fitted(table, model, solver, STARTS)


@pytest.fixture(scope="module")
def exact():
    """Unrounded fit of a case, made once."""
    return cache(lambda case, model, method: unrounded(CASES[case](GRID), model, settings(method)))


def stored(fit):
    """The fit as a file holds it, or None if float32 cannot hold it."""
    if max(np.abs(array).max() for array in fit.parameters.values()) > np.finfo(np.float32).max:
        return None
    return replace(fit, parameters={k: a.astype(np.float32) for k, a in fit.parameters.items()})


@every_case
@every_run
def test_every_fit_is_sound(exact, case, model, method):
    if (model, case) in OUT_OF_RANGE:
        with pytest.raises(NpfmError, match=f"^the {OUT_OF_RANGE[model, case]}[^\n]*$"):
            fitted(CASES[case](GRID), model, settings(method), STARTS)
        return
    table, fit = CASES[case](GRID), stored(exact(case, model, method))
    if fit is not None and model in ROUNDED_FIRST:
        fit = fitted(table, model, settings(method), STARTS)
    if fit is None:
        assert case == "all-of-double-precision"
        with pytest.raises(NpfmError, match="channel needs a coefficient"):
            fitted(table, model, settings(method), STARTS)
    else:
        assert stability.violations(table, fit, registry.model(model)) == []


@pytest.mark.parametrize("case", REFUSED)
@every_run
def test_what_cannot_be_fitted_is_refused_in_one_line(case, model, method):
    with pytest.raises(NpfmError, match=f"^the {REFUSED[case]}[^\n]*$"):
        fitted(CASES[case](GRID), model, settings(method), STARTS)


@every_case
@every_exact_run
def test_scaled_and_permuted_channels_scale_and_permute_the_fit(exact, case, model, method):
    table, fit = CASES[case](GRID), exact(case, model, method)
    order, factor = [2, 0, 1], 2.0**-20
    values = np.where(table.valid, factor * table.values, INVALID)[order]
    other = unrounded(Table(values, GRID), model, settings(method))
    # Equal channels that are fitted together differ by rounding, each in its place.
    rounding = 1e-12 if registry.declared(model).shared else 0.0
    for key, array in fit.parameters.items():
        expected = (factor if key in COEFFICIENTS else 1.0) * array
        if key not in registry.declared(model).shared:
            expected = expected[order]
        least = rounding * np.abs(expected).max()
        np.testing.assert_allclose(other.parameters[key], expected, rounding, least, err_msg=key)
    for record, old in zip(other.records, (fit.records[k] for k in order), strict=True):
        assert record.status == old.status
        assert record.objective == pytest.approx(old.objective, rel=rounding, abs=0)


@pytest.fixture(scope="module")
def scene():
    light = Environment(np.random.default_rng(2).uniform(0, 1, (8, 16, 3)) ** 8)
    return assembly.build(Scene(("sphere",), ()), light, GRID, 10, 64, 1)


@every_case
@every_run
def test_float32_changes_no_psnr(exact, scene, case, model, method):
    if (model, case) in OUT_OF_RANGE:
        return
    table, fit = CASES[case](GRID), exact(case, model, method)
    if (rounded := stored(fit)) is None:  # refused
        return
    tabulate = registry.model(model).tabulate
    measured, before, after = (
        transport.render(scene, Table(np.where(table.valid, made.values, INVALID), GRID))
        for made in (table, tabulate(fit), tabulate(rounded))
    )
    inside = measured[..., 3] == 1
    if not measured[inside][:, :3].any():  # a black picture has no PSNR
        assert np.array_equal(before, after)
        return
    decibels = [psnr(x[..., :3], measured[..., :3], inside) for x in (before, after)]
    one, other = np.minimum(decibels, EQUAL_DB)
    assert other == pytest.approx(one, abs=0.05)


@every_exact_run
def test_another_unit_scales_the_fit(model, method):
    """By no power of two, so that every sample is rounded anew.

    A few iterations only: each can enlarge the difference. The golden sections of AWLS do most.
    """
    table, few = (
        CASES["channels-apart"](GRID),
        SolverSettings(method or SolverSettings.method, max_iterations=4),
    )
    larger = Table(np.where(table.valid, 3 * table.values, INVALID), GRID)
    one, other = (
        registry.model(model).tabulate(unrounded(x, model, few)).values[:, GRID.above_horizon]
        for x in (table, larger)
    )
    difference = np.abs(other / 3 - one).max(1) / one.max(1)
    # Lobes of one material can be exchanged a little for next to nothing.
    lobes = "lobes" in registry.declared(model).settings
    assert (difference < (1e-4 if lobes else 1e-6 if method == "awls" else 1e-9)).all()


@pytest.mark.parametrize(
    ("case", "status"),
    [
        ("black", "degenerate: every sample is 0"),
        ("constant", "degenerate: all samples are equal"),
        ("single-sample", "degenerate: one sample"),
        ("one-theta-h-row", "degenerate: samples in one bin of theta_h only"),
    ],
)
@every_run
def test_the_status_says_what_leaves_a_fit_open(exact, case, status, model, method):
    assert {record.status for record in exact(case, model, method).records} == {status}


def test_only_the_channel_that_is_degenerate_says_so(exact):
    records = exact("one-black-channel", "bivariate", "").records
    assert [r.status.partition(":")[0] for r in records] == ["converged", "degenerate", "converged"]
    assert tuple(record.channel for record in records) == CHANNELS


def test_one_thread_or_two_give_the_same_bytes(tmp_path):
    """Sums over the full grid are long enough for threads to share them."""
    write_binary(tmp_path / "noise.binary", CASES["noise"]())
    content = set()
    for threads in ("1", "2"):
        call = f"fit noise.binary --model naive --max-iterations 2 -o {threads}.npz".split()
        counts = {f"{name}_NUM_THREADS": threads for name in ("OMP", "OPENBLAS", "MKL")}
        environment = os.environ | counts | {"PYTHONPATH": str(ROOT)}
        subprocess.run(
            [sys.executable, "-m", "npfm", *call], cwd=tmp_path, env=environment, check=True
        )
        records = fits.load_record(tmp_path / f"{threads}.npz")["channels"]
        objectives = tuple(record.traces[0].objective for record in records)
        content.add(((tmp_path / f"{threads}.npz").read_bytes(), objectives))
    assert len(content) == 1


def row(case, model, method):
    """A row of the table, on the small grid."""
    table = CASES[case](GRID)
    fit = partial(fitted, table, model, settings(method), STARTS)
    return stability.row(case, table, registry.model(model), method, fit)


@every_run
def test_a_row_of_the_table(model, method):
    entry = row("outliers", model, method)
    assert entry["finite"]
    assert entry["objective_floor"] > 0
    if registry.declared(model).reciprocal:
        assert entry["objective_floor"] <= entry["objective"]
    assert entry["objective"] < 1 or not registry.declared(model).objective
    assert entry["seconds"] > 0
    if not registry.declared(model).solver:
        assert np.isnan(entry["condition"])
    else:
        assert entry["condition"] >= 1


def test_a_refusal_is_a_row_too():
    entry = row("nan-entries", "naive", "gauss-newton")
    assert entry["status"].startswith("refused: the red channel")
    assert entry["finite"] is entry["objective"] is entry["condition"] is None
