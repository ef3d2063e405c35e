"""The target that factors formulas and materials, on a tiny run."""

import shutil

import pandas as pd
import pytest

from tests.workflow.conftest import Project


@pytest.fixture(scope="module")
def factored(finished, tmp_path_factory):
    """The tiny run with what is quick of the target."""
    folder = tmp_path_factory.mktemp("factorisation") / "project"
    shutil.copytree(finished.folder, folder, symlinks=True)
    project = Project(folder)
    run = project.snakemake(
        "results/tiny/factorisation/materials/chalk.csv",
        "results/tiny/factorisation/formulas/hapke-lommel.csv",
        "results/tiny/figures/factorisation_steps.png",
    )
    assert run.returncode == 0, run.stdout + run.stderr
    return project


def test_formulas_and_materials_are_measured(factored):
    folder = factored.folder / "results/tiny"
    chalk = pd.read_csv(folder / "factorisation/materials/chalk.csv").set_index("recipe")
    assert (chalk["material"] == "chalk").all() and (chalk["error"] < 0.5).all()
    assert (folder / "figures/factorisation_steps.pdf").stat().st_size > 10_000


def test_the_rest_of_the_target_is_planned_and_what_is_there_is_not(factored):
    planned = factored.planned("factorisation")
    assert {
        "tables/factorisation.csv",
        "figures/point_light.png",
        "figures/factorisation_terms.png",
        "factorisation/formulas/ward.csv",
        "factorisation/formulas/poulin-fournier.csv",
        "factorisation/materials/chalk.npz",
    } <= planned
    assert "factorisation/materials/chalk.csv" not in planned
    assert "figures/factorisation_steps.png" not in planned


def test_an_edit_of_a_recipe_factors_again(factored, tmp_path):
    shutil.copytree(factored.folder, tmp_path / "edited", symlinks=True)
    project = Project(tmp_path / "edited")
    project.edit("npfm/fitting/factorisation/recipes.py", "DARKER = 0.2", "DARKER = 0.1")
    planned = project.planned("factorisation")
    assert (
        "factorisation/materials/chalk.csv" in planned and "materials/chalk.binary" not in planned
    )
