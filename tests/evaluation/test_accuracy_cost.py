import copy
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import accuracy_cost as costs
from npfm.evaluation import tables
from npfm.evaluation.metrics import psnr
from npfm.fitting.fits import ChannelRecord, Fit, Trace, save
from npfm.fitting.objective import Objective
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import g_from_d, independent_g
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, INVALID, Table
from npfm.rendering import assembly, transport
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import Transport
from npfm.run.accuracy_cost import plan
from npfm.run.config import check

DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())
GRID = HalfDifference(6, 5, 8)


def planned(**changes):
    return plan(check(copy.deepcopy(DEFAULT) | changes))


def test_starts_and_tolerances_are_those_asked_for_and_each_solver_has_its_variants():
    made = planned()
    assert list(made.stages) == ["model", "starts", "tolerance"]
    assert list(made.settings("starts")) == [str(n) for n in range(1, 9)]
    tolerances = [float(setting) for setting in made.settings("tolerance")]
    assert tolerances == [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7]
    by_solver = {"independent-g", "g-from-d", "naive"}
    expected = {f"{name}/{method}" for name in by_solver for method in ("awls", "gauss-newton")}
    assert expected | {"bivariate"} <= set(made.settings("model"))
    for n in range(1, 9):
        options = " ".join(made.study.variants[f"starts-{n}"].options)
        assert "--model independent-g --solver gauss-newton" in options
        assert f"--starts {n} " in options
    awls = " ".join(made.study.variants["model-independent-g-awls"].options)
    assert "--solver awls" in awls and "--max-iterations 60" in awls
    naive = " ".join(made.study.variants["model-naive-gauss-newton"].options)
    assert "--max-iterations 1000" in naive


def test_what_the_run_has_is_not_fitted_again_and_equal_settings_are_fitted_once():
    own = "results/default/fits/independent-g"
    made = planned()
    assert made.settings("starts")["8"] == own
    assert made.settings("tolerance")["1e-05"] == own
    assert made.settings("model")["independent-g/gauss-newton"] == own
    assert made.standard == own
    assert made.fits("chalk").count(f"{own}/chalk.npz") == 1
    without = planned(variants=["naive"])
    assert without.settings("starts")["8"] == without.settings("tolerance")["1e-05"]
    assert without.standard.startswith("results/default/accuracy_cost/fits/")


def test_a_variant_that_names_its_solver_keeps_it():
    old = {"name": "old", "model": "naive", "solver": {"method": "awls", "max_iterations": 7}}
    made = planned(variants=[old])
    assert [name for name in made.settings("model") if name.startswith("old")] == ["old/awls"]
    assert made.settings("model")["old/awls"] == "results/default/fits/old"


def test_materials_are_those_of_the_list_in_its_order_or_the_first_six():
    assert planned().materials == tuple(DEFAULT["accuracy_cost"]["materials"])
    few = planned(dataset={"kind": "synthetic", "materials": ["chalk", "pink-felt", "car-paint"]})
    assert few.materials == ("car-paint", "pink-felt")
    others = planned(dataset={"kind": "synthetic", "materials": ["chalk", "nylon"]})
    assert others.materials == ("chalk", "nylon")


def test_the_reference_has_more_samples_and_other_random_numbers():
    made = planned()
    assert len(made.builds) == 3 * 5
    options = " ".join(made.scene_options("half-vector-64"))
    assert "--samples 64 --seed 1 --sampling half-vector" in options
    reference = "--resolution 32 --samples 32768 --seed 2 --sampling light half-vector"
    assert reference in " ".join(made.scene_options("reference"))


def test_an_unknown_scene_is_refused():
    asked = DEFAULT["accuracy_cost"] | {"scene": "Z"}
    with pytest.raises(NpfmError, match="accuracy_cost/scene: unknown scene 'Z'"):
        planned(accuracy_cost=asked)


