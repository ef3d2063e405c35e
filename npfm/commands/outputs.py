"""Outputs on the command line: what may be written where, checked before anything is done."""

import argparse
import os
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

from npfm.errors import NpfmError
from npfm.storage.files import Kind, check_replaceable


class Output(str):
    """The path of an output; its type tells it from an input.

    Parameters
    ----------
    text : str
        What the person gave.
    beside : iterable of Path
        What is written beside it.
    """

    beside: tuple[Path, ...]

    def __new__(cls, text: str, beside: Iterable[Path] = ()) -> "Output":
        """Keep what is written beside it with the text, which nothing changes afterwards."""
        made = super().__new__(cls, text)
        made.beside = tuple(beside)
        return made


def output(*kinds: Kind, beside: Kind | None = None) -> Callable[[str], Output]:
    """Return the type of an output that is of one of the kinds.

    Parameters
    ----------
    *kinds : Kind
        What it may be, and what it may replace.
    beside : Kind, optional
        What is written under the same name with the suffix of that kind.
    """

    def parse(text: str) -> Output:
        check_replaceable(text, *kinds)
        if beside is None:
            return Output(text)
        other = Path(text).with_suffix(beside.suffix)
        check_replaceable(other, beside)
        return Output(text, [other])

    return parse


def check(arguments: argparse.Namespace) -> None:
    """Refuse outputs that are inputs as well, or two outputs of which one would be lost.

    Raises
    ------
    NpfmError
        If there are such.
    """
    places = [path.absolute() for path in written(arguments)]
    for k, path in enumerate(places):
        if any(path in (other, *other.parents) for other in (*places[:k], *places[k + 1 :])):
            raise NpfmError(f"{path}: two outputs in one place; give another name to one of them")
    for value in _flat(vars(arguments).values()):
        # As in naive=fits/naive.npz.
        for given in () if isinstance(value, Output) else (value, str(value).partition("=")[2]):
            if os.path.isfile(given) and any(_same(given, out) for out in places):
                raise NpfmError(f"{given}: an input, and an output; give the output another name")


def written(arguments: argparse.Namespace) -> list[Path]:
    """Return what a verb writes, with what it writes beside it."""
    outputs = [value for value in _flat(vars(arguments).values()) if isinstance(value, Output)]
    return [Path(path) for out in outputs for path in (Path(out), *out.beside)]


def _flat(values: Iterable) -> Iterator[str | Path]:
    """Texts and paths among values, and in lists of them."""
    for value in values:
        if isinstance(value, (str, Path)):
            yield value
        elif isinstance(value, list):
            yield from _flat(value)


def _same(path: str | Path, out: Path) -> bool:
    return out.exists() and os.path.samefile(path, out)
