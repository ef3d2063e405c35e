"""Names that become files and words of commands: all of `npfm.declarations.NAME_PATTERN`."""

import re
from collections.abc import Iterable
from typing import Any

from npfm.declarations import NAMES_ARE, is_name
from npfm.errors import NpfmError


def check_names(names: Iterable[Any], what: str, rename: str = "it") -> None:
    """Refuse names outside the pattern.

    Parameters
    ----------
    names : iterable
        What a person called things.
    what : str
        What these are, such as ``scene``.
    rename : str
        What to rename, if not the name in the configuration itself.

    Raises
    ------
    NpfmError
        If a name does not fit; it says what to rename.
    """
    for name in names:
        if not is_name(name):
            # YAML reads 1, yes and 2020-01-01 as something else than a text.
            hint = f"rename {rename}" if isinstance(name, str) else f"write '{name}' in quotes"
            raise NpfmError(f"config: the {what} {name!r}: {NAMES_ARE}; {hint}")


def any_of(names: Iterable[str]) -> str:
    """Return a regular expression of some names and nothing else, for a wildcard."""
    return "|".join(map(re.escape, names)) or "(?!)"
