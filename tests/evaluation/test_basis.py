"""What a number of curves reaches: the rows of one material, and the averages of many."""

from functools import partial

import numpy as np
import pandas as pd
import pytest
from lobed import GRID, lobes, many

from npfm.commands.basis import _own
from npfm.errors import NpfmError
from npfm.evaluation import basis as study
from npfm.evaluation import tables
from npfm.evaluation.metrics import psnr
from npfm.fitting import fits
from npfm.fitting.basis import library
from npfm.fitting.basis.lobes import parameters_of
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.registry import model as module_of
from npfm.fitting.solvers import gauss_newton
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.table import Table
from npfm.rendering import assembly
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import render

SOLVE = partial(gauss_newton.solve, settings=SolverSettings())
COUNTS = [3, 1]


@pytest.fixture(scope="module", params=["independent-g", "shared-lobes"])
def found(request):
    """A material, its own fit, the ways to its factors, and the table of a scene."""
    made, module = many(request.param), module_of(request.param)
    exact = module.tabulate(made["m1"])
    noise = 1 + 0.05 * np.random.default_rng(2).standard_normal(exact.values.shape)
    measured = Table(np.where(exact.values < 0, -1, exact.values * noise), GRID)
    others = library.gather(made, Objective()).without("m1")
    own = study.Own(made["m1"], 0.01, 2.5)
    ways = study.ways(measured, own, others, COUNTS, Objective(), SOLVE)
    light = Environment(np.random.default_rng(1).uniform(0.1, 1, (4, 8, 3)))
    matrix = assembly.build(Scene(("sphere",)), light, GRID, 8, 64, 1)
    return (
        measured,
        others,
        ways,
        matrix,
        study.measure(measured, ways, {"A": matrix}, module.tabulate),
    )


def test_every_way_has_a_row_and_every_size_is_counted(found):
    _, others, _, _, table = found
    assert tuple(table.columns) == study.MEASURED[2:]
    rows = list(zip(table["way"], table["curves"], strict=True))
    assert rows == [
        ("free", 0), ("fitted", 1), ("projected", 1), ("fitted", 3), ("projected", 3),
    ]  # fmt: skip
    for row in table[table["way"] == "fitted"].itertuples():
        assert row.bytes == 4 * row.unknowns == 4 * others.unknowns(row.curves)
        assert row.basis_bytes == 4 * (row.curves + 1) * (18 + 18 + 90)
        assert row.seconds > 0
    assert table.loc[0, ["seconds", "objective", "basis_bytes"]].tolist() == [2.5, 0.01, 0]


def test_objectives_are_those_of_the_tables_that_fits_make(found):
    measured, others, ways, _, _ = found
    tabulate = module_of(others.model).tabulate
    for way in ways[1::2]:
        made, shares = tabulate(way.fit), []
        for channel in range(3):
            samples = channel_samples(measured, channel, Objective())
            model = np.maximum(made.values[channel], 0) / samples.scale
            shares.append(evaluate(samples, model) / samples.energy)
        assert way.objective == pytest.approx(np.mean(shares), rel=1e-4)


def test_what_is_fitted_is_no_worse_than_what_is_laid_into_the_curves(found):
    _, _, ways, _, _ = found
    for fitted, laid in zip(ways[1::2], ways[2::2], strict=True):
        assert (fitted.name, laid.name) == ("fitted", "projected")
        assert fitted.objective <= laid.objective * (1 + 1e-2)


def test_no_more_curves_than_other_materials_make():
    made = many("independent-g")
    measured = module_of("independent-g").tabulate(made["m1"])
    alike = dict.fromkeys(("a", "b", "c"), made["m2"])
    for few, counts in ((alike, [0]), ({k: made[k] for k in ("m2", "m3", "m4")}, [1, 2])):
        others, own = library.gather(few, Objective()), study.Own(made["m1"], 0.01, 1.0)
        ways = study.ways(measured, own, others, [1, 7], Objective(), SOLVE)
        assert [way.curves for way in ways[1::2]] == counts
        assert all(np.isfinite(way.objective) for way in ways)
        assert [way.unknowns for way in ways[1::2]] == [9 * n + 6 for n in counts]


