"""Whether a configuration has the keys and the kinds of values that the schema names."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from npfm.errors import NpfmError, suggest

SCHEMA = Path(__file__).parents[2] / "workflow" / "schemas" / "config.schema.yaml"


#: Keys of earlier versions, by where they stood, and what to write instead.
MOVED = {
    "seed": "the seed of random starts is solver: {seed: N}; a scene and dataset have their own",
    "solver/starts": "a setting of a model stands with it: models: {independent-g: {starts: N}}",
    "variants/solver/starts": "a setting of a model stands beside it: {name, model, starts: N}",
}


def settled(config: Mapping[str, Any]) -> dict[str, Any]:
    """Return a configuration without what a preset took out of the one that it was laid over.

    That is, without entries that are ``null``, and without the ``generate`` of a light that has a
    ``file``.
    """
    settled = _without_nulls(config)
    lights = settled.get("lights")
    for light in lights.values() if isinstance(lights, dict) else ():
        if isinstance(light, dict) and "file" in light:
            light.pop("generate", None)
    return settled


def _without_nulls(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_nulls(kept) for key, kept in value.items() if kept is not None}
    return value


def _moved(config: Mapping[str, Any]) -> Iterator[str]:
    """Keys of `MOVED` that a configuration has."""
    if "seed" in config:
        yield "seed"
    entries = config.get("variants", [])
    own = [entry.get("solver") for entry in entries if isinstance(entry, Mapping)]
    for where, solvers in (("solver", [config.get("solver")]), ("variants/solver", own)):
        if any(isinstance(solver, Mapping) and "starts" in solver for solver in solvers):
            yield f"{where}/starts"


def _not_finite(value: Any, where: str = "") -> Iterator[str]:
    """Places of NaN and infinities, which no bound of the schema keeps out: NaN < 0 is false."""
    if isinstance(value, (Mapping, list)):
        for key, inner in value.items() if isinstance(value, Mapping) else enumerate(value):
            yield from _not_finite(inner, f"{where}/{key}" if where else f"{key}")
    elif isinstance(value, float) and not math.isfinite(value):
        yield f"{where}: {value} is not a finite number"


def check_schema(config: Mapping[str, Any]) -> None:
    """Check keys and kinds of values.

    Raises
    ------
    NpfmError
        If a key is unknown, missing or called something else now, or a value is not allowed.
    """
    for key in _moved(config):
        raise NpfmError(f"config: {key}: {MOVED[key]}")
    for place in _not_finite(config):
        raise NpfmError(f"config: {place}; see docs/configuration.md")
    schema = yaml.safe_load(SCHEMA.read_text())
    errors = jsonschema.Draft202012Validator(schema).iter_errors(config)
    error = jsonschema.exceptions.best_match(errors)
    if error is None:
        return
    where = "/".join(map(str, error.absolute_path)) or "top level"
    if error.validator == "additionalProperties":
        known = error.schema.get("properties", {})
        key = next(key for key in error.instance if key not in known)
        raise NpfmError(f"config: {where}: unknown key '{key}'; {suggest(key, known)}")
    raise NpfmError(f"config: {where}: {error.message}; see docs/configuration.md")
