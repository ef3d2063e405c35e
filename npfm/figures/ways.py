"""Ways of choosing light directions in figures: what they are called, and how they are drawn."""

from collections.abc import Iterable

import pandas as pd

from npfm.evaluation.importance import COLUMNS, read
from npfm.figures import style

#: One colour a strategy, those of `style`; open marks are the recipes after the first.
LOOKS = {
    "cosine": style.Look("#7F7F7F", "s"),
    "uniform": style.Look("#7F7F7F", "X"),
    "light": style.Look("#E69F00", "^"),
    "half-vector": style.Look("#000000", "o"),
    "per-view": style.Look("#0072B2", "D"),
    "factored": style.Look("#D55E00", "*"),
    "lafortune": style.Look("#009E73", "v"),
    "blinn-phong": style.Look("#CC79A7", "p"),
    "quantiles": style.Look("#56B4E9", "h"),
    "visible-slopes": style.Look("#56B4E9", "d"),
    "normal-distribution": style.Look("#8C510A", "P"),
}


def read_labelled(path: str, *more: str) -> pd.DataFrame:
    """Read the table of npfm importance table, with a column `way` and `more` numbers of its own.

    Errors are those of `npfm.evaluation.tables.read`.
    """
    table = read(path, (*COLUMNS, *more))
    pairs = zip(table["strategy"], table["recipe"], strict=True)
    return table.assign(way=[label(*pair) for pair in pairs])


def label(strategy: str, recipe: str) -> str:
    """What a way is called."""
    name = strategy.replace("+", " + ")
    return f"{name} ({recipe})" if recipe else name


def looks(labels: Iterable[str]) -> dict[str, style.Look]:
    """How each way is drawn, by its label; several strategies in one are dashed."""
    chosen: dict[str, style.Look] = {}
    unknown = []
    for name in labels:
        strategy = name.partition(" (")[0]
        look = LOOKS.get(strategy)
        if look is None:
            unknown.append(name)
            continue
        again = any(other.partition(" (")[0] == strategy for other in chosen)
        chosen[name] = style.Look(look.color, look.marker, filled=not again)
    return chosen | style.looks(unknown)


def most_samples(table: pd.DataFrame, points: str) -> pd.DataFrame:
    """Rows of points of a kind, of the largest number of samples."""
    rows = table[table["points"] == points]
    return rows[rows["samples"] == rows["samples"].max()]
