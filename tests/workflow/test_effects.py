import re

import numpy as np
import pytest

from npfm.storage.pictures import read_exr


def test_the_target_switches_each_effect_once_and_builds_no_scene_again(finished):
    """Not run here: it fits independent-g, which the tiny run is without."""
    run = finished.snakemake("effects", "--dry-run")
    assert run.returncode == 0, run.stdout + run.stderr
    outputs = re.findall(r"^ +output: (.*)$", run.stdout + run.stderr, re.MULTILINE)
    made = {name.removeprefix("results/tiny/") for line in outputs for name in line.split(", ")}
    assert {name for name in made if "scenes/" in name} == {
        f"effects/scenes/{build}{suffix}"
        for build in ("A/antialiasing", "C/visibility", "C/antialiasing")
        for suffix in ("", ".json")
    }
    assert {name for name in made if "bounced/" in name and name.endswith(".exr")} == {
        "bounced/C/chalk/measured.exr",
        "effects/bounced/C/chalk.exr",
    }
    tables = {"tables/effects.csv", "figures/effects.pdf", "figures/effects.png"}
    assert tables | {f"effects/{scene}.{kind}" for scene in "AC" for kind in ("csv", "exr")} < made


def test_a_scene_that_lists_interreflection_has_it_rendered_for_each_picture(project):
    scenes = {name: dict(scene) for name, scene in project.config["scenes"].items()}
    scenes["C"]["effects"] = ["visibility", "interreflection"]
    project.configure(scenes=scenes)
    planned = project.planned()
    pictures = ("measured", "bivariate", "naive", "old")
    bounced = {name for name in planned if name.startswith("bounced/")}
    assert {f"bounced/C/chalk/{name}.exr" for name in pictures} <= bounced
    assert not [name for name in bounced if not name.startswith("bounced/C/")]
    assert {f"renders/C/chalk/{name}.exr" for name in pictures} <= planned
    # The matrix stays as it is.
    assert not [name for name in planned if name.startswith(("scenes/", "fits/"))]


def test_light_that_bounces_is_added_in_the_scene_that_lists_it(project):
    pytest.importorskip("mitsuba", reason="needs the extra mitsuba")
    results = project.folder / "results" / "tiny"
    pictures = [results / "renders" / scene / "chalk" / "naive.exr" for scene in ("A", "C")]
    before = [read_exr(path)[..., :3] for path in pictures]
    scenes = {name: dict(scene) for name, scene in project.config["scenes"].items()}
    scenes["C"] |= {"effects": ["visibility", "interreflection"], "paths": 4}
    project.configure(scenes=scenes)
    run = project.snakemake("results/tiny/renders/A/chalk/naive.exr")
    assert run.returncode == 0, run.stdout + run.stderr
    bounced = read_exr(results / "bounced" / "C" / "chalk" / "naive.exr")
    assert bounced.any()
    same, brighter = (read_exr(path)[..., :3] for path in pictures)
    np.testing.assert_array_equal(same, before[0])
    np.testing.assert_allclose(brighter, before[1] + bounced, rtol=1e-6)


def test_a_pointless_effect_is_warned_of_once_and_reruns_nothing(project):
    scenes = {name: dict(scene) for name, scene in project.config["scenes"].items()}
    scenes["A"]["effects"] = ["visibility"]
    project.configure(scenes=scenes)
    run = project.snakemake("--dry-run")
    assert run.returncode == 0 and "Nothing to be done" in run.stdout + run.stderr
    lines = [line for line in run.stderr.splitlines() if line.startswith("npfm")]
    assert lines == [
        "npfm: warning: config: scenes/A: effect 'visibility' changes nothing on a lone sphere "
        "and is left out; take it off the list"
    ]
