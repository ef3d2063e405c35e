from pathlib import Path

import pytest
import yaml

from npfm.fitting.basis import library
from npfm.run import basis, uniqueness
from npfm.run.config import check

ROOT = Path(__file__).parents[2]
CONFIG = yaml.safe_load((ROOT / "config.yaml").read_text())
FOLDER = "results/default"


def run_of(*variants, **changes):
    return check(CONFIG | {"variants": list(variants)} | changes)


def test_models_are_those_that_have_factors():
    assert basis.MODELS == library.MODELS
    assert tuple(sorted(set(basis.CURVES))) == basis.CURVES


def test_a_run_without_the_models_has_them_fitted_for_the_study():
    plan = basis.plan(run_of("naive"))
    assert plan.folders == {name: f"{FOLDER}/basis/fits/{name}" for name in basis.MODELS}
    assert len(plan.fits("shared-lobes")) == len(plan.run.materials)


def test_the_runs_own_variant_counts_whatever_its_name():
    mine = {"name": "mine", "model": "shared-lobes", "lobes": 2}
    plan = basis.plan(run_of("independent-g", mine))
    assert plan.folders == {name: f"{FOLDER}/fits/{name}" for name in ("independent-g", "mine")}


def test_fits_in_a_basis_are_made_as_the_free_ones_are():
    solver = CONFIG["solver"] | {"tolerance": 1e-4}
    own = {
        "name": "independent-g",
        "model": "independent-g",
        "objective": {"compressive": False, "cells": "solid-angle"},
    }
    plan = basis.plan(run_of(own, solver=solver))
    told = plan.gather_options("independent-g")
    assert told == ["--max-angle", "89.0", "--no-compressive", "--cells", "solid-angle"]
    options = plan.measure_options("independent-g")
    assert options[options.index("--tolerance") + 1] == "0.0001"
    assert options[:4] == ["--variant", "independent-g", "--curves", "1"]
    assert "--cells" not in plan.gather_options("shared-lobes")


def test_starts_are_followed_to_a_tenth_of_the_tolerance():
    plan = uniqueness.plan(run_of("naive", "bivariate"))
    assert plan.bivariate("chalk") == f"{FOLDER}/fits/bivariate/chalk.npz"
    assert plan.follow_options[-2:] == ["--tolerance", "1e-06"]
    assert plan.follow_options[:2] == ["--model", "independent-g"]
    assert uniqueness.plan(run_of("naive")).bivariate("chalk") == (
        f"{FOLDER}/uniqueness/fits/bivariate/chalk.npz"
    )


@pytest.mark.parametrize("preset", ["neural", "neural-10"])
def test_presets_have_the_models(preset):
    variants = yaml.safe_load((ROOT / f"workflow/presets/{preset}.yaml").read_text())["variants"]
    assert {*basis.MODELS, "bivariate"} <= set(variants)
