"""Digests of code, so that an edit reruns the jobs that depend on it and no others.

Snakemake does not track imported modules. A rule has a digest among its params instead, of all the
code that its job runs: the entry modules and whatever they import inside `npfm`.
"""

import ast
import atexit
import hashlib
import importlib.metadata
import json
import secrets
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

PACKAGE = Path(__file__).parents[1]
#: Libraries whose versions can change results: of all code, and of that which imports them, by the
#: name that they are imported by.
LIBRARIES = ("numpy", "scipy")
WHERE_IMPORTED = {"numba": "numba", "tensorly": "tensorly", "sklearn": "scikit-learn"}

#: Where modules are imported by a name that is only known when it runs; whoever depends on one of
#: these names the modules as well.
BY_NAME = (
    "npfm.exports.registry",
    "npfm.fitting.registry",
    "npfm.fitting.solvers.choice",
    "npfm.rendering.sampling.registry",
)
#: Nodes that may have a docstring.
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
#: What runs under every verb.
ALL_VERBS = ("npfm.commands", "npfm.errors", "npfm.storage.signals")


@cache
def command_code(verb: str, *chosen: str) -> str:
    """Digest of the code that a verb runs.

    Parameters
    ----------
    verb : str
        As on the command line, with the kind that follows it, if any: ``tables psnr``.
    *chosen : str
        Modules that it is told to import: of a model, a solver, a strategy or a figure.
    """
    entries, alone = covered(verb)
    return digest((*entries, *chosen), alone)


