"""Formats by name. Each is imported when it is asked for.

A format is a file of this folder that has a constant NAME; there is no other list of them
(`npfm.exports` says what such a file has). `npfm.run.provenance` refuses to digest this module:
whoever writes a format names the format's own module as an entry.
"""

import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from types import ModuleType

from npfm.declarations import named_files
from npfm.errors import NpfmError, suggest
from npfm.exports.sources import Source
from npfm.reflectance.half_difference import HalfDifference

FOLDER = Path(__file__).parent
#: What the module of a format has to have.
INTERFACE = ("KIND", "write")


@dataclass(frozen=True)
class Format:
    """What the file of a format declares, each in a constant of that name in capitals.

    Parameters
    ----------
    module : str
        Full name of the module that the file is.
    about : str
        What is written and who reads it, in a line.
    suffix : str
        How names of what is written end, with the dot; of a folder, nothing.
    models : tuple of str
        Models whose fits it can say; any, if none is named.
    tables : bool
        Whether a measured table will do in place of a fit.
    many : bool
        Whether it holds several materials.
    grids : tuple of str
        Kinds of the grids that it can say.
    parts : tuple of str
        Globs of files below this folder that are no Python and that it is made of.
    settings : mapping of str to str
        Whole numbers that `write` takes as keywords, each with what it means.
    """

    module: str
    about: str
    suffix: str
    models: tuple[str, ...] = ()
    tables: bool = False
    many: bool = False
    grids: tuple[str, ...] = (HalfDifference.kind,)
    parts: tuple[str, ...] = ()
    settings: Mapping[str, str] = field(default_factory=dict)

    @property
    def files(self) -> list[Path]:
        """What `parts` stand for."""
        return sorted(path for part in self.parts for path in FOLDER.glob(part))

    def load(self) -> ModuleType:
        """Import the format: its `KIND` and `write`.

        Raises
        ------
        NpfmError
            If its file lacks one of them.
        """
        module = importlib.import_module(self.module)
        if missing := [name for name in INTERFACE if not hasattr(module, name)]:
            raise NpfmError(f"{module.__file__}: no '{missing[0]}'; every format needs one")
        return module


@cache
def formats() -> Mapping[str, Format]:
    """What the formats declare, by name, sorted.

    Raises
    ------
    NpfmError
        If a file of the folder cannot be parsed, a declaration in it is no literal, or two files
        have the same name for their format.
    """
    known = {part.name for part in fields(Format)} - {"module"}
    return {
        name: Format(f"npfm.exports.{path.stem}", **constants)
        for name, (path, constants) in named_files(FOLDER, known, "format").items()
    }


def declared(name: str) -> Format:
    """Return what the format of that name declares.

    Raises
    ------
    NpfmError
        If there is no format of that name.
    """
    if name not in formats():
        raise NpfmError(f"unknown format '{name}'; {suggest(name, formats())}")
    return formats()[name]


def check(name: str, sources: Sequence[Source]) -> None:
    """Refuse what a format cannot say.

    Raises
    ------
    NpfmError
        If there are several sources and it holds one, or one is a table, a fit of a model or on a
        grid that it is not for.
    """
    known = declared(name)
    if len(sources) > 1 and not known.many:
        raise NpfmError(f"'{name}' is of one material, and there are {len(sources)}; give one")
    for source in sources:
        if not (source.is_fit or known.tables):
            raise NpfmError(
                f"{source.path}: '{name}' is made from a fit (.npz); fit a model to the table first"
            )
        if source.is_fit and known.models and source.fit.model not in known.models:
            raise NpfmError(
                f"{source.path}: a fit of {source.fit.model}, and '{name}' is made from fits of "
                f"{' or '.join(known.models)}; give one of these"
            )
        if (grid := source.grid).kind not in known.grids:
            raise NpfmError(
                f"{source.path}: '{name}' cannot hold a material on a {grid.kind} grid; "
                f"it is for {' or '.join(known.grids)} grids"
            )
