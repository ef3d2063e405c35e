import shutil

import pytest

from npfm.evaluation import importance
from npfm.rendering.sampling import registry
from npfm.storage.pictures import read_exr_parts
from tests.workflow.conftest import Project


@pytest.fixture(scope="module")
def measured(finished, tmp_path_factory):
    """The tiny run with the study; it has none of the models that strategies follow."""
    folder = tmp_path_factory.mktemp("importance") / "project"
    shutil.copytree(finished.folder, folder, symlinks=True)
    project = Project(folder)
    run = project.snakemake("importance")
    assert run.returncode == 0, run.stdout + run.stderr
    return project


def test_the_target_measures_every_strategy(measured):
    results = measured.folder / "results/tiny"
    table = importance.read(str(results / "tables/variance.csv"))
    assert {name for strategy in table["strategy"] for name in strategy.split("+")} == set(
        registry.strategies()
    )
    assert set(table["material"]) == {"chalk"} and set(table["light"]) == {"cathedral"}
    assert set(table["samples"]) == {1, 4, 8}
    assert (table["low"] <= table["n_var"]).all() and (table["seconds"] > 0).all()
    images = read_exr_parts(results / "importance/cathedral/chalk.exr")
    combined = ["light+half-vector", "per-view+light+uniform^2", "light+factored/improved"]
    assert list(images)[-3:] == combined
    for figure in ("single", "stratified", "improvement", "samples", "images", "estimators"):
        assert (results / f"figures/importance_{figure}.pdf").stat().st_size > 0
    # What is fitted for the study alone is no part of the run.
    assert not (results / "fits/shared-lobes").exists()
    assert measured.planned("importance") == set()


def test_an_edit_of_a_strategy_measures_again_and_fits_nothing(measured, tmp_path):
    shutil.copytree(measured.folder, tmp_path / "edited", symlinks=True)
    project = Project(tmp_path / "edited")
    project.edit("npfm/rendering/sampling/uniform.py", "2 * np.pi * u", "2.0 * np.pi * u")
    made = project.planned("importance")
    assert "importance/cathedral/chalk.csv" in made
    assert not {name for name in made if "fits" in name or "lights" in name}


def test_lights_and_materials_are_those_that_are_asked_for(fresh):
    asked = fresh.config["importance"] | {"lights": ["grove"], "materials": ["pink-felt"]}
    fresh.configure(importance=asked)
    made = fresh.planned("importance")
    assert {name for name in made if name.startswith("importance/grove/")} == {
        "importance/grove/pink-felt.csv",
        "importance/grove/pink-felt.exr",
    }
    assert "importance/fits/power-iteration/pink-felt.npz" in made


def test_formulas_are_measured_beside_the_materials(fresh):
    fresh.configure(importance=fresh.config["importance"] | {"formulas": ["cook-torrance"]})
    made = fresh.planned("importance")
    assert "importance/formulas/cook-torrance.binary" in made
    assert "importance/fits/lafortune/cook-torrance.npz" in made
    assert "importance/cathedral/cook-torrance.csv" in made
    assert "importance/cathedral/chalk.csv" in made


def test_a_light_that_is_not_there_is_told_in_one_line(fresh):
    fresh.configure(importance=fresh.config["importance"] | {"lights": ["grotto"]})
    run = fresh.snakemake("importance", "--dry-run")
    assert run.returncode == 1
    assert "config: importance/lights: unknown light 'grotto'; did you mean grove?" in run.stderr
