"""Whether a configuration has the keys and the kinds of values that the schema names."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from npfm.errors import NpfmError, suggest

SCHEMA = Path(__file__).parents[2] / "workflow" / "schemas" / "config.schema.yaml"


def check_schema(config: Mapping[str, Any]) -> None:
    """Check keys and kinds of values.

    Raises
    ------
    NpfmError
        If a key is unknown or missing, or a value is not allowed.
    """
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
