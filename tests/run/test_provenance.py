import ast
import shutil

import pytest

from npfm.fitting import registry
from npfm.rendering.sampling import registry as sampling
from npfm.run import provenance

PACKAGE = provenance.PACKAGE


@pytest.fixture
def copied(tmp_path, monkeypatch):
    """A copy of the package that a test may edit, and a function that digests it afresh."""
    copy = tmp_path / "npfm"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(provenance, "PACKAGE", copy)

    def digest(*entries):
        for cached in (provenance.digest, provenance._tree, provenance._syntax):
            cached.cache_clear()
        return provenance.digest(entries)

    yield copy, digest
    digest("npfm.errors")
    for cached in (provenance.digest, provenance._tree, provenance._syntax):
        cached.cache_clear()


def test_the_closure_follows_imports_and_nothing_else():
    closure = provenance.closure(["npfm.models.naive"])
    assert {
        "npfm.models.naive",
        "npfm.fitting.factors.problem",
        "npfm.fitting.objective",
        "npfm.reflectance.half_difference",
    } <= closure
    assert (
        not {"npfm.models.bivariate", "npfm.fitting.factors.kernels", "npfm.rendering.transport"}
        & closure
    )


def test_imports_inside_functions_count():
    assert "npfm.figures.figure08" in provenance.closure(["npfm.commands.figure"])


def test_relative_imports_count(copied):
    copy, _ = copied
    (copy / "models" / "extra.py").write_text(
        "from . import naive\nfrom ..errors import NpfmError\n"
    )
    closure = provenance.closure(["npfm.models.extra"])
    assert {"npfm.models.naive", "npfm.errors"} <= closure


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('NAME = "naive"', '# a comment\nNAME = "naive"'),
        ('NAME = "naive"', 'NAME   =   "naive"\n\n'),
        ('    """Number of values stored', '    """Count of values stored'),
    ],
)
def test_comments_layout_and_docstrings_change_nothing(copied, old, new):
    copy, digest = copied
    before = digest("npfm.models.naive")
    file = copy / "models" / "naive.py"
    assert old in file.read_text()
    file.write_text(file.read_text().replace(old, new))
    assert digest("npfm.models.naive") == before


def test_code_changes_what_imports_it_and_nothing_else(copied):
    copy, digest = copied
    modules = ("npfm.models.naive", "npfm.models.independent_g", "npfm.models.bivariate")
    before = [digest(module) for module in modules]
    file = copy / "fitting" / "factors" / "problem.py"
    file.write_text(file.read_text().replace("SMALLEST = 1e-12", "SMALLEST = 1e-13"))
    after = [digest(module) for module in modules]
    assert [a == b for a, b in zip(before, after, strict=True)] == [False, False, True]


def test_a_library_version_changes_the_digest(monkeypatch):
    before = provenance.digest(("npfm.errors",))
    provenance.digest.cache_clear()
    monkeypatch.setattr(provenance.importlib.metadata, "version", lambda name: "0.0")
    after = provenance.digest(("npfm.errors",))
    provenance.digest.cache_clear()
    assert before != after


@pytest.mark.parametrize(("module", "counts"), [("tucker", True), ("bivariate", False)])
def test_the_version_of_tensorly_counts_where_it_is_imported(monkeypatch, module, counts):
    entries = (f"npfm.models.{module}",)
    before, version = provenance.digest(entries), provenance.importlib.metadata.version
    monkeypatch.setattr(
        provenance.importlib.metadata,
        "version",
        lambda name: "0.0" if name == "tensorly" else version(name),
    )
    provenance.digest.cache_clear()
    after = provenance.digest(entries)
    provenance.digest.cache_clear()
    assert (before != after) == counts


def names(file):
    for node in ast.walk(ast.parse(file.read_text())):
        yield getattr(node, "id", None) or getattr(node, "attr", None)


def test_only_models_and_strategies_are_imported_by_name():
    """A digest cannot follow such an import, and has to refuse whatever leads to it."""
    by_name = {
        str(file.relative_to(PACKAGE))
        for file in PACKAGE.rglob("*.py")
        if {"__import__", "import_module", "exec", "eval"} & set(names(file))
    }
    assert by_name == {"fitting/registry.py", "rendering/sampling/registry.py"}
    with pytest.raises(ValueError, match=r"npfm\.fitting\.registry imports by name"):
        provenance.digest(("npfm.commands.sources",))


def test_every_model_can_be_digested():
    for model in registry.models().values():
        assert model.module in provenance.closure([model.module])


def test_every_strategy_can_be_digested():
    for strategy in sampling.strategies().values():
        assert strategy.module in provenance.closure([strategy.module])
