"""The registry of models: files that declare a NAME, read without importing them."""

import subprocess
import sys
from pathlib import Path

import pytest

from npfm.errors import NpfmError
from npfm.fitting import registry
from npfm.run.provenance import closure

ROOT = Path(__file__).parents[2]
PAPER = {"bivariate", "independent-g", "g-from-d", "naive"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder in place of npfm/models."""
    monkeypatch.setattr(registry, "FOLDER", tmp_path)
    registry.models.cache_clear()
    yield tmp_path
    registry.models.cache_clear()


def test_a_file_with_a_name_is_a_model(folder):
    (folder / "mine.py").write_text('NAME = "my-own"\nSETTINGS = {"lobes": "how many"}\n')
    (folder / "helper.py").write_text("RECIPROCAL = False\n")
    assert registry.models() == {
        "my-own": registry.Model("npfm.models.mine", settings={"lobes": "how many"})
    }


def test_what_is_declared_is_what_the_modules_say():
    assert set(registry.models()) >= PAPER
    for name, declared in registry.models().items():
        module = registry.model(name)
        assert (module.NAME, module.__name__) == (name, declared.module)
        for key in ("coefficients", "signed", "reciprocal", "solver", "objective", "settings"):
            default = registry.Model.__dataclass_fields__[key].default
            if hasattr(module, key.upper()):
                assert getattr(declared, key) == getattr(module, key.upper())
            elif key != "settings":
                assert getattr(declared, key) == default


def test_published_models_depend_on_what_reads_their_file():
    """It is imported by name; a digest finds it by the model, which imports it as well."""
    sources = {name: model.published for name, model in registry.models().items()}
    kinds = {source.kind for source in sources.values() if source}
    assert kinds == set(registry.READERS)
    for name, source in sources.items():
        if source:
            modules = closure([registry.declared(name).module])
            readers = {kind: reader in modules for kind, reader in registry.READERS.items()}
            assert readers == {kind: kind == source.kind for kind in registry.READERS}, name


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('NAME = "mine"\ndef fit(:\n', "mine.py, line 2"),
        ('NAME = "mine"\n\nSIGNED = tuple("D")\n', "mine.py, line 3"),
        ('NAME = "theirs"\n', "another model of the NAME 'theirs'"),
        ("NAME = 1\n", "mine.py: the NAME 1: "),
        ('NAME = "two words"\n', "mine.py: the NAME 'two words': "),
    ],
)
def test_a_mistake_in_a_file_names_the_file_in_one_line(folder, text, said):
    (folder / "mine.py").write_text(text)
    (folder / "other.py").write_text('NAME = "theirs"\n')
    with pytest.raises(NpfmError) as caught:
        registry.models()
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_model_without_its_functions_is_refused(monkeypatch):
    declared = {"smith": registry.Model("npfm.fitting.factors.smith")}
    monkeypatch.setattr(registry, "models", lambda: declared)
    with pytest.raises(NpfmError, match=r"smith\.py: no function 'fit'"):
        registry.model("smith")


def test_unknown_names_are_answered_with_near_ones():
    with pytest.raises(NpfmError, match="unknown model 'niave'; did you mean naive"):
        registry.declared("niave")


def test_checking_a_configuration_imports_no_model():
    code = (
        "import sys, yaml; from npfm.run import config;"
        "config.check(yaml.safe_load(open('config.yaml')));"
        "print(*(name for name in sys.modules if name.startswith('npfm.models.')))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (run.returncode, run.stdout.strip()) == (0, ""), run.stderr


def test_a_model_is_for_the_kinds_of_grid_that_it_declares(folder):
    (folder / "mine.py").write_text('NAME = "mine"\n')
    (folder / "both.py").write_text('NAME = "both"\nGRIDS = ("half-difference", "directional")\n')
    registry.check_grid("mine", "half-difference")
    registry.check_grid("both", "directional")
    with pytest.raises(NpfmError, match=r"'mine' is not for tables on a directional grid; .* both"):
        registry.check_grid("mine", "directional")
    (folder / "both.py").unlink()
    registry.models.cache_clear()
    with pytest.raises(NpfmError, match="directional grid; no model is"):
        registry.check_grid("mine", "directional")
