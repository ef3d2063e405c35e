"""What the target `bounces` renders: the still life, by each way of choosing directions."""

from dataclasses import dataclass

from npfm.rendering.sampling import registry as sampling
from npfm.run.config import Run
from npfm.run.study import Study
from npfm.run.words import option

#: What stands for the reference among the samplers.
REFERENCE = "reference"
#: Strategy of each sampler, and what it follows: an entry of the key `variants`, or the table.
SAMPLERS: dict[str, tuple[str, dict[str, str] | None]] = {
    "cosine": ("cosine", None),
    "lafortune-squares": ("lafortune", {"model": "lafortune", "criterion": "least-squares"}),
    "lafortune": ("lafortune", {"model": "lafortune"}),
    "blinn-phong": ("blinn-phong", {"model": "ashikhmin-shirley"}),
    "per-view": ("per-view", None),
    "factored-paper": ("factored", {"model": "factored", "recipe": "paper"}),
    "factored": ("factored", {"model": "factored"}),
}
#: Parts of the still life, each of a material of its own.
PARTS = 5


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes beside a run."""

    name = "bounces"

    @property
    def materials(self) -> list[str]:
        """Of the parts: those of the configuration that the run has, then others of the run.

        A run of fewer has some more than once.
        """
        wanted = self.run.config["bounces"]["materials"]
        named = [name for name in wanted if name in self.run.materials]
        rest = [name for name in self.run.materials if name not in named]
        return ([*named, *rest] * PARTS)[:PARTS]

    @property
    def names(self) -> list[str]:
        """The reference and the samplers."""
        return [REFERENCE, *SAMPLERS]

    def tables(self) -> list[str]:
        """Tables of the parts."""
        return [self.run.table(name) for name in self.materials]

    def fits(self, sampler: str) -> list[str]:
        """Fits that a sampler follows, of the parts: none for one that follows tables."""
        if sampler == REFERENCE or SAMPLERS[sampler][1] is None:
            return []
        return [self.fit(sampler, name) for name in self.materials]

    def options(self, sampler: str) -> list[str]:
        """Arguments of ``npfm bounces render`` for a sampler."""
        asked = self.run.config["bounces"]
        size = ["--resolution", f"{asked['resolution']}"]
        if sampler == REFERENCE:
            return ["--reference", *size, "--paths", f"{asked['reference_paths']}", "--seed", "9"]
        counts = ["--paths", f"{asked['paths']}", "--seconds", f"{asked['seconds']}"]
        return ["--sampling", SAMPLERS[sampler][0], *size, *counts]

    def modules(self, sampler: str) -> list[str]:
        """Modules of the strategy of a sampler."""
        strategy = "per-view" if sampler == REFERENCE else SAMPLERS[sampler][0]
        return list(sampling.modules([strategy]))

    def words(self, sampler: str) -> list[str]:
        """Arguments of ``npfm bounces render`` that name files."""
        return [*option("--tables", self.tables()), *option("--fits", self.fits(sampler))]


def plan(run: Run) -> Plan:
    """Work out what to make."""
    entries = [{"name": name} | entry for name, (_, entry) in SAMPLERS.items() if entry]
    return Plan(run, run.with_variants(entries))
