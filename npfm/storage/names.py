"""Names that inputs are told apart by, made from their paths."""

from collections import Counter
from collections.abc import Iterable

from npfm.errors import NpfmError


def distinct(names: Iterable[str]) -> list[str]:
    """Return the names, which stand for one input each.

    Raises
    ------
    NpfmError
        If two are the same: one would take the place of the other.
    """
    names = list(names)
    if twice := [name for name, times in Counter(names).items() if times > 1]:
        raise NpfmError(f"two inputs have the name '{twice[0]}'; rename one of them")
    return names