def covered(verb: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Modules that a verb declares: with all that they import, and alone.

    The file of the verb has them in ``CODE``, and in ``CODE_OF_KIND`` by the kind that follows.
    `npfm.__main__` is left out: it picks the verb, and one verb more shall make nothing again.
    """
    name, _, kind = verb.partition(" ")
    command = f"npfm.commands.{name.replace('-', '_')}"
    declared = dict(_literals(command, ("CODE", "CODE_OF_KIND")))
    entries = (*declared["CODE"], *declared.get("CODE_OF_KIND", {}).get(kind, ()))
    return (*entries, *ALL_VERBS), (command,)


def _literals(module: str, names: Sequence[str]) -> Iterator[tuple[str, Any]]:
    for node in ast.parse(_source(module).read_bytes()).body:
        match node:
            case ast.Assign([ast.Name(name)], value) if name in names:
                yield name, ast.literal_eval(value)


@cache
def digest(entries: tuple[str, ...], alone: tuple[str, ...] = ()) -> str:
    """Digest of the code that some modules run.

    Parameters
    ----------
    entries : tuple of str
        Modules of `npfm`, by full name, taken with everything that they import inside `npfm`.
    alone : tuple of str
        Modules taken without what they import, such as a command that imports every model.

    Returns
    -------
    str
        Hexadecimal. Docstrings, comments, layout, the wording of what is raised and the version of
        Python do not matter to it; the versions of numpy and scipy do, and those of numba,
        tensorly and scikit-learn where they are imported.
    """
    modules = sorted(closure(entries) | set(alone))
    imported = {name.split(".")[0] for module in modules for name in _module(module).named}
    libraries = [*LIBRARIES, *(WHERE_IMPORTED[name] for name in WHERE_IMPORTED if name in imported)]
    parts = [f"{name} {importlib.metadata.version(name)}" for name in libraries]
    parts += [f"{module} {_module(module).syntax}" for module in modules]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def closure(entries: Iterable[str]) -> set[str]:
    """Modules of `npfm` that some modules import, themselves and packages on the way included.

    Raises
    ------
    ValueError
        If one of them imports modules by a name that is only known when it runs.
    """
    found: set[str] = set()
    waiting = list(entries)
    while waiting:
        module = waiting.pop()
        if module not in found:
            if _module(module).by_name and module not in BY_NAME:
                raise ValueError(
                    f"{module} imports by name, which no digest can follow: "
                    "give it alone, and what it imports as entries"
                )
            found.add(module)
            waiting += [*_imports(module), *_parents(module)]
    return found


def _parents(module: str) -> Iterator[str]:
    while "." in module:
        module = module.rpartition(".")[0]
        yield module


def _file(module: str) -> Path | None:
    path = PACKAGE.joinpath(*module.split(".")[1:])
    return next((f for f in (path.with_suffix(".py"), path / "__init__.py") if f.is_file()), None)


def _source(module: str) -> Path:
    if (file := _file(module)) is None:
        raise ValueError(f"there is no module {module}")
    return file


@dataclass(frozen=True)
class _Module:
    """What a module imports, by statements and whether in any other way, and what its code says.

    The syntax is a digest.
    """

    named: tuple[str, ...]
    by_name: bool
    syntax: str


@cache
def _module(module: str) -> _Module:
    """Look through a module, once: there are hundreds, and every call of Snakemake waits for it."""
    file, kept = _source(module), _kept()
    content = file.read_bytes()
    digest = hashlib.sha256(f"{file.name}\n".encode() + content).hexdigest()
    if kept.get(module, [""])[0] != digest:
        tree = ast.parse(content)
        syntax = hashlib.sha256(_syntax(tree).encode()).hexdigest()
        kept[module] = [digest, *_imported(module, tree), syntax]
        _keep_at_exit()
    _, named, by_name, syntax = kept[module]
    return _Module(tuple(named), by_name, syntax)


def _keep_in() -> Path:
    """Where Python and numba keep what they have compiled of this module."""
    return PACKAGE / "run" / "__pycache__" / "provenance.json"


def _looked_by() -> str:
    """Digest of what looks through modules."""
    return hashlib.sha256(Path(__file__).read_bytes() + sys.version.encode()).hexdigest()


@cache
def _kept() -> dict[str, list[Any]]:
    """What earlier processes found in modules, by name."""
    with suppress(OSError, ValueError, LookupError, TypeError):
        kept = json.loads(_keep_in().read_text("utf-8"))
        if kept["by"] == _looked_by():
            return dict(kept["modules"])
    return {}


@cache
def _keep_at_exit() -> None:
    atexit.register(_keep, _keep_in(), _kept())


def _keep(path: Path, modules: dict[str, list[Any]]) -> None:
    """Keep what was found, if there is a place for it."""
    temporary = path.with_name(f"{path.name}.tmp.{secrets.token_hex(8)}")
    with suppress(OSError):
        path.parent.mkdir(exist_ok=True)
        temporary.write_text(json.dumps({"by": _looked_by(), "modules": modules}), "utf-8")
        temporary.replace(path)
    with suppress(OSError):
        temporary.unlink(missing_ok=True)


def _imported(module: str, tree: ast.Module) -> tuple[list[str], bool]:
    """Names in the import statements of a module, and whether it imports by another way."""
    named: set[str] = set()
    by_name = False
    for node in ast.walk(tree):
        match node:
            case ast.Import(names):
                named |= {alias.name for alias in names}
            case ast.ImportFrom(_, names):
                source = _absolute(module, node)
                named |= {source, *(f"{source}.{alias.name}" for alias in names)}
            case ast.Name(id=name) | ast.Attribute(attr=name):
                by_name |= name in ("import_module", "__import__")
    return sorted(named), by_name


@cache
def _imports(module: str) -> frozenset[str]:
    """Modules of `npfm` that a module imports itself."""
    return frozenset(n for n in _module(module).named if n.split(".")[0] == "npfm" and _file(n))


def _absolute(module: str, node: ast.ImportFrom) -> str:
    if node.module and not node.level:
        return node.module
    is_package = _source(module).name == "__init__.py"
    base = module.split(".")[: None if is_package and node.level == 1 else is_package - node.level]
    return ".".join([*base, node.module] if node.module else base)


def _syntax(tree: ast.Module) -> str:
    """What the code of a module says, as text."""
    words: list[str] = []
    _say(tree, words)
    return " ".join(words)


def _say(node: ast.AST, words: list[str], raised: bool = False) -> None:
    """Add the words that say what a syntax tree does, whichever version of Python parsed it.

    Versions differ in how they print a tree and in the fields that they leave empty: so these are
    our own words, and nothing is said of what is empty. Nor is anything of docstrings, and of text
    in a ``raise``, `raised` below one: no output depends on the wording of a complaint.
    """
    raised = raised or isinstance(node, ast.Raise)
    if raised and _is_text(node):
        return
    words.append(f"({type(node).__name__}")
    for name, value in sorted(ast.iter_fields(node)):
        if name in ("ctx", "kind", "type_comment") or value is None or value == []:
            continue
        words.append(f"{name}=")
        for part in _parts(node, name, value):
            if isinstance(part, ast.AST):
                _say(part, words, raised)
            else:
                words.append(f"{type(part).__name__}:{part!a}")
    words.append(")")


def _parts(node: ast.AST, name: str, value: Any) -> list[Any]:
    """Values of a field: without a docstring, and with the text of an f-string in one piece."""
    parts = value if isinstance(value, list) else [value]
    if name == "body" and isinstance(node, DOCUMENTED):
        return parts[1:] if ast.get_docstring(node, clean=False) is not None else parts
    if isinstance(node, ast.JoinedStr):
        runs = groupby(parts, key=lambda part: isinstance(part, ast.Constant))
        return [x for text, run in runs for x in (_joined(run) if text else run)]
    return parts


def _joined(constants: Iterable[ast.Constant]) -> list[str]:
    text = "".join(str(constant.value) for constant in constants)
    return [text] if text else []


def _is_text(node: ast.AST) -> bool:
    plain = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return plain or isinstance(node, ast.JoinedStr)
