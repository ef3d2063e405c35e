import ast
import os
import shutil
import subprocess
import sys

import pytest

from npfm.fitting import registry
from npfm.rendering.sampling import registry as sampling
from npfm.run import provenance

PACKAGE = provenance.PACKAGE


def forget():
    """Read files again that were read before."""
    for function in vars(provenance).values():
        if getattr(function, "__module__", "") == provenance.__name__:
            getattr(function, "cache_clear", lambda: None)()


@pytest.fixture
def copied(tmp_path, monkeypatch):
    """A copy of the package that a test may edit, and a function that digests it afresh."""
    copy = tmp_path / "npfm"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(provenance, "PACKAGE", copy)

    def digest(*entries):
        forget()
        return provenance.digest(entries)

    forget()
    yield copy, digest
    forget()


def test_what_an_earlier_process_found_is_used_and_no_edit_is_missed(copied, monkeypatch):
    copy, digest = copied
    naive = "npfm.models.naive"
    before = digest(naive)
    provenance._keep(provenance._keep_in(), provenance._kept())
    with monkeypatch.context() as nothing_parsed:
        nothing_parsed.setattr(provenance, "_imported", None)
        assert digest(naive) == before
    path = copy / "models" / "naive.py"
    path.write_text(path.read_text() + "\nUNUSED = 1\n")
    assert digest(naive) != before
    path.write_text(path.read_text().replace("\nUNUSED = 1\n", ""))
    for damaged in ("", "[]", '{"by": 1}', path.read_text()):
        provenance._keep_in().write_text(damaged)
        assert digest(naive) == before
    # Where nothing can be kept, all is looked through again.
    provenance._keep(copy / "errors.py" / "provenance.json", provenance._kept())
    assert digest(naive) == before


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
    closure = provenance.closure(["npfm.fitting.factors.microfacet"])
    assert "npfm.fitting.factors.kernels" in closure


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


def words_of(node):
    words = []
    provenance._say(node, words)
    return words


@pytest.mark.parametrize(
    ("old", "new", "same"),
    [
        ('raise ValueError("this")', 'raise ValueError("that")', True),
        ('raise ValueError(f"{x} is wrong")', 'raise ValueError(f"wrong: {x}" "!")', True),
        ("raise ValueError('this')", "raise TypeError('this')", False),
        ("raise ValueError(x)", "raise ValueError(y)", False),
        ("print('this')", "print('that')", False),
        ("x = f'a{y}'", "x = f'b{y}'", False),
        ("x = f'a{y}'", "x = f'a{z}'", False),
        ("x = f'a{y}'", 'x = "" f"a{y}" f""', True),
        ("x = ''", "x = None", False),
        ("x = 1", "x = True", False),
        ("x = 1", "x = 1.0", False),
        ("def f(): pass", "async def f(): pass", False),
        ("x = [1, [2]]", "x = [1, 2]", False),
        ("def f(): 'text'", "def f(): 'other text'", True),
        ("f(a=1)", "f(b=1)", False),
        ("x = u'a'", "x = 'a'", True),
        ("return_ = {**x}", "return_ = {x: None}", False),
    ],
)
def test_what_counts_as_the_same_code(old, new, same):
    said = [words_of(ast.parse(code)) for code in (old, new)]
    assert (said[0] == said[1]) == same


def test_fields_that_a_version_has_or_fills_in_change_nothing():
    """Python 3.12 gave functions the field type_params, and splits f-strings otherwise."""
    [function] = ast.parse("def f(a): return f'x{a}yz'").body
    before = words_of(function)
    function._fields = (*function._fields, "added")
    function.added = []
    text = function.body[0].value
    text.values = [ast.Constant(""), *text.values[:-1], ast.Constant("y"), ast.Constant("z")]
    assert words_of(function) == before


def test_every_python_on_the_machine_says_the_same_of_all_code():
    code = (
        "from npfm.run import provenance as p;"
        "files = (f.relative_to(p.PACKAGE.parent) for f in sorted(p.PACKAGE.rglob('*.py')));"
        "names = ('.'.join(f.with_suffix('').parts) for f in files if f.stem != '__init__');"
        "print(p.hashlib.sha256(' '.join(p._module(n).syntax for n in names).encode()).hexdigest())"
    )
    others = (shutil.which(f"python3.{minor}") for minor in range(11, 16))
    pythons = [sys.executable, *filter(None, others)]
    environment = os.environ | {"PYTHONPATH": str(PACKAGE.parent)}
    runs = [
        subprocess.run([python, "-c", code], env=environment, capture_output=True, text=True)
        for python in pythons
    ]
    assert len({run.stdout for run in runs if run.returncode == 0}) == 1


def test_a_library_version_changes_the_digest(monkeypatch):
    before = provenance.digest(("npfm.errors",))
    provenance.digest.cache_clear()
    monkeypatch.setattr(provenance.importlib.metadata, "version", lambda name: "0.0")
    after = provenance.digest(("npfm.errors",))
    provenance.digest.cache_clear()
    assert before != after


@pytest.mark.parametrize(
    ("library", "module", "counts"),
    [
        ("tensorly", "tucker", True),
        ("tensorly", "bivariate", False),
        ("scikit-learn", "factored", True),
        ("scikit-learn", "bivariate", False),
    ],
)
def test_the_version_of_a_library_counts_where_it_is_imported(monkeypatch, library, module, counts):
    entries = (f"npfm.models.{module}",)
    before, version = provenance.digest(entries), provenance.importlib.metadata.version
    monkeypatch.setattr(
        provenance.importlib.metadata,
        "version",
        lambda name: "0.0" if name == library else version(name),
    )
    provenance.digest.cache_clear()
    after = provenance.digest(entries)
    provenance.digest.cache_clear()
    assert (before != after) == counts


def names(file):
    for node in ast.walk(ast.parse(file.read_text())):
        yield getattr(node, "id", None) or getattr(node, "attr", None)


def test_only_what_is_chosen_by_name_is_imported_by_name():
    """A digest cannot follow such an import: who depends on one of these names the modules.

    Nothing depends on the two that pick the module of a verb and of a figure: they are digested
    alone, if at all.
    """
    by_name = {
        str(file.relative_to(PACKAGE))
        for file in PACKAGE.rglob("*.py")
        if {"__import__", "import_module", "exec", "eval"} & set(names(file))
    }
    names_of = (name.removeprefix("npfm.").replace(".", "/") for name in provenance.BY_NAME)
    assert by_name == {"__main__.py", "commands/figure.py", *(f"{name}.py" for name in names_of)}


def test_another_import_by_name_is_refused(copied):
    copy, digest = copied
    with (copy / "errors.py").open("a") as file:
        file.write("import importlib\nimportlib.import_module('x')\n")
    with pytest.raises(ValueError, match=r"npfm\.errors imports by name"):
        digest("npfm.models.naive")
    shutil.copy(PACKAGE / "errors.py", copy)


def test_every_model_can_be_digested():
    for model in registry.models().values():
        assert model.module in provenance.closure([model.module])


def test_every_strategy_can_be_digested():
    for strategy in sampling.strategies().values():
        assert strategy.module in provenance.closure([strategy.module])
