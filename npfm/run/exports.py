"""What the target `exports` writes: fits in formats of other programs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from npfm.exports import registry
from npfm.run.config import Run
from npfm.run.entries import listed
from npfm.run.formats import MEASURED, Wanted, wanted
from npfm.run.provenance import command_code
from npfm.run.study import Study
from npfm.run.words import as_input


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes beside a run.

    Parameters
    ----------
    wanted : mapping of str to Wanted
        By format.
    """

    name = "exports"

    wanted: Mapping[str, Wanted]

    def formats(self, folders: bool) -> list[str]:
        """Formats that are written as folders, or those that are written as files."""
        return [name for name in self.wanted if (not self.suffix(name)) == folders]

    def suffix(self, name: str) -> str:
        """How names of what is written in a format end."""
        return registry.declared(name).suffix

    def suffixes(self) -> list[str]:
        """All of them, of files."""
        return list(dict.fromkeys(map(self.suffix, self.formats(False))))

    def written(self) -> Iterator[str]:
        """All that is written."""
        for name, asked in self.wanted.items():
            for variant in asked.variants:
                for material in self.run.materials:
                    if variant == MEASURED or (variant, material) not in self.study.missing:
                        yield f"{self.folder}/{name}/{variant}/{material}{self.suffix(name)}"

    def source(self, variant: str, material: str) -> str:
        """What it is made from."""
        if variant == MEASURED:
            return self.run.table(material)
        return self.fit(variant, material)

    def parts(self, name: str) -> list[str]:
        """Files beside the code that it is written from."""
        return [as_input(str(path)) for path in registry.declared(name).files]

    def options(self, name: str) -> list[str]:
        """Arguments of ``npfm export`` for a format."""
        settings = self.wanted[name].settings.items()
        return ["--to", name, *(word for key, n in settings for word in (f"--{key}", f"{n}"))]

    def code(self, name: str, variant: str) -> str:
        """Digest of the code that writes a format from a variant."""
        fitted = [] if variant == MEASURED else self.study.model_modules(variant)
        return command_code("export", registry.declared(name).module, *fitted)


def plan(run: Run) -> Plan:
    """Work out what to write; models that the run has no variant of are fitted for it."""
    asked = wanted(run.config, run.variants)
    names = {v for one in asked.values() for v in one.variants if v != MEASURED}
    own = [{"name": name, "model": name} for name in sorted(names - set(run.variants))]
    return Plan(run, run.with_variants([*listed(run.config), *own]), asked)
