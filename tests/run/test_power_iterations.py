from pathlib import Path

import pytest
import yaml

from npfm.run.config import check
from npfm.run.power_iterations import CONVERSIONS, EDITED, MODEL, SHOWN, plan

ROOT = Path(__file__).parents[2]
CONFIG = yaml.safe_load((ROOT / "config.yaml").read_text())


def planned(*variants, **changes):
    return plan(check(CONFIG | {"variants": list(variants)} | changes))


def test_a_run_without_the_model_has_it_made_for_the_study():
    made = planned("bivariate")
    assert list(made.study.variants) == [MODEL, *CONVERSIONS]
    assert {made.home(name) for name in made.study.variants} == {"results/default/power_iterations"}
    assert made.fits(MODEL)[0].startswith(f"results/default/power_iterations/fits/{MODEL}/")


def test_what_the_run_has_is_taken_from_it():
    made = planned(MODEL, "ggx-fitted", "abc-ours", "shifted-gamma", "ggx")
    names = [MODEL, "shifted-gamma", "abc-ours", "ggx-fitted", *CONVERSIONS]
    assert list(made.study.variants) == names
    homes = {name: made.home(name) for name in names}
    assert homes.pop("beckmann") == "results/default/power_iterations"
    assert set(homes.values()) == {"results/default"}


def test_settings_of_the_run_are_kept():
    paper = {"name": MODEL, "model": MODEL, "kernel": "paper"}
    made = planned(paper, {"name": "ggx", "model": "ggx", "fresnel": "mean"})
    assert "paper" in made.study.variants[MODEL].options
    assert made.home(MODEL) == made.home("ggx") == "results/default"


def test_materials_are_those_of_the_paper_or_others_like_them():
    made = planned("bivariate")
    assert set(made.shown) | set(made.edited) <= set(made.run.materials)
    assert len(made.shown) == len(SHOWN) and len(made.edited) == len(EDITED)


def test_every_picture_is_compared_once():
    made = planned("bivariate")
    assert len(made.compared) == len(set(made.compared)) == 3 * len(made.run.materials)
    assert made.fit_options[0] == f"{MODEL}=results/default/power_iterations/renders/A"


@pytest.mark.parametrize("preset", ["neural", "neural-10", "merl"])
def test_presets_have_all_that_is_compared(preset):
    variants = yaml.safe_load((ROOT / f"workflow/presets/{preset}.yaml").read_text())["variants"]
    assert {MODEL, *CONVERSIONS, "ggx-fitted", "abc-published"} <= set(variants)


def test_of_an_anisotropic_run_all_variants_are_compared_and_roughness_is_that_of_ggx():
    anisotropic = {"kind": "synthetic-anisotropic", "materials": ["satin", "rolled-gold"]}
    made = planned("beckmann", dataset=anisotropic)
    assert list(made.study.variants) == [MODEL, "beckmann", "ggx"]
    assert made.known_options == ["--anisotropic"]
    assert {Path(path).parts[-2] for path in made.told} == {"ggx"}
    assert set(made.edited) == set(made.shown) == {"satin", "rolled-gold"}
    usual = planned(MODEL)
    assert (usual.known_options, usual.told) == ([], usual.fits(MODEL))