def test_pictures_are_those_of_the_fits(found):
    measured, others, ways, matrix, table = found
    reference = render(matrix, measured)[..., :3]
    for way, level in zip(ways, table["psnr_db"], strict=True):
        if way.fit is None:
            assert np.isnan(level)
            continue
        made = module_of(others.model).tabulate(way.fit).where_measured(measured)
        expected = psnr(render(matrix, made)[..., :3], reference, matrix.foreground)
        assert level == pytest.approx(expected, abs=1e-2)


def test_what_is_compiled_once_is_no_part_of_a_time(monkeypatch):
    begun = []

    def now():
        begun.append("time")
        raise TimeoutError

    monkeypatch.setattr(study, "compiled", lambda: begun.append("compiled"))
    monkeypatch.setattr(study.time, "process_time", now)
    with pytest.raises(TimeoutError):
        study.ways(None, None, None, COUNTS, Objective(), SOLVE)
    assert begun == ["compiled", "time"]


@pytest.mark.parametrize("shared", [True, False])
def test_a_fit_with_other_settings_than_those_of_the_basis_is_refused(tmp_path, shared):
    others = library.gather(many("shared-lobes"), Objective())
    groups = [lobes(0.2, 1, 0.5, 3, 3)] if shared else [lobes(0.2, 1, 0.5, 1, 2)] * 3
    arrays = parameters_of(groups, False)
    fit = Fit("shared-lobes", {k: v.astype(np.float32) for k, v in arrays.items()}, GRID)
    fits.save(tmp_path / "own.npz", fit)
    with pytest.raises(NpfmError, match=r"own.npz: a fit of another model, settings or grid"):
        _own(str(tmp_path / "own.npz"), others, Objective())


def rows(material, free, fitted, levels):
    """Two scenes of a material, with a fit of 5 curves."""
    head = material, "mine"
    return [
        row
        for scene, drop in (("A", 0), ("B", 10))
        for row in (
            (*head, "free", 0, 816, 3264, 0, 2.0, free, scene, levels[0] - drop),
            (*head, "fitted", 5, 51, 204, 6480, 1.0, fitted, scene, levels[1] - drop),
            (*head, "projected", 5, 51, 204, 6480, np.nan, 2 * fitted, scene, np.nan),
        )
    ]


def test_the_summary_averages_over_materials(tmp_path):
    for name, *numbers in (("a", 0.01, 0.02, (50, 48)), ("b", 0.04, 0.32, (40, 34))):
        table = pd.DataFrame(rows(name, *numbers), columns=study.MEASURED)
        tables.write(tmp_path / f"{name}.csv", table)
    found = study.summary(study.read([tmp_path / "a.csv", tmp_path / "b.csv"]))
    assert tuple(found.columns) == study.SUMMARY
    free, fitted, laid = found.to_dict("records")
    assert (free["way"], fitted["way"], laid["way"]) == ("free", "fitted", "projected")
    assert fitted["objective"] == pytest.approx(0.08) and free["times_free"] == pytest.approx(1)
    assert fitted["times_free"] == pytest.approx(4) and fitted["times_free_most"] == 8
    assert laid["times_free"] == pytest.approx(8) and np.isnan(laid["psnr_db"])
    assert (fitted["psnr_db"], fitted["db_lost"], fitted["db_lost_most"]) == (36, 4, 6)
    assert (fitted["materials"], fitted["bytes"], fitted["basis_bytes"]) == (2, 204, 6480)
    tables.write(tmp_path / "summary.csv", found)
    again = study.read_summary(tmp_path / "summary.csv")
    pd.testing.assert_frame_equal(again, found, check_dtype=False, rtol=1e-5)


def test_a_black_material_and_one_that_is_met_exactly_change_no_mean():
    table = pd.DataFrame(rows("a", 0.01, 0.02, (50, 48)), columns=study.MEASURED)
    black = pd.DataFrame(rows("black", 0.0, 0.0, (np.nan, np.nan)), columns=study.MEASURED)
    exact = pd.DataFrame(rows("exact", 0.01, 0.02, (np.inf, np.inf)), columns=study.MEASURED)
    alone, all_ = study.summary(table), study.summary(pd.concat([table, black, exact]))
    pd.testing.assert_frame_equal(all_.drop(columns="materials"), alone.drop(columns="materials"))
    assert all_["materials"].tolist() == [3, 3, 3]