def a_fit(value, seconds):
    """A fit with two starts, the second of which is the better one."""
    traces = (
        Trace("ones", "converged", 1, 0, (0.0, seconds), (1.0, 0.5)),
        Trace("random-1", "iteration cap", 2, 0, (0.1, 0.2, seconds), (0.9, 0.7, 0.25)),
    )
    records = tuple(
        ChannelRecord(name, 3 * seconds, "random-1", 0.25, 0.1, "iteration cap", traces)
        for name in CHANNELS
    )
    return Fit("naive", {"value": np.full((3, 1), value, dtype=np.float32)}, GRID, records)


def test_traces_tell_thinned_runs_and_the_end_of_all_of_them(tmp_path):
    for method, seconds in (("awls", 4.0), ("gauss-newton", 1.0)):
        save(tmp_path / method / "felt.npz", a_fit(0.5, seconds))
    folders = {method: str(tmp_path / method) for method in ("gauss-newton", "awls")}
    made = costs.traces(folders, ["felt"])
    assert list(made.columns) == list(costs.TRACES)
    assert len(made) == 2 * 3 * (2 + 3 + 1)
    thinned = made[made["thinned"] == 1]
    assert set(zip(thinned["solver"], thinned["start"], strict=True)) == {("gauss-newton", "ones")}
    ends = made[made["start"] == costs.TOGETHER].set_index(["solver", "channel"])
    assert ends.loc[("awls", "red"), "seconds"] == 12.0
    assert ends.loc[("gauss-newton", "blue"), "objective"] == 0.25
    with pytest.raises(NpfmError, match=r"chrome\.json: cannot be read"):
        costs.traces(folders, ["chrome"])


@pytest.fixture
def matrix():
    """A made-up scene of 3 x 2 pixels, the last of which is half covered."""
    rng = np.random.default_rng(3)
    indptr = np.array([0, 4, 4, 9, 15, 20, 25])
    indices = np.concatenate(
        [np.sort(rng.choice(GRID.size, n, replace=False)) for n in np.diff(indptr)]
    )
    coverage = np.ones((3, 2), dtype=np.float32)
    backdrop = np.zeros((3, 2, 3), dtype=np.float32)
    coverage[2, 1], backdrop[2, 1] = 0.5, 7.0
    return Transport(
        indptr=indptr,
        indices=indices.astype(np.int32),
        weights=rng.random((3, 25)).astype(np.float32),
        coverage=coverage,
        backdrop=backdrop,
        grid=GRID,
    )


def a_table(seed):
    values = np.random.default_rng(seed).uniform(-0.2, 1, (3, *GRID.shape))
    return Table(np.where(values < 0, INVALID, values), GRID)


def test_many_tables_are_rendered_as_one_by_one(matrix):
    several = [a_table(seed) for seed in range(4)]
    values = transport.columns(several)
    expected = [transport.render(matrix, table)[..., :3] for table in several]
    np.testing.assert_allclose(transport.pictures(matrix, values), expected, rtol=1e-6)


def test_fits_are_compared_where_there_is_a_measurement(tmp_path, matrix):
    measured = a_table(1)
    fitted = {
        str(tmp_path / f"{k}.npz"): Table(np.full(a_table(1).values.shape, k / 4), GRID)
        for k in (1, 2)
    }
    for k, path in enumerate(fitted):
        save(path, a_fit(0.0, seconds=k + 1.0))
    one, two = fitted
    settings = {("model", "naive/awls"): one, ("starts", "1"): two, ("starts", "2"): one}
    asked = []

    def tabulate(path):
        asked.append(path)
        return fitted[path]

    made = costs.fits(measured, settings, {"A": matrix, "D": matrix}, tabulate)
    assert asked == [one, two]
    assert list(made.columns) == list(costs.FITS[1:])
    assert made["setting"].tolist() == ["naive/awls"] * 2 + ["1"] * 2 + ["2"] * 2
    assert made["seconds"].tolist() == [9.0] * 2 + [18.0] * 2 + [9.0] * 2
    assert set(made["bytes"]) == {12}
    masked = Table(np.where(measured.valid, fitted[two].values, INVALID), GRID)
    pictures = [transport.render(matrix, t)[..., :3] for t in (masked, measured)]
    expected = psnr(*pictures, matrix.coverage == 1)
    assert made["psnr_db"][2] == pytest.approx(expected, rel=1e-5)
    assert made["psnr_db"][0] == made["psnr_db"][4] != made["psnr_db"][2]


