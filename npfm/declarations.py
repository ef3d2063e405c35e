"""Files that declare a NAME: models and strategies are found by it, and listed nowhere else.

What a file declares is read from its syntax, so that nothing is imported only to check a
configuration.
"""

import ast
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any

from npfm.errors import NpfmError

#: Names of models and strategies, and of all that becomes a file or a word of a command: no file
#: system and no shell reads them otherwise, and none can be taken for an option.
NAME_PATTERN = "[A-Za-z0-9][A-Za-z0-9._-]{0,99}"
NAMES_ARE = "a name is of A-Z, a-z, 0-9 and, not at its beginning, '.', '_' and '-'; 100 at most"


def is_name(name: Any) -> bool:
    """Whether something fits the pattern."""
    return isinstance(name, str) and re.fullmatch(NAME_PATTERN, name) is not None


def named_files(
    folder: Path, known: Collection[str], what: str
) -> dict[str, tuple[Path, dict[str, Any]]]:
    """Files of a folder that have a constant NAME, by that name, sorted, with what they declare.

    Parameters
    ----------
    folder : Path
    known : collection of str
        What is read beside the name, each from a constant of that name in capitals.
    what : str
        What such a file is, for messages.

    Raises
    ------
    NpfmError
        If a file cannot be parsed, a declaration in it is no literal, or two files have the same
        name.
    """
    found: dict[str, tuple[Path, dict[str, Any]]] = {}
    for path in sorted(folder.glob("*.py")):
        constants = _constants(path, {"name", *known})
        if "name" not in constants:
            continue
        name = constants.pop("name")
        if not is_name(name):
            raise NpfmError(f"{path}: the NAME {name!r}: {NAMES_ARE}; choose another")
        if name in found:
            raise NpfmError(f"{path}: there is another {what} of the NAME '{name}'; choose another")
        found[name] = path, constants
    return dict(sorted(found.items()))


def _constants(path: Path, known: Collection[str]) -> dict[str, Any]:
    """Declarations in a file, by their names in lower case."""
    try:
        statements = ast.parse(path.read_text()).body
    except SyntaxError as error:
        raise NpfmError(f"{path}, line {error.lineno}: {error.msg}; correct it") from error
    constants = {}
    for node in statements:
        match node:
            case ast.Assign([ast.Name(key)], value) if key.isupper() and key.lower() in known:
                try:
                    constants[key.lower()] = ast.literal_eval(value)
                except ValueError as error:
                    where = f"{path}, line {node.lineno}"
                    raise NpfmError(f"{where}: {key} is no literal; write it out") from error
    return constants
