"""Numbers on the command line: types of arguments that refuse what means nothing."""

import argparse
from collections.abc import Callable
from typing import Any


def whole(lowest: int, most: int | None = None) -> Callable[[str], int]:
    """Return the type of a whole number from `lowest` to `most`, if there is a `most`."""
    allowed = f"of {lowest} or more" if most is None else f"from {lowest} to {most}"

    def parse(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = None
        if number is None or number < lowest or (most is not None and number > most):
            raise argparse.ArgumentTypeError(f"'{text}': give a whole number {allowed}")
        return number

    return parse


def shape(axes: int) -> Callable[[str], Any]:
    """Return the type of so many whole numbers from 1 with x between them."""

    def parse(text: str) -> tuple[int, ...]:
        parts = text.split("x")
        # No number of bins or terms has more digits than these.
        if len(parts) != axes or not all(p.isdecimal() and len(p) < 7 and int(p) for p in parts):
            example = "x".join(["16"] * axes)
            raise argparse.ArgumentTypeError(
                f"'{text}': give {axes} whole numbers from 1 with x between them, as {example}"
            )
        return tuple(map(int, parts))

    return parse


def positive(text: str) -> float:
    """Type of a finite number above 0."""
    try:
        number = float(text)
    except ValueError:
        number = float("nan")
    if not 0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}': give a number above 0")
    return number