def test_sampling_is_compared_with_the_reference(tmp_path, matrix):
    brighter = replace(matrix, weights=matrix.weights * np.float32(1.1))
    for name, built in {"reference": matrix, "light-4": brighter}.items():
        transport.save(tmp_path / name, built)
    made = {"sampling": ["light", "half-vector"], "samples": 4, "resolution": 3, "seconds": 0.5}
    (tmp_path / "light-4.json").write_text(json.dumps(made))
    pair = a_table(1), a_table(2)
    found = costs.sampling(str(tmp_path / "reference"), [str(tmp_path / "light-4")], {"felt": pair})
    [row] = found.to_dict("records")
    assert (row["sampling"], row["samples"], row["seconds"]) == ("light+half-vector", 4, 0.5)
    # All radiance 10 % too high: the PSNR of a fit does not change, that of a picture is what
    # an error of a tenth of each pixel gives.
    assert row["psnr_db"] == pytest.approx(row["reference_db"], rel=1e-5)
    truth = transport.render(matrix, pair[0])[..., :3]
    assert row["picture_db"] == pytest.approx(
        psnr(truth * 1.1, truth, matrix.coverage == 1), rel=1e-4
    )


def test_the_price_of_a_decibel():
    stages = ["model"] * 3 + ["starts"] * 3
    fits = pd.DataFrame(
        {
            "material": "felt",
            "stage": stages,
            "setting": ["a", "b", "c", "1", "2", "3"],
            "scene": "A",
            "seconds": [4.0, 1.0, 2.0, 1.0, 3.0, 5.0],
            "bytes": 1,
            "psnr_db": [46.0, 40.0, 39.0, 50.0, 50.0, 50.5],
        }
    )
    fits = pd.concat([fits, fits.assign(scene="B", psnr_db=fits["psnr_db"] + 2)])
    sampling = pd.DataFrame(
        {
            "sampling": "light",
            "samples": [16, 64],
            "seconds": [1.0, 2.0],
            "material": "felt",
            "picture_db": [30.0, 34.0],
            "psnr_db": 1.0,
            "reference_db": 1.0,
        }
    )
    made = costs.cost(fits, sampling)
    columns = ["stage", "setting", "seconds", "psnr_db", "db_gained", "seconds_per_db"]
    assert list(made.columns) == columns
    assert made["setting"].tolist() == ["b", "c", "a", "1", "2", "3", 16, 64]
    assert made["psnr_db"].tolist() == [41, 40, 47, 51, 51, 51.5, 30, 34]
    nan = np.nan
    np.testing.assert_array_equal(made["db_gained"], [nan, -1, 6, nan, 0, 0.5, nan, 4])
    np.testing.assert_array_equal(made["seconds_per_db"], [nan, nan, 0.5, nan, nan, 8, nan, 0.25])
    assert made["stage"].iloc[-1] == "sampling light"


def test_either_way_of_sampling_alone_estimates_the_same_picture():
    rows = np.arange(8)[:, None, None] + np.arange(16)[:, None] / 4 + np.ones(3)
    light, grid = Environment(rows), HalfDifference(12, 12, 24)
    white = Table(np.full((3, *grid.shape), 0.3), grid)
    scene = Scene(("sphere",))

    def brightness(samples, *sampling):
        strategies = registry.make(sampling, Given(light, grid))
        built = assembly.build(scene, light, grid, 8, samples, 1, strategies)
        return transport.render(built, white)[built.foreground][:, :3].mean()

    combined = brightness(1024)
    assert brightness(1024, "light") == pytest.approx(combined, rel=5e-3)
    assert brightness(1024, "half-vector") == pytest.approx(combined, rel=2e-2)
    assert brightness(64, "light") != brightness(64, "half-vector")


