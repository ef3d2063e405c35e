"""Words of a job's command line, and what stands for those that Snakemake cannot take.

A command is one argument of a shell, which the system limits to 128 KiB; and Snakemake takes braces
in the path of an input for a wildcard. Long lists travel in a file that ``@file`` names, and such
a path has a link. Both are made where they are needed, named after their contents.
"""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from npfm.storage.files import Kind, marked, replacing

#: Beside what Snakemake itself keeps in the folder that it runs in.
FOLDER = Path(".snakemake/npfm")
#: Bytes of a list that still stands in the command itself; a command has a few lists.
LONGEST = 2**14
LIST = Kind("a list of words", ".txt", marked(b"\n"))
LINK = Kind("a link", "", Path.is_symlink)


def words(items: Iterable[str]) -> list[str]:
    """Return a list as words of a command, or the one word that names a file of them.

    Parameters
    ----------
    items : iterable of str, or str
        None has a line break. A text is a list of one, as where a rule has one output.
    """
    listed = _listed(items)
    content = "".join(f"{item}\n" for item in listed)
    if len(content.encode()) <= LONGEST:
        return listed
    path = FOLDER / f"{_digest(content)}.txt"
    if not path.exists():
        with replacing(path, LIST) as temporary:
            temporary.write_text(content)
    return [f"@{path}"]


def option(name: str, items: Iterable[str]) -> list[str]:
    """Return an option with its list, or nothing for an empty one."""
    listed = _listed(items)
    return [name, *words(listed)] if listed else []


def _listed(items: Iterable[str]) -> list[str]:
    return [items] if isinstance(items, str) else list(items)


def path_word(path: str) -> str:
    """Return a path as a word that is taken for no option and for no list of words."""
    return f"./{path}" if path.startswith(("-", "@")) else path


def as_input(path: str) -> str:
    """Return a path that Snakemake can take for an input: of braces, a link to what it leads to."""
    if "{" not in path:
        return path
    link = FOLDER / _digest(str(Path(path).absolute()))
    if not link.is_symlink():
        with replacing(link, LINK) as temporary:
            os.symlink(Path(path).absolute(), temporary)
    return str(link)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]
