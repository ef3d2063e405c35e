"""What the target `importance` measures beside a run: ways of sampling, materials and lights."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from npfm.papers import lawrence2004
from npfm.rendering.sampling import registry
from npfm.run import datasets
from npfm.run.config import Run
from npfm.run.study import Study
from npfm.run.words import option

#: The light of the paper's Table 2, where a run has it.
CONSTANT = "constant"
#: What strategies follow that need a fit, by strategy and recipe: an entry of the key `variants`.
FOLLOWED: Mapping[str, Mapping[str, Any]] = {
    "factored/paper": {
        "name": "factored-paper",
        "model": "factored",
        "recipe": "paper",
        # The most terms that the paper has for a measured material (Table 1).
        "outer": 4,
        "inner": 1,
    },
    "factored/improved": {"name": "factored-improved", "model": "factored"},
    "lafortune/least-squares": {
        "name": "lafortune-least-squares",
        "model": "lafortune",
        "criterion": "least-squares",
    },
    "lafortune/kullback-leibler": {"name": "lafortune", "model": "lafortune"},
    "blinn-phong/least-squares": {
        "name": "ashikhmin-shirley-least-squares",
        "model": "ashikhmin-shirley",
        "criterion": "least-squares",
    },
    "blinn-phong/kullback-leibler": {"name": "ashikhmin-shirley", "model": "ashikhmin-shirley"},
    "quantiles/power-iteration": {"name": "power-iteration", "model": "power-iteration"},
    "visible-slopes/power-iteration": {"name": "power-iteration", "model": "power-iteration"},
    "normal-distribution/shared-lobes": {"name": "shared-lobes", "model": "shared-lobes"},
}
#: Estimators by several strategies: the renderer's, and the first paper's (Bagher et al. 2016,
#: appendix "Rendering Details").
COMBINED = ("light+half-vector", "per-view+light+uniform^2", "light+factored/improved")
#: Ways whose variance is shown over the picture.
PICTURED = (
    "cosine",
    "lafortune/kullback-leibler",
    "blinn-phong/kullback-leibler",
    "half-vector",
    "per-view",
    "factored/paper",
    "factored/improved",
    *COMBINED,
)
#: How many materials count if the dataset has none of those that the configuration names, and how
#: many are shown by themselves.
MOST_MATERIALS, MOST_SHOWN = 6, 2


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes."""

    name = "importance"

    @property
    def materials(self) -> tuple[str, ...]:
        """Names of the materials, sorted; the run need not have them."""
        return self.study.materials

    @property
    def formulas(self) -> tuple[str, ...]:
        """Formulas that are measured as materials are, but those that materials are called by."""
        asked = self.run.config["importance"]["formulas"]
        return tuple(name for name in asked if name not in self.materials)

    def table(self, material: str) -> str:
        """The table of a material, or of a formula."""
        if material in self.formulas:
            return f"{self.folder}/formulas/{material}.binary"
        return self.run.table(material)

    @property
    def lights(self) -> list[str]:
        """Names of the lights."""
        asked = self.run.config["importance"].get("lights")
        if asked is not None:
            return list(asked)
        own = self.run.config["scenes"][self.run.scenes[0]]["light"]
        return [
            name for name in dict.fromkeys([CONSTANT, own]) if name in self.run.config["lights"]
        ]

    @property
    def ways(self) -> list[str]:
        """Arguments of ``npfm importance measure`` that name the ways."""
        return [*_strategies(), *COMBINED]

    @property
    def modules(self) -> tuple[str, ...]:
        """Modules of the strategies."""
        return registry.modules(registry.strategies())

    def fit(self, variant: str, material: str) -> str:
        """A fit of the study: the run's, if that has it."""
        if material in self.run.materials:
            return super().fit(variant, material)
        return f"{self.folder}/fits/{variant}/{material}.npz"

    def fits(self, material: str) -> list[str]:
        """Fits that strategies follow."""
        return [self.fit(variant, material) for variant in self.study.variants]

    def parameters(self, material: str) -> list[str]:
        """Arguments of ``npfm importance measure`` that say which strategy follows which fit."""
        return [f"{name}={self.fit(entry['name'], material)}" for name, entry in FOLLOWED.items()]

    @property
    def effort_options(self) -> list[str]:
        """Arguments of ``npfm importance measure`` that say how well it looks."""
        asked = self.run.config["importance"]
        return [
            *option("--ways", self.ways),
            *("--resolution", f"{asked['resolution']}"),
            *("--points", f"{asked['points']}"),
            *("--repetitions", f"{asked['repetitions']}"),
            *option("--samples", map(str, asked["samples"])),
        ]

    @property
    def shown(self) -> list[str]:
        """Materials that are shown by themselves: the paper's where there are any."""
        theirs = [name for name in lawrence2004.MATERIALS if name in self.materials]
        return (theirs or list(self.materials))[:MOST_SHOWN]

    @property
    def images(self) -> list[str]:
        """Pictures of the variance of these materials, in the last of the lights."""
        return [f"{self.folder}/{self.lights[-1]}/{name}.exr" for name in self.shown]

    @property
    def images_options(self) -> list[str]:
        """Arguments of ``npfm figure variance_images``."""
        return [*option("--images", self.images), *option("--ways", PICTURED)]


def _strategies() -> Iterator[str]:
    """All strategies that can be made, each by itself, with their recipes."""
    for name, declared in registry.strategies().items():
        if "parameters" not in declared.needs:
            yield name
        yield from (followed for followed in FOLLOWED if followed.partition("/")[0] == name)


def plan(run: Run) -> Plan:
    """Work out what to measure."""
    known = set(datasets.available(run.config))
    wanted = [name for name in run.config["importance"]["materials"] if name in known]
    dataset = run.config["dataset"] | {"materials": wanted or list(run.materials[:MOST_MATERIALS])}
    config = {**run.config, "dataset": dataset}
    materials = datasets.chosen(config)
    grid = datasets.grid(config, materials)
    measured = replace(run, config=config, materials=materials, grid=grid)
    entries = {entry["name"]: entry for entry in FOLLOWED.values()}
    return Plan(run, measured.with_variants(entries.values()))