def test_a_scene_records_how_it_was_made(tmp_path):
    environment.write(tmp_path / "light.exr", Environment(np.ones((8, 16, 3))))
    call = f"scene --light {tmp_path}/light.exr --objects sphere --resolution 4 --samples 4"
    call += f" --sampling light --record {tmp_path}/scene.json -o {tmp_path}/scene"
    assert main(call.split()) == 0
    made = json.loads((tmp_path / "scene.json").read_text())
    assert made["sampling"] == ["light"]
    assert (made["samples"], made["resolution"]) == (4, 4)
    assert made["seconds"] > 0
    assert (made["effects"], made["rays"]) == ([], 0)
    stored = transport.load(tmp_path / "scene")
    assert stored.coverage.shape == (4, 4)
    assert made["nonzeros"] == stored.indptr[-1] > 0
    assert made["bytes"] == sum(array.nbytes for array in stored.arrays.values())


@pytest.fixture(scope="module")
def glossy():
    grid = HalfDifference(18, 18, 36)
    lobe = np.exp(-((grid.theta_h / 0.3) ** 2))[:, None, None] + np.zeros(grid.shape)
    values = np.stack([0.1 + k * lobe for k in (1, 2, 3)])
    return Table(np.where(grid.above_horizon, values, INVALID), grid)


def test_fewer_starts_are_the_first_ones_and_cost_no_more(glossy, monkeypatch):
    solve = chosen(SolverSettings(tolerance=1e-2, max_iterations=5))
    everything = independent_g.fit(glossy, Objective(), solve, seed=1)
    monkeypatch.setattr(g_from_d, "fit_samples", None)  # not among the first five
    few = independent_g.fit(glossy, Objective(), solve, seed=1, starts=5)
    for whole, part in zip(everything.records, few.records, strict=True):
        whole_runs, part_runs = ({t.start: t for t in r.traces} for r in (whole, part))
        assert set(part_runs) == {"random-1", "random-2", "random-3", "random-4", "ones"}
        assert len(whole_runs) == independent_g.STARTS
        thinned = set(part_runs) - {whole.best_start, part.best_start}
        for name in thinned:
            assert part_runs[name].objective == whole_runs[name].objective


def test_mistakes_are_told_in_one_line(tmp_path, capsys):
    call = ["accuracy-cost", "traces", "--fits", "fits/naive", "--materials", "felt"]
    assert main([*call, "-o", str(tmp_path / "traces.csv")]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "'fits/naive' is not written NAME=PATH" in error


def test_the_verb_writes_tables_that_lead_to_the_price(tmp_path, matrix):
    fits = pd.DataFrame([("felt", "model", "bivariate", "A", 1.0, 97200, 40.0)], columns=costs.FITS)
    sampling = pd.DataFrame([("light", 16, 1.0, "felt", 30.0, 1.0, 1.0)], columns=costs.SAMPLING)
    tables.write(tmp_path / "felt.csv", fits)
    tables.write(tmp_path / "sampling.csv", sampling)
    call = f"accuracy-cost table --fits {tmp_path}/felt.csv --sampling {tmp_path}/sampling.csv"
    assert main([*call.split(), "-o", str(tmp_path / "cost.csv")]) == 0
    text = (tmp_path / "cost.csv").read_text().splitlines()
    assert text[0] == "stage,setting,seconds,psnr_db,db_gained,seconds_per_db"
    assert text[1:] == ["model,bivariate,1,40,,", "sampling light,16,1,30,,"]
