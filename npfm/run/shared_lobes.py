"""What the target `shared_lobes` makes beside a run: fits by number of lobes, and where."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from npfm.papers import peng2017
from npfm.papers.captions import chosen
from npfm.rendering.sampling import registry
from npfm.run.config import Run
from npfm.run.entries import listed
from npfm.run.provenance import command_code
from npfm.run.study import Study

#: Stages and words of settings that `npfm.evaluation.shared_lobes` knows, and the strategies of its
#: ways of sampling; it is not imported, so that a dry run is quick.
COMPARED, BY_LOBES, SHARED, OWN = "compared", "lobes", "shared", "own"
STRATEGIES = ("cosine", "normal-distribution", "light", "half-vector")
MODEL = "shared-lobes"
#: What it is compared with, as in the paper's Figure 3.
OPPONENTS = ("independent-g", "bivariate")
LOBES = (1, 2, 3, 5)
#: Materials whose lobes are counted, and whose D is sampled: from a mirror to what is nearly matte.
COUNTED = ("alum-bronze", "nylon")
SAMPLED = ("black-obsidian", "alum-bronze", "nylon")


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes."""

    name = "shared_lobes"

    @property
    def scenes(self) -> list[str]:
        """The paper's two scenes, of those that the run has; if it has neither, its first two."""
        theirs = [name for name in peng2017.SCENES if name in self.run.scenes]
        return theirs or list(self.run.scenes[:2])

    @property
    def light(self) -> str:
        """Of the sphere that is rendered by D: that of the first scene, as a file of the run."""
        return self.run.light(self.scenes[0])

    @property
    def counted(self) -> list[str]:
        """Materials that are fitted with every number of lobes."""
        return chosen(COUNTED, self.run.materials)

    @property
    def sampled(self) -> list[str]:
        """Materials whose D is sampled."""
        return chosen(SAMPLED, self.run.materials)

    @property
    def shown(self) -> list[str]:
        """Materials whose factors are shown."""
        return chosen(peng2017.FACTORS, self.run.materials)

    def settings(self, material: str) -> dict[str, str]:
        """Folder of each stage and setting of ``npfm accuracy-cost fits`` for a material."""
        folders = self.folders
        settings = {f"{COMPARED}:{name}": folders[name] for name in (MODEL, *OPPONENTS)}
        if material in self.counted:
            settings |= {f"{BY_LOBES}:{name}": folders[f"lobes-{name}"] for name in BY_NUMBER}
        return settings

    def fits(self, material: str) -> list[str]:
        """Fits of a material that are compared, without repetition."""
        folders = dict.fromkeys(self.settings(material).values())
        return [f"{folder}/{material}.npz" for folder in folders]

    @property
    def modules(self) -> list[str]:
        """Modules of the models."""
        return self.study.model_modules(*self.study.variants)

    @property
    def sampling_code(self) -> str:
        """Digest of the code that renders by D: the model's, and that of the strategies."""
        modules = *self.study.model_modules(MODEL), *registry.modules(STRATEGIES)
        return command_code("shared-lobes", *modules)

    @property
    def effort_options(self) -> list[str]:
        """Arguments of ``npfm shared-lobes sampling``: as well as `accuracy_cost` looks."""
        asked = self.run.config["accuracy_cost"]
        return [
            *("--resolution", f"{asked['resolution']}"),
            *("--samples", *map(str, asked["samples"])),
            *("--reference-samples", f"{asked['reference_samples']}"),
        ]


#: Settings of the model by the names that they have in tables.
BY_NUMBER: Mapping[str, Mapping[str, int]] = {
    f"{n}-{word}": {"lobes": n, "shared": shared}
    for n in LOBES
    for word, shared in ((SHARED, 1), (OWN, 0))
}


def plan(run: Run) -> Plan:
    """Work out what to make."""
    entries: dict[str, Mapping[str, Any]] = {
        name: {"name": name, "model": name} for name in (MODEL, *OPPONENTS)
    }
    entries |= {entry["name"]: entry for entry in listed(run.config) if entry["name"] in entries}
    defaults = {"lobes": 3, "shared": 1}
    for name, settings in BY_NUMBER.items():
        # What is the default goes unsaid, so that the same fit is made once.
        said = {key: value for key, value in settings.items() if value != defaults[key]}
        entries[f"lobes-{name}"] = {**entries[MODEL], "name": f"lobes-{name}", **said}
    return Plan(run, run.with_variants(entries.values()))
