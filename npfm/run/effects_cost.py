"""Which scenes are built to see what effects cost, and where they are."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from npfm.rendering.effects import EFFECTS
from npfm.run.config import Run


@dataclass(frozen=True)
class Plan:
    """What the target `effects` builds: the scenes of a run, each with one effect switched.

    That is, on if the scene is configured without it, and off if with it. The scene as it is
    configured is taken from the run.
    """

    run: Run

    @property
    def folder(self) -> str:
        """Where all of it goes but tables and figures."""
        return f"{self.run.folder}/effects"

    @property
    def all_effects(self) -> list[str]:
        """Effects that a scene is built anew for when they are switched, in any scene."""
        return sorted({effect for scene in self.run.scenes for effect in self.effects(scene)})

    def effects(self, scene: str) -> list[str]:
        """Effects that T is built anew for when they are switched: not those pointless in it."""
        return [name for name in self._switchable(scene) if not EFFECTS[name].bounces]

    def bounced(self, scene: str, materials: Sequence[str]) -> tuple[list[str], list[str]]:
        """Pictures of light that bounces, of measurements and of fits: none where it is pointless.

        They are added to the pictures of the scene, which is not built anew for them.
        """
        if not any(EFFECTS[name].bounces for name in self._switchable(scene)):
            return [], []
        measured = f"{self.run.folder}/bounced/{scene}/{{}}/measured.exr"
        fitted = f"{self.folder}/bounced/{scene}/{{}}.exr"
        return [measured.format(m) for m in materials], [fitted.format(m) for m in materials]

    def bounced_options(self, scene: str) -> list[str]:
        """Arguments of ``npfm effects-cost compare`` about light that bounces."""
        return ["--bounces"] if scene in self.run.bouncing else []

    def _switchable(self, scene: str) -> list[str]:
        return [name for name in EFFECTS if not self._run(scene, [name]).warnings]

    def switched(self, scene: str) -> list[str]:
        """Arguments of ``npfm effects-cost compare`` that name these scenes."""
        pairs = zip(self.effects(scene), self.builds(scene), strict=True)
        return ["=".join(pair) for pair in pairs]

    def builds(self, scene: str) -> list[str]:
        """Folders of a scene with each of these effects switched."""
        return [f"{self.folder}/scenes/{scene}/{effect}" for effect in self.effects(scene)]

    def scene_options(self, scene: str, effect: str) -> list[str]:
        """Arguments of ``npfm scene`` for a scene with an effect switched."""
        switched = {effect}.symmetric_difference(self.run.config["scenes"][scene]["effects"])
        return self._run(scene, sorted(switched)).scene_options(scene)

    def _run(self, scene: str, effects: Sequence[str]) -> Run:
        described = self.run.config["scenes"][scene] | {"effects": effects}
        return replace(self.run, config={**self.run.config, "scenes": {scene: described}})
