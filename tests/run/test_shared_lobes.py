from pathlib import Path

import pytest
import yaml

from npfm.evaluation import shared_lobes as study
from npfm.papers import peng2017
from npfm.rendering.scenes import STRATEGIES as RENDERERS
from npfm.run import shared_lobes
from npfm.run.config import check
from npfm.run.shared_lobes import MODEL, OPPONENTS, plan

ROOT = Path(__file__).parents[2]
CONFIG = yaml.safe_load((ROOT / "config.yaml").read_text())


def planned(*variants, **changes):
    return plan(check(CONFIG | {"variants": list(variants)} | changes))


def test_a_run_without_the_models_has_them_made_for_the_study():
    made = planned("naive")
    assert set(made.folders) == {MODEL, *OPPONENTS, *(f"lobes-{n}" for n in shared_lobes.BY_NUMBER)}
    assert {Path(folder).parent.name for folder in made.folders.values()} == {"fits"}
    assert all(folder.startswith(f"{made.folder}/fits") for folder in made.folders.values())
    assert made.folders["lobes-3-shared"] == made.folders[MODEL]
    assert len(set(made.folders.values())) == len(made.folders) - 1


def test_what_the_run_has_is_taken_from_it_with_its_settings():
    made = planned(*OPPONENTS, {"name": MODEL, "model": MODEL, "starts": 1})
    assert {made.folders[name] for name in (MODEL, *OPPONENTS)} == {
        f"results/default/fits/{name}" for name in (MODEL, *OPPONENTS)
    }
    options = made.study.variants["lobes-5-own"].options
    for name, value in (("--starts", "1"), ("--lobes", "5"), ("--shared", "0")):
        assert options[options.index(name) + 1] == value


def test_only_some_materials_are_fitted_with_every_number_of_lobes():
    made = planned("naive")
    other = next(name for name in made.run.materials if name not in made.counted)
    assert len(made.fits(other)) == 3
    assert len(made.fits(made.counted[0])) == 10


def test_scenes_are_the_papers_or_the_first_two():
    assert planned("naive").scenes == list(peng2017.SCENES)
    scenes = {f"my-{name}": CONFIG["scenes"][name] for name in "ABC"}
    assert planned("naive", scenes=scenes).scenes == ["my-A", "my-B"]


def test_words_are_those_of_the_study():
    ours = shared_lobes.COMPARED, shared_lobes.BY_LOBES, shared_lobes.SHARED
    assert ours == (study.COMPARED, study.BY_LOBES, study.SHARED)
    used = {name for names in study.WAYS.values() for name in names} | set(RENDERERS)
    assert used == set(shared_lobes.STRATEGIES)


@pytest.mark.parametrize("preset", ["neural", "neural-10", "merl"])
def test_presets_have_all_that_is_compared(preset):
    variants = yaml.safe_load((ROOT / f"workflow/presets/{preset}.yaml").read_text())["variants"]
    assert {MODEL, *OPPONENTS} <= set(variants)
