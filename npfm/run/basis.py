"""What the target `basis` makes beside a run: factors of fits, and fits in bases of them."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from npfm.run.config import Run
from npfm.run.entries import Variant, listed
from npfm.run.provenance import command_code
from npfm.run.study import Study

#: Models whose factors a basis is made of; `npfm.fitting.basis.library` knows them, which is not
#: imported, so that a dry run is quick.
MODELS = ("independent-g", "shared-lobes")
#: How many curves of each of D, F and G.
CURVES = (1, 2, 3, 5, 8, 12, 20)
#: Arguments of ``npfm fit`` that say what is minimised, and when to stop, by how many words follow.
OBJECTIVE = {"--max-angle": 1, "--no-compressive": 0, "--cells": 1}
STOPPING = {"--tolerance": 1, "--max-iterations": 1}


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes."""

    name = "basis"

    def fits(self, variant: str) -> list[str]:
        """Fits of all materials by a variant: the run's, if that has them."""
        return [self.fit(variant, name) for name in self.run.materials]

    def gather_options(self, variant: str) -> list[str]:
        """Arguments of ``npfm basis gather``: what the fits were made by."""
        return told(self.study.variants[variant], OBJECTIVE)

    def measure_options(self, variant: str) -> list[str]:
        """Arguments of ``npfm basis measure`` but for its files."""
        return [
            *("--variant", variant, "--curves", *map(str, CURVES)),
            *told(self.study.variants[variant], OBJECTIVE | STOPPING),
        ]

    def measure_code(self, variant: str) -> str:
        """Digest of the code that fits in a basis, and of the model that makes tables of it."""
        return command_code("basis", *self.study.model_modules(variant))


def told(variant: Variant, wanted: Mapping[str, int]) -> list[str]:
    """Return some of the arguments that a variant is fitted with.

    Parameters
    ----------
    variant : Variant
    wanted : mapping of str to int
        Their names, each with the number of words that follow it.
    """
    options, found = variant.options, list[str]()
    for name, count in wanted.items():
        if name in options:
            at = options.index(name)
            found += options[at : at + 1 + count]
    return found


def plan(run: Run) -> Plan:
    """Work out what to make: the run's first variant of each model, or else one of its defaults."""
    entries: dict[str, Mapping[str, Any]] = {}
    for model in MODELS:
        own = [entry for entry in listed(run.config) if entry["model"] == model]
        first = own[0] if own else {"name": model, "model": model}
        entries.setdefault(first["name"], first)
    return Plan(run, run.with_variants(entries.values()))
