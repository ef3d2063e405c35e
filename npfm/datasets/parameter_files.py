"""Parameters that other authors published for the MERL materials, read from ``.fit`` files.

One line a material, ``name = Aggregate(Lambertian(albedo = [r, g, b]), Model(parameter = value,
...))``, as in the folder ``fits`` of the public repository bsdfbenchmark/bbm; ``#`` begins a
comment.
"""

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError, suggest

#: Values by name; `DIFFUSE` is the albedo of the Lambertian part.
Parameters = Mapping[str, NDArray[np.float64]]
DIFFUSE = "diffuse albedo"
ORIGIN = "get it from the folder fits of github.com/bsdfbenchmark/bbm"


@dataclass(frozen=True)
class FitFile:
    """What a file holds: its name, the model in its lines, and the shape of each parameter."""

    name: str
    model: str
    shapes: Mapping[str, tuple[int, ...]]


def read(path: str | Path, file: FitFile) -> dict[str, Parameters]:
    """Read a ``.fit`` file.

    Parameters
    ----------
    path : str or Path
        The file.
    file : FitFile
        What it should hold.

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
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        why = "no such file" if isinstance(error, FileNotFoundError) else f"no text ({error})"
        raise NpfmError(f"{path}: {why}; {ORIGIN}") from None
    found: dict[str, Parameters] = {}
    seen: dict[str, int] = {}
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            name, parameters = _entry(line, file)
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


def _entry(line: str, file: FitFile) -> tuple[str, Parameters]:
    name, equals, text = (part.strip() for part in line.partition("="))
    try:
        aggregate = ast.parse(text, mode="eval").body
        outer, arguments = aggregate.func.id, aggregate.args
        (base, diffuse), (model, parameters) = (_call(node) for node in arguments)
    except (SyntaxError, ValueError, AttributeError, TypeError, MemoryError, RecursionError):
        outer = base = None
    if not name or not equals or (outer, base) != ("Aggregate", "Lambertian"):
        raise ValueError(
            "not of the form 'name = Aggregate(Lambertian(albedo = [r, g, b]), "
            f"{file.model}(...))'; correct the line or leave it out"
        )
    if model != file.model:
        raise ValueError(f"unknown model '{model}'; {suggest(model, [file.model])}")
    checked = _checked("Lambertian", diffuse, {"albedo": (3,)})
    return name, {DIFFUSE: checked["albedo"], **_checked(model, parameters, file.shapes)}


def _call(node: ast.expr) -> tuple[str, dict]:
    if node.args:
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
        except (ValueError, TypeError):
            checked[name] = np.array(np.nan)
        if checked[name].shape != shape or not np.isfinite(checked[name]).all():
            wanted = " x ".join(map(str, shape)) or "1"
            raise ValueError(
                f"{name} of {model} is {values[name]}; {wanted} finite numbers are expected"
            )
    return checked
