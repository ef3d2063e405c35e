"""Parameters that other authors published for the MERL materials, read from ``.fit`` files.

One line a material, ``name = Aggregate(Lambertian(albedo = [r, g, b]), Model(parameter = value,
...))``, as in the folder ``fits`` of the public repository bsdfbenchmark/bbm; ``#`` begins a
comment.
"""

import ast
import codecs
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest
from npfm.storage.lookalikes import mistaken

#: Values by name; `DIFFUSE` is the albedo of the Lambertian part.
Parameters = Mapping[str, NDArray[np.float64]]
DIFFUSE = "diffuse albedo"
ORIGIN = "get it from the folder fits of github.com/bsdfbenchmark/bbm"
#: A line has some 300 bytes; 10 000 materials fit.
MOST_BYTES = 2**24


def read(
    path: str | Path, *, model: str, shapes: Mapping[str, tuple[int, ...]]
) -> dict[str, Parameters]:
    """Read a ``.fit`` file.

    Parameters
    ----------
    path : str or Path
        The file.
    model : str
        The model in its lines, as they name it.
    shapes : mapping of str to tuple of int
        Of each parameter of that model.

    Returns
    -------
    dict of str to Parameters
        By the name of the material.

    Raises
    ------
    NpfmError
        If the file is absent or no text, a line is malformed or of another model, or a material
        is in two lines; with the number of the line.
    """
    path = Path(path)
    lines = _text(path).splitlines()
    found: dict[str, Parameters] = {}
    seen: dict[str, int] = {}
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            name, parameters = _entry(line, model, shapes)
            if name in seen:
                raise ValueError(
                    f"'{name}' is in line {seen[name]} already; keep one of the two lines"
                )
        except ValueError as error:
            raise NpfmError(f"{path}, line {number}: {error}") from None
        found[name], seen[name] = parameters, number
    if not found:
        raise NpfmError(f"{path}: no material in it; {ORIGIN}")
    return found


def _text(path: Path) -> str:
    """Text of a file in UTF-8, or in UTF-16 with a byte-order mark."""
    try:
        if other := mistaken(path, "a .fit file"):
            raise NpfmError(f"{path}: {other}, or {ORIGIN}")
        content = path.read_bytes() if path.stat().st_size <= MOST_BYTES else b""
    except OSError as error:
        why = "no such file" if isinstance(error, FileNotFoundError) else str(error)
        raise NpfmError(f"{path}: {why}; {ORIGIN}") from None
    if not content:
        raise NpfmError(f"{path}: more than {MOST_BYTES} bytes, too many for a .fit file; {ORIGIN}")
    wide = content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
    try:
        text = content.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError as error:
        number = content.count(b"\n", 0, error.start) + 1
        raise NpfmError(
            f"{path}, line {number}: no text in UTF-8 ({error.reason}); save it as UTF-8, or "
            f"{ORIGIN}"
        ) from None
    if "\0" in text:
        raise NpfmError(f"{path}: no text, it holds zero bytes; {ORIGIN}")
    return text


def _entry(line: str, model: str, shapes: Mapping[str, tuple[int, ...]]) -> tuple[str, Parameters]:
    name, equals, text = (part.strip() for part in line.partition("="))
    try:
        aggregate: Any = ast.parse(text, mode="eval").body
        outer, arguments = aggregate.func.id, aggregate.args
        if aggregate.keywords:
            raise ValueError("an aggregate of more than its two parts")
        (base, diffuse), (lobe, parameters) = (_call(node) for node in arguments)
    except (SyntaxError, ValueError, AttributeError, TypeError, MemoryError, RecursionError):
        outer = base = None
    if not name or not equals or (outer, base) != ("Aggregate", "Lambertian"):
        raise ValueError(
            "not of the form 'name = Aggregate(Lambertian(albedo = [r, g, b]), "
            f"{model}(...))'; correct the line or leave it out"
        )
    if lobe != model:
        raise ValueError(f"unknown model '{lobe}'; {suggest(lobe, [model])}")
    checked = _checked("Lambertian", diffuse, {"albedo": (3,)})
    return name, {DIFFUSE: checked["albedo"], **_checked(model, parameters, shapes)}


def _call(node: Any) -> tuple[str, dict]:
    if node.args or any(keyword.arg is None for keyword in node.keywords):
        raise ValueError("a value without a name")
    values = {keyword.arg: ast.literal_eval(keyword.value) for keyword in node.keywords}
    return node.func.id, values


def _checked(
    model: str, values: Mapping[str, object], shapes: Mapping[str, tuple[int, ...]]
) -> dict[str, NDArray[np.float64]]:
    if unknown := sorted(values.keys() - shapes):
        raise ValueError(f"{model} has no '{unknown[0]}'; {suggest(unknown[0], shapes)}")
    checked = {}
    for name, shape in shapes.items():
        if name not in values:
            raise ValueError(f"{model} lacks '{name}'; complete the line or leave it out")
        try:
            checked[name] = np.asarray(values[name], dtype=float)
        except (ValueError, TypeError, OverflowError):
            checked[name] = np.array(np.nan)
        if checked[name].shape != shape or not np.isfinite(checked[name]).all():
            wanted = " x ".join(map(str, shape)) or "1"
            raise ValueError(
                f"{name} of {model} is {values[name]}; {wanted} finite numbers are expected"
            )
    return checked
