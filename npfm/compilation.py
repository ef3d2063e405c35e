"""Loops that are compiled when their module is imported, and kept from one process to the next."""

import warnings
from collections.abc import Callable
from functools import cache
from typing import Any, TypeVar, cast

from numba import njit

from npfm.errors import NpfmWarning

Pass = TypeVar("Pass", bound=Callable)

#: Of passes that divide as NumPy does, by 0 too, and may add a product without rounding it.
ARITHMETIC: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract"}}
UNCACHED = (
    "compiled code cannot be kept, and each process compiles for some seconds; "
    "set NUMBA_CACHE_DIR to a folder that can be written"
)


@cache
def _warn_once() -> None:
    warnings.warn(UNCACHED, NpfmWarning, stacklevel=1)


def compiled(signature: Any, **options: Any) -> Callable[[Pass], Pass]:
    """Return a decorator that compiles for a signature at once, cached where that is possible.

    Functions that a compiled one calls have to stand in its file: numba looks at no other to tell
    whether what it has kept is out of date.

    Parameters
    ----------
    signature : str or numba signature
    **options
        Of `numba.njit`.
    """

    def decorated(function: Pass) -> Pass:
        try:
            return cast(Pass, njit(signature, cache=True, **options)(function))
        except (RuntimeError, OSError):  # numba finds no place for it, or the place is full
            _warn_once()
            return cast(Pass, njit(signature, **options)(function))

    return decorated


def inner(function: Pass) -> Pass:
    """Compile a function that compiled ones of its file call, with their `ARITHMETIC`."""
    return cast(Pass, njit(**ARITHMETIC)(function))
