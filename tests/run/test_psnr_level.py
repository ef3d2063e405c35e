import copy
from pathlib import Path

import pytest
import yaml

from npfm.run import effects_cost
from npfm.run.config import check
from npfm.run.psnr_level import plan

DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())


def planned(**changes):
    config = copy.deepcopy(DEFAULT)
    config["psnr_level"] |= changes
    return plan(check(config))


def test_what_a_run_or_the_target_effects_builds_is_taken_from_there():
    here = planned(resolutions=[64], turns=[90, 180])
    own = "results/default/psnr_level/scenes"
    ways = ["pixels-64", "turned-90", "turned-180"]
    [switched] = effects_cost.Plan(here.run).builds("A")
    for scene, antialiased in (("A", switched), ("B", "results/default/scenes/B")):
        assert here.folders(scene) == {
            "configured": f"results/default/scenes/{scene}",
            "antialiased": antialiased,
            **{way: f"{own}/{scene}/{way}" for way in ways},
        }
    # B and C are antialiased as they are.
    assert len(here.scenes) == len(set(here.scenes)) == 4 * (2 + len(ways)) - 2


def test_a_scene_is_built_as_the_runs_own_but_for_its_way():
    here = planned(resolutions=[64], turns=[180])
    own = here.run.scene_options("B")
    assert here.scene_options("B", "turned-180") == [*own, "--turn", "180"]
    assert here.scene_options("B", "pixels-64") == [*own, "--resolution", "64"]
    assert here.angles_options("B") == (
        ["--objects", "figure", "sphere", "--effects", "antialiasing", "--resolution", "128"]
    )


def test_the_runs_own_pixels_are_not_built_twice():
    assert list(planned(resolutions=[64, 128], turns=[]).built) == ["pixels-64"]


@pytest.mark.parametrize(
    ("materials", "variants", "expected"),
    [
        (["chalk", "no-such"], ["naive", "no-such"], (("chalk",), ("naive",))),
        (["mirror-*"], ["no-such"], (("mirror-metal",), tuple(DEFAULT["variants"]))),
        ([], ["naive"], (6, ("naive",))),
    ],
)
def test_what_the_run_does_not_have_is_left_out(materials, variants, expected):
    here = planned(materials=materials, variants=variants)
    found = len(here.materials) if isinstance(expected[0], int) else here.materials
    assert (found, here.variants) == expected


def test_all_materials_count_if_asked():
    here = planned(materials=["*"])
    assert here.materials == here.run.materials
    assert here.fits("chalk")["naive"] == "results/default/fits/naive/chalk.npz"
