"""What the target `blends` shows: four materials on one object, by a texture of weights."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from npfm.run.basis import OBJECTIVE, told
from npfm.run.config import Run
from npfm.run.study import Study
from npfm.run.words import as_input, option, path_word

#: Materials that a texture of weights chooses between.
COUNT = 4


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes beside a run."""

    name = "blends"

    @property
    def _asked(self) -> Mapping[str, Any]:
        return self.run.config["blends"]

    @property
    def scene(self) -> str:
        """Name of the scene whose objects wear the texture."""
        return str(self._asked.get("scene", self.run.scenes[0]))

    @property
    def materials(self) -> list[str]:
        """Those of the configuration that the run has, then others of the run.

        A run of fewer has some more than once.
        """
        named = [name for name in self._asked["materials"] if name in self.run.materials]
        rest = [name for name in self.run.materials if name not in named]
        return ([*named, *rest] * COUNT)[:COUNT]

    @property
    def variant(self) -> str:
        """Name of the variant whose factors are blended."""
        return next(iter(self.study.variants))

    @property
    def tables(self) -> list[str]:
        """Tables of the materials."""
        return [self.run.table(name) for name in self.materials]

    @property
    def fits(self) -> list[str]:
        """Fits of the materials: the run's, if that has them."""
        return [f"{self.folders[self.variant]}/{name}.npz" for name in self.materials]

    @property
    def gather_inputs(self) -> list[str]:
        """Fits of all materials, which the basis is of."""
        return [f"{self.folders[self.variant]}/{name}.npz" for name in self.run.materials]

    @property
    def gather_options(self) -> list[str]:
        """Arguments of ``npfm basis gather``: what the fits were made by."""
        return told(self.study.variants[self.variant], OBJECTIVE)

    @property
    def weights(self) -> list[str]:
        """The picture of the weights: one path, or none."""
        path = self._asked.get("weights")
        return [as_input(self.run.user_file(path))] if path else []

    @property
    def word_options(self) -> list[str]:
        """Arguments of ``npfm blends`` that name files of the run or of the user."""
        return [
            *("--measured", *self.tables, "--fits", *self.fits),
            *option("--weights", map(path_word, self.weights)),
            *self.run.mesh_option(self.scene),
        ]

    @property
    def blends_options(self) -> list[str]:
        """Arguments of ``npfm blends`` that name none."""
        return [
            *("--objects", *self.run.config["scenes"][self.scene]["objects"]),
            *("--name", self.scene),
            *("--curves", f"{self._asked['curves']}"),
            *option("--steps", map(str, self._asked["steps"])),
        ]


def plan(run: Run) -> Plan:
    """Work out what to make: with the run's variant of that name, or else the model's defaults."""
    wanted = run.config["blends"]["variant"]
    own = {e if isinstance(e, str) else e["name"]: e for e in run.config["variants"]}
    return Plan(run, run.with_variants([own.get(wanted, wanted)]))
