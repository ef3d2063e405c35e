"""What the target `psnr_level` compares beside a run: scenes built in other ways, and where."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from npfm.datasets.names import matching
from npfm.run import effects_cost
from npfm.run.config import Run
from npfm.run.words import option

#: Ways of building a scene that `npfm.evaluation.psnr_level` knows; it is not imported, so that a
#: dry run is quick. Others are named after their pixels or their turn.
CONFIGURED, ANTIALIASED = "configured", "antialiased"
EFFECT = "antialiasing"
#: How many materials count if the run has none of those that the configuration names.
MOST_MATERIALS = 6


@dataclass(frozen=True)
class Plan:
    """What the target makes.

    Parameters
    ----------
    run : Run
    materials, variants : tuple of str
        What is compared, of the run's.
    """

    run: Run
    materials: tuple[str, ...]
    variants: tuple[str, ...]

    @property
    def folder(self) -> str:
        """Where all of it goes but table and figure."""
        return f"{self.run.folder}/psnr_level"

    @property
    def _asked(self) -> Mapping[str, Any]:
        return self.run.config["psnr_level"]

    @property
    def built(self) -> dict[str, list[str]]:
        """Arguments of ``npfm scene`` beyond a scene's own, by ways that are built for this alone.

        Of an argument that is given twice, the last counts.
        """
        others = [n for n in self._asked["resolutions"] if n != self.run.config["resolution"]]
        finer = {f"pixels-{n}": ["--resolution", f"{n}"] for n in others}
        turned = {f"turned-{angle}": ["--turn", f"{angle}"] for angle in self._asked["turns"]}
        return finer | turned

    def folders(self, scene: str) -> dict[str, str]:
        """Folder of a scene by each way; what the run or the target `effects` builds is theirs."""
        own = f"{self.run.folder}/scenes/{scene}"
        effects = effects_cost.Plan(self.run)
        listed = EFFECT in self.run.config["scenes"][scene]["effects"]
        switched = f"{effects.folder}/scenes/{scene}/{EFFECT}"
        return {
            CONFIGURED: own,
            ANTIALIASED: own if listed else switched,
            **{way: f"{self.folder}/scenes/{scene}/{way}" for way in self.built},
        }

    @property
    def scenes(self) -> list[str]:
        """All of these folders, way by way."""
        return list(dict.fromkeys(self._named.values()))

    @property
    def _named(self) -> dict[str, str]:
        ways = (CONFIGURED, ANTIALIASED, *self.built)
        return {f"{way}/{s}": self.folders(s)[way] for way in ways for s in self.run.scenes}

    def scene_options(self, scene: str, way: str) -> list[str]:
        """Arguments of ``npfm scene`` for a scene that is built for this alone."""
        return [*self.run.scene_options(scene), *self.built[way]]

    def angles(self, scene: str) -> str:
        """The picture of the angles that a scene is seen under."""
        return f"{self.folder}/angles/{scene}.exr"

    def angles_options(self, scene: str) -> list[str]:
        """Arguments of ``npfm psnr-level angles`` for a scene."""
        described = self.run.config["scenes"][scene]
        return [
            *("--objects", *described["objects"]),
            *(["--effects", EFFECT] if EFFECT in described["effects"] else []),
            *self.run.mesh_option(scene),
            *("--resolution", f"{self.run.config['resolution']}"),
        ]

    def fits(self, material: str) -> dict[str, str]:
        """Fits that are compared, by variant."""
        there = self.run.variants_of(material)
        folder = f"{self.run.folder}/fits"
        return {name: f"{folder}/{name}/{material}.npz" for name in self.variants if name in there}

    def measure_options(self, material: str) -> list[str]:
        """Arguments of ``npfm psnr-level measure`` that say which file is what."""
        angles = {scene: self.angles(scene) for scene in self.run.scenes}
        return [
            *option("--fits", map("=".join, self.fits(material).items())),
            *option("--scenes", map("=".join, self._named.items())),
            *option("--angles", map("=".join, angles.items())),
        ]


def plan(run: Run) -> Plan:
    """Work out what to compare.

    Materials and variants that the run does not have are left out; if it has none of those that
    are named, its first six materials count, and all of its variants.
    """
    asked = run.config["psnr_level"]
    variants = [name for name in asked["variants"] if name in run.variants] or list(run.variants)
    materials = [
        name
        for name in matching(asked["materials"], run.materials) or run.materials[:MOST_MATERIALS]
        if not set(variants).isdisjoint(run.variants_of(name))
    ]
    return Plan(run, tuple(materials), tuple(variants))
