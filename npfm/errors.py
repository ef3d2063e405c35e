"""The exception and the warning that are meant for the user's eyes, and hints to go with them."""

from collections.abc import Iterable
from difflib import get_close_matches


class NpfmError(Exception):
    """A mistake in the input, told in one line: what is wrong, where, and what to do.

    The command line prints the message without a traceback and exits with code 1.
    """


class NpfmWarning(UserWarning):
    """What the user should know though the work goes on; the command line prints it as one line."""


#: So many names are listed in a message rather than the nearest of them.
FEW = 8


def suggest(name: str, available: Iterable[str]) -> str:
    """End an error message with what there is instead of a name that does not exist.

    Parameters
    ----------
    name : str
        The name that does not exist.
    available : iterable of str
        The names that do.

    Returns
    -------
    str
        The nearest names if there are any near, else all of them if they are few.
    """
    available = sorted(set(available))
    # A key of YAML may be a number.
    near = get_close_matches(str(name).lower(), available, n=3, cutoff=0.5)
    if near:
        return f"did you mean {' or '.join(near)}?"
    if len(available) <= FEW:
        return (
            f"choose from {', '.join(available)}" if available else "there is none to choose from"
        )
    return f"the {len(available)} names run from {available[0]} to {available[-1]}"
