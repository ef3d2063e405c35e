"""The registry of strategies: files that declare a NAME."""

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import STRATEGIES

GIVEN = Given(Environment(np.ones((4, 8, 3))), MERL)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder in place of npfm/rendering/sampling."""
    monkeypatch.setattr(registry, "FOLDER", tmp_path)
    registry.strategies.cache_clear()
    yield tmp_path
    registry.strategies.cache_clear()


def test_a_file_with_a_name_is_a_strategy(folder):
    (folder / "mine.py").write_text('NAME = "my-own"\nNEEDS = ("table",)\n')
    (folder / "helper.py").write_text("NEEDS = ()\n")
    (folder / "plain.py").write_text('NAME = "plain"\n')
    assert registry.strategies() == {
        "my-own": registry.Declared("npfm.rendering.sampling.mine", ("table",)),
        "plain": registry.Declared("npfm.rendering.sampling.plain"),
    }
    assert registry.for_any_material() == ["plain"]
    assert registry.modules(["plain"]) == ("npfm.rendering.sampling.plain",)


def test_a_strategy_that_needs_a_material_is_refused_without_one(folder):
    (folder / "mine.py").write_text('NAME = "mine"\nNEEDS = ("table", "parameters")\n')
    with pytest.raises(NpfmError, match="'mine' needs the table of a material"):
        registry.make(["mine"], GIVEN)
    table = Table(np.ones((3, *MERL.shape)))
    with pytest.raises(NpfmError, match="'mine' needs the parameters of a material"):
        registry.make(["mine"], Given(GIVEN.environment, MERL, table))
    with pytest.raises(NpfmError, match="'mine' follows one material, and a scene is built once"):
        registry.check_scene(["mine"])


def test_a_file_without_make_is_named(folder):
    (folder / "low_discrepancy.py").write_text('NAME = "mine"\n')
    with pytest.raises(NpfmError, match=r"low_discrepancy\.py: no function 'make'"):
        registry.make(["mine"], GIVEN)


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["lihgt"], "unknown strategy 'lihgt'; did you mean light"),
        (["light", "light"], "listed twice: light, light"),
    ],
)
def test_a_wrong_choice_is_refused_in_one_line(names, said):
    for refuse in (registry.check, registry.check_scene, lambda n: registry.make(n, GIVEN)):
        with pytest.raises(NpfmError, match=said):
            refuse(names)


def test_strategies_of_scenes_need_no_material():
    assert {"light", "half-vector", "cosine", "uniform"} <= set(registry.for_any_material())
    assert set(STRATEGIES) <= set(registry.for_any_material())
    made = registry.make(registry.for_any_material(), GIVEN)
    assert len({type(strategy) for strategy in made}) == len(made)
