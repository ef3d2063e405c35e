"""Names that inputs are told apart by, made from their paths or given with them."""

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


def named(given: Iterable[str], example: str, taken: Iterable[str] = ()) -> dict[str, str]:
    """Return paths by the names that stand before them, as in ggx=renders/A.

    Parameters
    ----------
    given : iterable of str
    example : str
        How one may be written, for those who wrote it otherwise.
    taken : iterable of str, optional
        Names that are not free.

    Raises
    ------
    NpfmError
        If name or path is missing, or two names are the same.
    """
    pairs = [each.partition("=") for each in given]
    if wrong := ["".join(pair) for pair in pairs if not all(pair)]:
        raise NpfmError(f"'{wrong[0]}' is not written NAME=PATH, as in {example}")
    distinct([*taken, *(name for name, _, _ in pairs)])
    return {name: path for name, _, path in pairs}
