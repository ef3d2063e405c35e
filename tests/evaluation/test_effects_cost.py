import copy
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import effects_cost as costs
from npfm.evaluation.metrics import psnr
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.rendering import assembly, transport
from npfm.rendering.effects import EFFECTS
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene
from npfm.run.config import check
from npfm.run.effects_cost import Plan
from npfm.storage.pictures import read_exr_parts

DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())
GRID = HalfDifference(6, 5, 8)


@pytest.fixture(scope="module")
def plan():
    return Plan(check(copy.deepcopy(DEFAULT)))


@pytest.mark.parametrize(
    ("scene", "effects"), [("A", ["antialiasing"]), ("B", ["antialiasing", "visibility"])]
)
def test_effects_are_switched_where_they_change_something(plan, scene, effects):
    assert plan.effects(scene) == effects
    folders = [f"results/default/effects/scenes/{scene}/{effect}" for effect in effects]
    assert plan.builds(scene) == folders
    assert plan.switched(scene) == [
        f"{effect}={folder}" for effect, folder in zip(effects, folders, strict=True)
    ]


def test_a_switched_scene_differs_from_the_runs_own_in_that_effect_alone(plan):
    own = " ".join(plan.run.scene_options("B"))
    assert "--effects visibility antialiasing " in own
    for effect, other in (("visibility", "antialiasing"), ("antialiasing", "visibility")):
        expected = own.replace("visibility antialiasing", other)
        assert " ".join(plan.scene_options("B", effect)) == expected
    plain = " ".join(plan.run.scene_options("A"))
    expected = plain.replace("sphere ", "sphere --effects antialiasing ")
    assert " ".join(plan.scene_options("A", "antialiasing")) == expected


def a_table(seed):
    values = np.random.default_rng(seed).uniform(0.1, 1, (3, *GRID.shape))
    values[0, 0, 0, 0] = INVALID
    return Table(values, GRID)


@pytest.fixture
def scenes(tmp_path):
    """Folders of a scene with visibility, and of the same without it."""
    light = Environment(np.arange(1.0, 97).reshape(4, 8, 3))
    for name, effects in {"B": ("visibility",), "bare": ()}.items():
        scene = Scene(("figure", "sphere"), effects)
        built = assembly.build(scene, light, GRID, 12, 16, 1)
        transport.save(tmp_path / name, built)
        record = {"effects": effects, "seconds": 2.0 + len(effects), "rays": 7, "nonzeros": 9}
        (tmp_path / f"{name}.json").write_text(json.dumps(record))
    return str(tmp_path / "B"), str(tmp_path / "bare")


def fit_psnr(folder, measured, fit):
    """Render as npfm render --measured does, and compare."""
    fit = Table(np.where(measured.valid, fit.values, INVALID), GRID)
    matrix = transport.load(folder)
    pair = (transport.render(matrix, table)[..., :3] for table in (fit, measured))
    return psnr(*pair, matrix.foreground)


def test_changes_are_those_from_off_to_on_whichever_the_scene_has(scenes):
    materials = [(a_table(1), a_table(2)), (a_table(3), a_table(4))]
    having, bare = (costs.show(folder, materials) for folder in scenes)
    made = costs.compare("B", having, {"visibility": bare})
    assert tuple(made.columns) == costs.COLUMNS
    assert made["effect"].tolist() == [name for name in EFFECTS for _ in range(2)]
    assert made["on"].tolist() == [0, 1, 0, 1, 0, 1]
    assert made["build_seconds"].tolist() == [3, 3, 2, 3, 3, 3]
    pairs = [[fit_psnr(folder, *pair) for pair in materials] for folder in scenes]
    expected = np.mean(np.subtract(*pairs))
    assert abs(expected) > 1e-3
    np.testing.assert_allclose(
        made["psnr_change_db"], [0, 0, 0, expected, 0, 0], rtol=1e-4, atol=1e-12
    )
    np.testing.assert_array_equal(np.isinf(made["picture_db"]), [1, 1, 1, 0, 1, 1])
    pictures = [
        psnr(having.measured[k], bare.measured[k], bare.matrix.foreground) for k in range(2)
    ]
    assert made["picture_db"].iloc[3] == pytest.approx(np.mean(pictures))
    swapped = costs.compare("B", bare, {"visibility": having})
    np.testing.assert_array_equal(swapped.iloc[2:4], made.iloc[2:4])


