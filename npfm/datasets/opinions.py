"""How different people found pictures of fits from pictures of the measurements.

The files of Lavoué et al. 2021, "Perceptual Quality of BRDF approximations: dataset and metrics":
``PerceptualDistances.csv`` with the columns METHOD, BRDF and DISTANCE, and ``MaterialType.csv``
with BRDF and Type, divided by semicolons.
"""

import csv
import io
from collections.abc import Iterator, Sequence
from pathlib import Path

import pandas as pd

from npfm.declarations import is_name
from npfm.errors import NpfmError
from npfm.storage.lookalikes import mistaken

DISTANCES, CLASSES = "PerceptualDistances.csv", "MaterialType.csv"
#: The published files have 85 and 3 KB.
MOST_BYTES = 2**22
ORIGIN = "get it from the folder Data of github.com/nbonneel/PerceptualBRDF"


def read(path: str | Path) -> pd.DataFrame:
    """Read ``PerceptualDistances.csv``.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    DataFrame
        Columns method, material, distance: 0 for pictures that nobody told apart, 1 for the most
        different.

    Raises
    ------
    NpfmError
        If the file is absent, of another format, or names a pair twice; with the number of the
        line.
    """
    rows: dict[tuple[str, str], float] = {}
    for number, (method, material, text) in _rows(path, ("METHOD", "BRDF", "DISTANCE")):
        where = f"{path}, line {number}"
        try:
            distance = float(text)
        except ValueError:
            distance = float("nan")
        if not 0 <= distance <= 1:
            raise NpfmError(f"{where}: the distance {text[:40]!r} is not from 0 to 1; {ORIGIN}")
        _check(method, "method", where)
        _check(material, "material", where)
        if (method, material) in rows:
            raise NpfmError(f"{where}: '{method}' of '{material}' is there already; keep one")
        rows[method, material] = distance
    if not rows:
        raise NpfmError(f"{path}: no distance in it; {ORIGIN}")
    table = [(*pair, distance) for pair, distance in rows.items()]
    return pd.DataFrame(table, columns=["method", "material", "distance"])


def classes(path: str | Path) -> dict[str, str]:
    """Read ``MaterialType.csv``: the class of each material, as `Metal` or `Dielectric`.

    Raises
    ------
    NpfmError
        If the file is absent, of another format, or has two classes for a material.
    """
    found: dict[str, str] = {}
    for number, (material, kind) in _rows(path, ("BRDF", "Type")):
        where = f"{path}, line {number}"
        _check(kind, "class", where)
        if found.setdefault(material, kind) != kind:
            raise NpfmError(f"{where}: '{material[:40]}' is of two classes; keep one")
    return found


def _check(name: str, what: str, where: str) -> None:
    if not is_name(name):
        raise NpfmError(f"{where}: {name[:40]!r} is no name of a {what}; {ORIGIN}")


def _rows(path: str | Path, columns: Sequence[str]) -> Iterator[tuple[int, list[str]]]:
    """Rows below the header, each with the number of its line."""
    rows = csv.reader(io.StringIO(_text(Path(path)), newline=""), delimiter=";", strict=True)
    try:
        header = next(rows, [])
        if header != list(columns):
            raise NpfmError(f"{path}: its first line is not '{';'.join(columns)}'; {ORIGIN}")
        for row in rows:
            if len(row) != len(columns):
                raise NpfmError(
                    f"{path}, line {rows.line_num}: {len(row)} columns, {len(columns)} are "
                    f"expected; {ORIGIN}"
                )
            yield rows.line_num, row
    except csv.Error as error:
        raise NpfmError(f"{path}, line {rows.line_num}: {error}; {ORIGIN}") from None


def _text(path: Path) -> str:
    try:
        if other := mistaken(path, "a table of opinions (.csv)"):
            raise NpfmError(f"{path}: {other}, or {ORIGIN}")
        if path.stat().st_size > MOST_BYTES:
            raise NpfmError(f"{path}: more than {MOST_BYTES} bytes, too many for it; {ORIGIN}")
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise NpfmError(f"{path}: no such file; {ORIGIN}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise NpfmError(f"{path}: cannot be read as text ({error}); {ORIGIN}") from None
