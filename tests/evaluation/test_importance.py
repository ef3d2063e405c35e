import copy
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import importance
from npfm.evaluation.importance import COLUMNS, INDEPENDENT, MEASURED, SOBOL, Effort, way
from npfm.papers import lawrence2004
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import Environment
from npfm.run.config import check
from npfm.run.importance import FOLLOWED, plan
from npfm.storage.pictures import read_exr_parts

DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())
GRID = HalfDifference(12, 12, 24)
EFFORT = Effort(resolution=8, points=512, samples=(4, 16), repetitions=20)
EVEN = Environment(np.ones((8, 16, 3)))
D = {"D": np.exp(-((GRID.theta_h[None] / 0.3) ** 2)) + 0.01}


@pytest.fixture(scope="module")
def glossy():
    lobe = 4 * np.exp(-((GRID.theta_h / 0.3) ** 2))[:, None, None]
    values = np.broadcast_to(0.05 + lobe, (3, *GRID.shape))
    return Table(np.where(GRID.above_horizon, values, INVALID), GRID)


def planned(**changes):
    return plan(check(copy.deepcopy(DEFAULT) | changes))


def asked(**changes):
    return planned(importance=DEFAULT["importance"] | changes)


def test_a_way_is_read_and_told():
    three = way("per-view+light+quantiles/ggx^2")
    assert three.names == ("per-view", "light", "quantiles/ggx")
    assert three.power == 2
    assert (three.strategy, three.recipe) == ("per-view+light+quantiles", "ggx, power 2")
    assert (way("cosine").strategy, way("cosine").recipe) == ("cosine", "")


@pytest.mark.parametrize("text", ["", "light^0", "light^2.1.1", "light^nan", "light^", "a b", "^2"])
def test_what_is_no_way_is_told(text):
    with pytest.raises(NpfmError, match="is no way of sampling; write it as"):
        way(text)


def test_an_unknown_strategy_is_told():
    with pytest.raises(NpfmError, match="unknown strategy 'cosin'; did you mean cosine"):
        way("light+cosin")


def test_a_strategy_for_each_recipe(glossy):
    wider = {"D": D["D"] + 1}
    ways = [way("quantiles/a"), way("light+quantiles/b")]
    given = importance.Given(EVEN, GRID, glossy)
    made = importance.make(ways, given, {"quantiles/a": D, "quantiles/b": wider})
    assert list(made) == ["light", "half-vector", "quantiles/a", "quantiles/b"]
    assert (wider["D"][0] == made["quantiles/b"].surface.D).all()
    with pytest.raises(NpfmError, match="'quantiles' needs the parameters of a material"):
        importance.make(ways, given, {"quantiles/a": D})


@pytest.fixture(scope="module")
def measured(glossy):
    ways = [way(text) for text in ("cosine", "half-vector", "quantiles/a", "light+half-vector")]
    return importance.measure(ways, glossy, EVEN, {"quantiles/a": D}, EFFORT)


def test_rows_are_of_one_sample_and_of_each_number(measured):
    table, _ = measured
    assert tuple(table.columns) == MEASURED[2:]
    assert len(table) == 4 * 3
    cosine = table[table["strategy"] == "cosine"]
    assert cosine["samples"].tolist() == [1, 4, 16]
    assert cosine["points"].tolist() == [INDEPENDENT, SOBOL, SOBOL]
    # Samples of every width of a lobe are better than such as know none.
    alone = table[table["samples"] == 1].set_index("strategy")["n_var"]
    assert alone["half-vector"] < alone["cosine"]
    assert (table["low"] <= table["n_var"]).all() and (table["n_var"] <= table["high"]).all()


def test_images_are_the_table_by_pixel(measured):
    table, images = measured
    assert list(images) == ["cosine", "half-vector", "quantiles/a", "light+half-vector"]
    for name, image in images.items():
        rows = table[table["strategy"] == name.partition("/")[0]]["n_var"].tolist()
        inside = image[..., 3] > 0
        np.testing.assert_allclose(image[inside][:, 0].mean(), rows[0], rtol=1e-5)
        np.testing.assert_allclose(image[inside][:, 1].mean(), rows[-1], rtol=1e-5)
        assert (image[inside][:, 2] > 0).all() and (image[~inside] == 0).all()


def test_too_few_samples_for_the_strategies(glossy):
    few = Effort(resolution=4, points=16, samples=(2,), repetitions=2)
    with pytest.raises(NpfmError, match="2 samples are too few for per-view and light and uniform"):
        importance.measure([way("per-view+light+uniform")], glossy, EVEN, {}, few)


def test_a_black_material_has_no_variance():
    black = Table(np.zeros((3, *GRID.shape)), GRID)
    with pytest.raises(importance.Black, match="is black"):
        importance.measure([way("cosine")], black, EVEN, {}, EFFORT)


