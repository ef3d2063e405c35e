"""The key `exports` of a configuration: which formats are written, and of which variants."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from npfm.errors import NpfmError, suggest
from npfm.exports import registry
from npfm.fitting import registry as models
from npfm.run.entries import Variant

#: What stands for the table itself among variants.
MEASURED = "measured"


@dataclass(frozen=True)
class Wanted:
    """A format, of what, and how.

    Parameters
    ----------
    variants : tuple of str
        Names of variants, of models that the run has no variant of, or `MEASURED`.
    settings : mapping of str to int
        Of the format.
    """

    variants: tuple[str, ...]
    settings: Mapping[str, int]


def wanted(config: Mapping[str, Any], named: Mapping[str, Variant]) -> dict[str, Wanted]:
    """Return what a configuration asks for, by format.

    Parameters
    ----------
    config : mapping
        Settled and of the schema's form.
    named : mapping of str to Variant
        The variants of the run.

    Raises
    ------
    NpfmError
        If a format, a variant or a setting is unknown, or a format is not made from a variant.
    """
    made = {}
    for name, entry in config["exports"].items():
        entry = entry if isinstance(entry, Mapping) else {"variants": entry}
        settings = {key: value for key, value in entry.items() if key != "variants"}
        try:
            known = registry.declared(name)
        except NpfmError as error:
            raise NpfmError(f"config: exports: {error}") from error
        if known.many:
            raise NpfmError(
                f"config: exports/{name}: it holds all materials at once; figures/figure16.exr of "
                "every run is one, and npfm export writes others"
            )
        if unknown := [key for key in settings if key not in known.settings]:
            hint = suggest(unknown[0], ["variants", *known.settings])
            raise NpfmError(f"config: exports/{name}: unknown key '{unknown[0]}'; {hint}")
        for variant in entry["variants"]:
            _check_variant(name, known, variant, named)
        made[name] = Wanted(tuple(entry["variants"]), settings)
    return made


def _check_variant(
    name: str, known: registry.Format, variant: str, named: Mapping[str, Variant]
) -> None:
    where = f"config: exports/{name}"
    if variant == MEASURED:
        if not known.tables:
            raise NpfmError(f"{where}: it is made from fits, not from tables; name a variant")
        return
    if variant not in named and variant not in models.models():
        hint = suggest(variant, [*named, *models.models()])
        raise NpfmError(f"{where}: unknown variant '{variant}'; {hint}")
    model = named[variant].model if variant in named else variant
    if known.models and model not in known.models:
        raise NpfmError(
            f"{where}: '{variant}' is of the model {model}, and it is made from fits of "
            f"{' or '.join(known.models)}; name a variant of these"
        )
