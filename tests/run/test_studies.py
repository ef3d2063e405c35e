"""What all studies have in common: each plans its own variants beside those of any run."""

import importlib
import pkgutil
from pathlib import Path

import pytest
import yaml

import npfm.run
from npfm.errors import NpfmError
from npfm.run.config import check
from npfm.run.study import Study

DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())
MODULES = [
    importlib.import_module(f"npfm.run.{m.name}") for m in pkgutil.iter_modules(npfm.run.__path__)
]
PLANS = {module.__name__: module.plan for module in MODULES if hasattr(module, "plan")}
MINE = {"name": "mine", "model": "independent-g", "starts": 2}


def configured(**changes):
    return check(DEFAULT | {"variants": ["naive", MINE]} | changes)


@pytest.mark.parametrize("name", PLANS)
def test_a_variant_by_a_name_of_the_users_own_is_shown_and_coloured(name):
    run = configured(
        video=DEFAULT["video"] | {"variants": ["mine"]},
        colors={"mine": "#009E73"},
        exports={"csv": ["mine"]},
    )
    made = PLANS[name](run)
    if isinstance(made, Study):
        assert made.run is run
        assert made.study.scenes == run.scenes and made.study.grid == run.grid


def test_a_variant_of_the_run_is_shown_in_the_video_as_it_is_fitted_there():
    run = configured(video=DEFAULT["video"] | {"variants": ["mine"]})
    made = PLANS["npfm.run.video"](run)
    assert made.fits("chalk") == {"mine": "results/default/fits/mine/chalk.npz"}


def test_most_studies_are_planned():
    assert len(PLANS) >= 10


def test_a_run_with_other_variants_is_the_run_that_the_configuration_would_be():
    entries = ["bivariate", MINE | {"starts": 3}]
    assert configured().with_variants(entries) == configured(variants=entries)


def test_other_variants_are_checked():
    run = configured()
    with pytest.raises(NpfmError, match="the name 'naive' is taken"):
        run.with_variants(["naive", "naive"])
    brushed = {"kind": "synthetic-anisotropic", "materials": ["satin"]}
    run = configured(dataset=brushed, variants=["ggx"])
    with pytest.raises(NpfmError, match="config: variants/naive: "):
        run.with_variants(["naive"])
