"""Strategies by name. Each is imported when it is asked for.

A strategy is a file of this folder that has a constant NAME; there is no other list of them.
`npfm.run.provenance` refuses to digest this module: whoever runs a strategy names the strategy's
own module as an entry.
"""

import importlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path

from npfm.declarations import named_files
from npfm.errors import NpfmError, suggest
from npfm.rendering.sampling.strategy import Given, Strategy

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Declared:
    """What the file of a strategy declares, each in a constant of that name in capitals.

    Parameters
    ----------
    module : str
        Full name of the module that the file is.
    needs : tuple of str
        Optional parts of `npfm.rendering.sampling.strategy.Given` that it cannot do without.
    """

    module: str
    needs: tuple[str, ...] = ()


@cache
def strategies() -> Mapping[str, Declared]:
    """What the strategies declare, by name, sorted.

    Raises
    ------
    NpfmError
        If a file of the folder cannot be parsed, a declaration in it is no literal, or two files
        have the same name for their strategy.
    """
    known = {field.name for field in fields(Declared)} - {"module"}
    return {
        name: Declared(f"npfm.rendering.sampling.{path.stem}", **constants)
        for name, (path, constants) in named_files(FOLDER, known, "strategy").items()
    }


def for_any_material() -> list[str]:
    """Names of the strategies that need no material: those that a scene can be built with."""
    return [name for name, declared in strategies().items() if not declared.needs]


def modules(names: Iterable[str]) -> tuple[str, ...]:
    """Full names of the modules of strategies.

    Raises
    ------
    NpfmError
        If there is no strategy of one of the names.
    """
    return tuple(_declared(name).module for name in names)


def make(names: Sequence[str], given: Given) -> list[Strategy]:
    """Make strategies from what they need.

    Raises
    ------
    NpfmError
        If there is no strategy of one of the names, one is named twice, something that it needs
        is not given, or its file has no function `make`.
    """
    check(names)
    for name in names:
        for part in _declared(name).needs:
            if not getattr(given, part):
                raise NpfmError(f"the strategy '{name}' needs the {part} of a material; give it")
    made = []
    for module in map(importlib.import_module, modules(names)):
        if not hasattr(module, "make"):
            raise NpfmError(f"{module.__file__}: no function 'make'; every strategy needs one")
        made.append(module.make(given))
    return made


def check(names: Sequence[str]) -> None:
    """Raise an NpfmError if a name is not that of a strategy, or is listed twice."""
    for name in names:
        _declared(name)
    if len(set(names)) < len(names):
        raise NpfmError(f"a strategy is listed twice: {', '.join(names)}")


def check_scene(names: Sequence[str]) -> None:
    """Raise an NpfmError, as `check` does, also if one of the strategies needs a material."""
    check(names)
    for name in names:
        if _declared(name).needs:
            raise NpfmError(
                f"the strategy '{name}' follows one material, and a scene is built once for all; "
                f"choose from {', '.join(for_any_material())}"
            )


def _declared(name: str) -> Declared:
    if name not in strategies():
        raise NpfmError(f"unknown strategy '{name}'; {suggest(name, strategies())}")
    return strategies()[name]
