"""The variants of a configuration: which model is fitted with which settings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from npfm.datasets.spelling import check_spelling
from npfm.errors import NpfmError, suggest
from npfm.fitting import registry
from npfm.fitting.registry import Model
from npfm.fitting.solvers.choice import SOLVERS
from npfm.run.names import check_names
from npfm.run.words import path_word

#: What any variant may say, beside the settings that its model declares.
KEYS = ("name", "model", "objective", "solver")


@dataclass(frozen=True)
class Variant:
    """A model with the settings it is fitted with; `options` are those of ``npfm fit``.

    `published` is the file of a model whose parameters are read instead.
    """

    name: str
    model: str
    solver: str
    options: tuple[str, ...]
    published: str | None = None


def listed(config: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the entries of the key `variants` as mappings: one that is a name is of that model."""
    return [
        {"name": entry, "model": entry} if isinstance(entry, str) else dict(entry)
        for entry in config["variants"]
    ]


def read_variants(config: Mapping[str, Any]) -> dict[str, Variant]:
    """Return the variants of a configuration by name, in order.

    Raises
    ------
    NpfmError
        If a name is taken or outside the pattern, or a model, a solver or a setting is unknown.
    """
    _check_models(config["models"])
    named: dict[str, Variant] = {}
    for entry in listed(config):
        try:
            model = registry.declared(entry["model"])
        except NpfmError as error:
            raise NpfmError(f"config: variants: {error}") from error
        check_names([entry["name"]], "variant")
        if entry["name"] in named or entry["name"] == "measured":
            raise NpfmError(
                f"config: variants: the name '{entry['name']}' is taken; give this one another"
            )
        named[entry["name"]] = _variant(entry, model, config)
    return named


def missing_fits(
    named: Mapping[str, Variant], materials: Sequence[str]
) -> frozenset[tuple[str, str]]:
    """Pairs of variant and material that a published file lacks.

    Raises
    ------
    NpfmError
        If a file is absent, cannot be read, or has none of the materials.
    """
    missing = set()
    for variant in named.values():
        source = registry.declared(variant.model).published
        if source and variant.published:
            there = source.read(variant.published)
            check_spelling(variant.published, there, materials)
            absent = {(variant.name, name) for name in materials if name not in there}
            if len(absent) == len(materials):
                raise NpfmError(
                    f"config: variants/{variant.name}: {variant.published} has none of the run's "
                    "materials; leave this variant out"
                )
            missing |= absent
    return frozenset(missing)


def _variant(entry: Mapping[str, Any], model: Model, config: Mapping[str, Any]) -> Variant:
    objective = config["objective"] | entry.get("objective", {})
    solver = config["solver"] | entry.get("solver", {})
    if solver["method"] not in SOLVERS:
        hint = suggest(solver["method"], SOLVERS)
        raise NpfmError(f"config: solver: unknown solver '{solver['method']}'; {hint}")
    published = _published_file(entry["name"], model, config)
    options = [
        *("--model", entry["model"], "--solver", solver["method"]),
        *("--tolerance", f"{solver['tolerance']}"),
        *("--max-iterations", f"{solver['max_iterations']}"),
        *_own_settings(entry, config["models"], model),
        *(["--published", path_word(published)] if published else []),
        *("--max-angle", f"{objective['max_angle']}"),
        *([] if objective["compressive"] else ["--no-compressive"]),
        *(["--cells", objective["cells"]] if "cells" in objective else []),
        *(["--seed", f"{solver.get('seed', 1)}"] if model.random else []),
    ]
    return Variant(entry["name"], entry["model"], solver["method"], tuple(options), published)


def _own_settings(
    entry: Mapping[str, Any], for_all: Mapping[str, Mapping], model: Model
) -> list[str]:
    """Arguments of ``npfm fit`` for what the model alone can be told."""
    where = f"variants/{entry['name']}"
    own = {key: value for key, value in entry.items() if key not in KEYS}
    _check_settings(own, model, where, KEYS)
    given = {**for_all.get(entry["model"], {}), **own}
    return [
        word for key in model.settings if key in given for word in (f"--{key}", f"{given[key]}")
    ]


def _check_models(for_all: Mapping[str, Mapping]) -> None:
    """Check the settings that stand for all variants of a model."""
    for name, given in for_all.items():
        try:
            model = registry.declared(name)
        except NpfmError as error:
            raise NpfmError(f"config: models: {error}") from error
        _check_settings(given, model, f"models/{name}", ())


def _check_settings(
    given: Mapping[str, Any], model: Model, where: str, others: Sequence[str]
) -> None:
    for key, value in given.items():
        if key not in model.settings:
            hint = suggest(key, [*others, *model.settings])
            raise NpfmError(f"config: {where}: unknown key '{key}'; {hint}")
        words = model.settings[key]
        if not isinstance(words, str) and value not in words:
            hint = suggest(str(value), words)
            raise NpfmError(f"config: {where}/{key}: unknown {key} '{value}'; {hint}")
        # True and False are whole numbers to Python, and to nobody else.
        if isinstance(words, str) and (isinstance(value, bool) or not isinstance(value, int)):
            raise NpfmError(f"config: {where}/{key}: give a whole number")


def _published_file(variant: str, model: Model, config: Mapping[str, Any]) -> str | None:
    """Return the path of what the parameters of a variant are read from, if they are."""
    if model.published is None:
        return None
    key = f"published_{model.published.kind}"
    if key not in config:
        raise NpfmError(
            f"config: variants/{variant}: needs the key {key}, the path of {model.published.name} "
            "(docs/data.md); add it, or leave this variant out"
        )
    path = Path(config["data"]) / config[key]
    # Of one kind there is a folder with a file a model, of the other there is one file.
    return str(path / model.published.name if model.published.kind == "fits" else path)