def test_light_that_bounces_is_added_to_the_pictures_of_the_scene_as_it_is(scenes):
    materials = [(a_table(1), a_table(2)), (a_table(3), a_table(4))]
    having, bare = (costs.show(folder, materials) for folder in scenes)
    light = np.random.default_rng(5).uniform(0, 30, (2, *having.measured.shape)).astype("f4")
    bounced = costs.Bounced(*light, seconds=1.5)
    lit = having.brighter(bounced)
    without = costs.compare("B", having, {"visibility": bare})
    for bounces in (False, True):
        made = costs.compare("B", having, {"visibility": bare}, bounced, bounces=bounces)
        rows = made[made["effect"] == "interreflection"]
        assert rows["build_seconds"].tolist() == [3, 3]
        assert rows["picture_seconds"].tolist() == [0, 1.5]
        gain = np.mean(lit.psnr_db - having.psnr_db)
        np.testing.assert_allclose(rows["psnr_change_db"], [0, gain])
        assert rows["picture_db"].iloc[1] == pytest.approx(np.mean(lit.against(having)))
        others = made["effect"] != "interreflection"
        if not bounces:
            np.testing.assert_array_equal(made[others], without[others])
            continue
        # Visibility changes pictures that have the light on both sides.
        pair = having.brighter(bounced), bare.brighter(bounced)
        expected = np.mean(np.subtract(*(shown.psnr_db for shown in pair)))
        assert made["psnr_change_db"].iloc[3] == pytest.approx(expected)
        assert made["picture_seconds"].tolist() == [1.5] * 4 + [0, 1.5]


def test_the_picture_is_compared_where_both_scenes_are_covered(scenes):
    shown = costs.show(scenes[0], [(a_table(1), a_table(2))])
    coverage = shown.matrix.coverage.copy()
    first = tuple(np.argwhere(coverage == 1)[0])
    coverage[first] = 0.5
    brighter = shown.measured.copy()
    brighter[(0, *first)] += 1e6
    other = replace(shown, measured=brighter, matrix=replace(shown.matrix, coverage=coverage))
    assert other.against(shown) == shown.against(other) == np.inf


def test_a_scene_without_its_record_is_told_in_one_line(tmp_path, scenes):
    (tmp_path / "bare.json").unlink()
    with pytest.raises(NpfmError, match=r"bare\.json: cannot be read as the record") as caught:
        costs.show(scenes[1], [(a_table(1), a_table(2))])
    assert "\n" not in str(caught.value)


def test_the_verb_writes_table_and_pictures(tmp_path, scenes, monkeypatch, capsys):
    names = ("1.binary", "2.binary", "1.npz", "2.npz")
    found = {name: a_table(seed) for seed, name in enumerate(names)}
    monkeypatch.setattr("npfm.commands.effects_cost.table", found.__getitem__)
    scene, bare = scenes
    out = tmp_path / "B.csv"
    call = f"effects-cost compare {scene} --switched visibility={bare} --pictures {tmp_path}/B.exr"
    call += f" -o {out} --tables 1.binary 2.binary --fits 1.npz"
    assert main(call.split()) == 1
    assert "name a fit of each table" in capsys.readouterr().err
    assert main([*call.split(), "2.npz"]) == 0
    parts = read_exr_parts(tmp_path / "B.exr")
    for name, folder in {"scene": scene, "visibility": bare}.items():
        expected = transport.render(transport.load(folder), found["2.binary"])
        np.testing.assert_allclose(parts[name], expected, rtol=1e-5)
    table = tmp_path / "effects.csv"
    assert main(["effects-cost", "table", str(out), str(out), "-o", str(table)]) == 0
    rows = out.read_text().splitlines()
    assert table.read_text().splitlines() == [*rows, *rows[1:]]
    assert main([*call.replace("visibility=", "").split(), "2.npz"]) == 1
    assert "is not written NAME=PATH" in capsys.readouterr().err
