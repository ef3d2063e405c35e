"""Materials that would be missed for the spelling of their names alone."""

import unicodedata
from collections.abc import Collection
from difflib import get_close_matches
from pathlib import Path

from npfm.datasets.names import MERL_NAMES
from npfm.errors import NpfmError

#: Names so similar (`difflib`, 0 to 1) are taken for one that is misspelt.
NEARLY = 0.85


def check_spelling(path: str | Path, found: Collection[str], wanted: Collection[str]) -> None:
    """Check that no material is missed for the spelling of its name alone.

    A file may lack materials, and may have more than a run. What it must not have is a name that
    nobody knows, of MERL or of the run, and that is nearly that of a material which it lacks.

    Parameters
    ----------
    path : str or Path
        Of what was published, for the message.
    found : collection of str
        Names in the file.
    wanted : collection of str
        Names of the run's materials.

    Raises
    ------
    NpfmError
        If there is such a name.
    """
    strangers = {_plain(name): name for name in found if name not in {*MERL_NAMES, *wanted}}
    for name in sorted(set(wanted) - set(found)):
        if near := get_close_matches(_plain(name), strangers, n=1, cutoff=NEARLY):
            raise NpfmError(
                f"{path}: has no '{name}' but '{strangers[near[0]]}', which is no material of MERL "
                "or of this run; correct the name in the file"
            )


def _plain(name: str) -> str:
    """A name without what a look does not tell apart: case, kinds of dashes and blanks."""
    letters = unicodedata.normalize("NFKD", name).casefold().removesuffix(".binary")
    seen = (c for c in letters if unicodedata.category(c) not in ("Cc", "Cf", "Mn"))
    dashed = ("-" if c in "_. " or unicodedata.category(c) in ("Pd", "Zs") else c for c in seen)
    return "".join(dashed)