def rows(*found):
    filled = [(*row, 1, 0.9, 1.1, 1e-7) for row in found]
    table = pd.DataFrame(filled, columns=[*MEASURED[:6], "n_var", "low", "high", "seconds"])
    return table


def test_improvement_is_over_the_papers_recipe():
    table = rows(
        ("constant", "nickel", "cosine", "", SOBOL, 100),
        ("constant", "nickel", "factored", "improved", SOBOL, 100),
        ("constant", "nickel", "factored", "paper", SOBOL, 100),
        ("constant", "nickel", "cosine", "", SOBOL, 16),
    ).assign(n_var=[300.0, 0.5, 2.0, 1.0])
    made = importance.gather([table])
    assert tuple(made.columns) == COLUMNS
    np.testing.assert_allclose(made["improvement"], [150, 0.25, 1, np.nan])


def test_the_verb_writes_what_was_measured_and_printed(tmp_path, glossy, monkeypatch, capsys):
    monkeypatch.setattr("npfm.commands.importance.table", lambda path: glossy)
    environment.write(tmp_path / "constant.exr", EVEN)
    call = f"importance measure nickel.binary --light {tmp_path}/constant.exr --ways cosine"
    call += " per-view --resolution 4 --points 16 --samples 4 100 --repetitions 2"
    outputs = f"-o {tmp_path}/nickel.csv --images {tmp_path}/nickel.exr"
    assert main(f"{call} {outputs}".split()) == 0
    assert list(read_exr_parts(tmp_path / "nickel.exr")) == ["cosine", "per-view"]
    assert main(f"importance table {tmp_path}/nickel.csv -o {tmp_path}/all.csv".split()) == 0
    table = importance.read(str(tmp_path / "all.csv"), (*COLUMNS, "published"))
    assert set(table["light"]) == {"constant"} and set(table["material"]) == {"nickel"}
    printed = table.dropna(subset="published")[["strategy", "samples", "published"]]
    expected = [["cosine", 100, 306.17], ["per-view", 100, 1.66]]
    assert printed.to_numpy().tolist() == expected
    assert main(f"{call} --parameters a {outputs}".split()) == 1
    assert "'a' is not written NAME=PATH" in capsys.readouterr().err
    black = Table(np.zeros((3, *GRID.shape)), GRID)
    monkeypatch.setattr("npfm.commands.importance.table", lambda path: black)
    assert main(f"{call} {outputs}".split()) == 1
    assert "nickel.binary: a picture of it" in capsys.readouterr().err


def test_only_what_was_printed_stands_beside_ours():
    assert lawrence2004.improvement("beach", "nickel", "lafortune") == 3.45
    for absent in (("grace", "nickel", "cosine"), ("beach", "brass", "cosine")):
        assert np.isnan(lawrence2004.improvement(*absent))
    assert np.isnan(lawrence2004.improvement("beach", "nickel", "light"))
    assert np.isnan(lawrence2004.improvement("constant", "poulin-fournier", "per-view"))


def test_all_strategies_are_measured_in_even_light_and_in_that_of_the_first_scene():
    study = planned()
    assert study.lights == ["constant", "cathedral"]
    assert study.materials == tuple(sorted(DEFAULT["importance"]["materials"]))
    names = {name for text in study.ways for name in way(text).names}
    assert set(FOLLOWED) < names and {"cosine", "per-view"} < names
    assert {word.partition("=")[0] for word in study.parameters("car-paint")} == set(FOLLOWED)


def test_materials_need_not_be_the_runs():
    dataset = {"kind": "synthetic", "materials": ["chalk"]}
    entry = ["power-iteration"]
    study = planned(dataset=dataset, variants=entry)
    assert "car-paint" in study.materials
    folder = "results/default/importance/fits"
    assert study.fit("power-iteration", "car-paint") == f"{folder}/power-iteration/car-paint.npz"
    known = plan(check(copy.deepcopy(DEFAULT) | {"variants": entry}))
    run = "results/default/fits/power-iteration/car-paint.npz"
    assert known.fit("power-iteration", "car-paint") == run
    none = plan(
        check(
            copy.deepcopy(DEFAULT)
            | {"importance": DEFAULT["importance"] | {"materials": ["no-such"]}}
        )
    )
    assert none.materials == none.run.materials[:6]


def test_the_papers_materials_are_shown_where_there_are_any():
    assert asked().shown == list(asked().materials[:2])


def test_lights_are_those_that_are_asked_for():
    assert asked(lights=["grove"]).lights == ["grove"]
    with pytest.raises(NpfmError, match="importance/lights: unknown light 'grovee'; did you mean"):
        asked(lights=["grovee"])
