"""What the target `video` makes: fits that are followed, and scenes whose light is turned."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from npfm.fitting import registry
from npfm.fitting.solvers.choice import module_of as solver_module
from npfm.run.accuracy_cost import MODEL, materials
from npfm.run.config import Run
from npfm.run.entries import Variant, listed
from npfm.run.provenance import command_code
from npfm.run.study import Study

#: An edge of few pixels crawls when what is behind it moves.
SMOOTH = "antialiasing"
#: What keeps the states of a fit, which no other fit depends on.
FOLLOWING = "npfm.fitting.iterations"


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes.

    Parameters
    ----------
    materials : tuple of str
        Those of the target `accuracy_cost`.
    shown : tuple of str
        Variants that are put beside the measurement.
    followed : Variant
        Whose starts are followed.
    """

    name = "video"

    materials: tuple[str, ...]
    shown: tuple[str, ...]
    followed: Variant

    @property
    def asked(self) -> Mapping[str, Any]:
        """The key of the configuration."""
        return self.run.config["video"]

    @property
    def scene(self) -> str:
        """Name of the scene whose light is turned."""
        return self.asked.get("scene", self.run.scenes[0])

    @property
    def turns(self) -> list[str]:
        """Degrees by which the light is turned, as the folders of the scenes are called."""
        return [f"{360 * k / self.asked['turns']:g}" for k in range(self.asked["turns"])]

    def fit(self, variant: str, material: str) -> str:
        """A fit of the study: the one that is followed, or the run's, if that has it."""
        if self.study.variants[variant].options == self.followed.options:
            return f"{self.folder}/starts/{material}.npz"
        return super().fit(variant, material)

    def fits(self, material: str) -> dict[str, str]:
        """Fits that are shown of a material, by variant: not those that nobody published."""
        there = self.study.variants_of(material)
        return {name: self.fit(name, material) for name in self.shown if name in there}

    @property
    def modules(self) -> list[str]:
        """Modules of the models that are shown."""
        return self.study.model_modules(*self.shown)

    @property
    def following_code(self) -> str:
        """Digest of the code that follows the starts of a fit."""
        modules = registry.declared(MODEL).module, solver_module(self.followed.solver)
        return command_code("fit", *modules, FOLLOWING)

    def scene_options(self, turn: str) -> list[str]:
        """Arguments of ``npfm scene`` for the scene with its light turned."""
        return [*self._small.scene_options(self.scene), "--turn", turn]

    @property
    def scene_code(self) -> str:
        """Digest of the code that builds it."""
        return self._small.scene_code(self.scene)

    @property
    def _small(self) -> Run:
        """The run with the scene as small as it is asked for, its edges smooth."""
        config = self.run.config
        described = config["scenes"][self.scene]
        effects = list(dict.fromkeys([*described["effects"], SMOOTH]))
        scenes = {self.scene: described | {"samples": self.asked["samples"], "effects": effects}}
        changes = {"resolution": self.asked["resolution"], "scenes": scenes}
        return replace(self.run, config={**config, **changes})


def shown_in_motion(run: Run) -> list[str]:
    """Materials whose pages of the target are there; the gallery makes none, and links to these."""
    pages = {name: Path(f"{run.folder}/gallery/video/{name}.html") for name in materials(run)}
    return [name for name, page in pages.items() if page.exists()]


def plan(run: Run) -> Plan:
    """Work out what to make."""
    own = {entry["name"]: entry for entry in listed(run.config)}
    shown = tuple(run.config["video"]["variants"])
    study = run.with_variants(own.get(name, name) for name in shown)
    theirs = own.get(MODEL, {})
    alone = run.with_variants([theirs if theirs.get("model") == MODEL else MODEL])
    return Plan(run, study, materials(run), shown, alone.variants[MODEL])
