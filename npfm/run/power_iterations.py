"""What the target `power_iterations` makes beside a run: fits, edits and pictures, and where."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from npfm.papers import dupuy2015
from npfm.papers.captions import chosen
from npfm.run.config import Run
from npfm.run.entries import listed
from npfm.run.study import Study

#: The model whose microfacets are edited and told, and its conversions.
MODEL = "power-iteration"
CONVERSIONS = ("ggx", "beckmann")
#: What they are compared with, of each row the first that the run has; as in the paper's figures.
OPPONENTS = (
    ("shifted-gamma-published", "shifted-gamma"),
    ("abc-published", "abc-e2", "abc-ours"),
    ("ggx-fitted",),
)
#: What slopes are stretched by, as it stands in the names of files.
FACTORS = ("0.25", "0.5", "1", "2", "4")
#: Materials that are shown side by side, and at those roughnesses: from mirror to matte.
SHOWN = (*dupuy2015.SHIFTED_GAMMA_FAILS, dupuy2015.WORSE, "chrome", "white-fabric2")
EDITED = ("chrome", "alum-bronze", "nylon")
#: The same of anisotropic ones, from the longest highlight on.
SHOWN_ANISOTROPIC = (
    "brushed-steel",
    "milled-copper",
    "lacquered-copper",
    "shot-silk",
    "finished-wood",
    "satin",
)
EDITED_ANISOTROPIC = ("brushed-steel", "rolled-gold", "satin")


@dataclass(frozen=True)
class Plan(Study):
    """What the target makes."""

    name = "power_iterations"

    @property
    def scene(self) -> str:
        """Name of the scene that pictures are compared in: the run's first."""
        return self.run.scenes[0]

    @property
    def shown(self) -> list[str]:
        """Materials that are shown side by side."""
        wanted = SHOWN_ANISOTROPIC if self.run.grid.anisotropic else SHOWN
        return chosen(wanted, self.run.materials)

    @property
    def edited(self) -> list[str]:
        """Materials that are shown at several roughnesses."""
        wanted = EDITED_ANISOTROPIC if self.run.grid.anisotropic else EDITED
        return chosen(wanted, self.run.materials)

    @property
    def objects_options(self) -> list[str]:
        """Arguments of ``npfm vary`` that name the objects of the scene."""
        objects = self.run.config["scenes"][self.scene]["objects"]
        return ["--objects", *objects, *self.run.mesh_option(self.scene)]

    @property
    def known_options(self) -> list[str]:
        """Arguments of the verbs that make surfaces of their own: the kind of the run's."""
        return ["--anisotropic"] if self.run.grid.anisotropic else []

    @property
    def told(self) -> list[str]:
        """Fits that roughness is read off."""
        return self.fits("ggx" if self.run.grid.anisotropic else MODEL)

    def home(self, variant: str) -> str:
        """Folder with the fits and pictures of a variant: the run's, if that has it."""
        ours, theirs = self.study.variants[variant], self.run.variants.get(variant)
        return self.run.folder if ours == theirs else self.folder

    def fits(self, variant: str) -> list[str]:
        """All fits of a variant."""
        return [f"{self.home(variant)}/fits/{variant}/{name}.npz" for name in self.run.materials]

    def pictures(self, variant: str) -> str:
        """Folder with a folder of pictures for each material."""
        return f"{self.home(variant)}/renders/{self.scene}"

    @property
    def measured(self) -> str:
        """Folder with the pictures of the measurements."""
        return f"{self.run.folder}/renders/{self.scene}"

    @property
    def compared(self) -> list[str]:
        """Pictures of fits that are compared; published parameters may lack a material."""
        return [
            f"{self.pictures(variant)}/{name}/{variant}.png"
            for name in self.run.materials
            for variant in self.study.variants_of(name)
        ]

    @property
    def fit_options(self) -> list[str]:
        """Arguments of the verbs that compare pictures: where each variant has its own."""
        return [f"{variant}={self.pictures(variant)}" for variant in self.study.variants]


def plan(run: Run) -> Plan:
    """Work out what to make."""
    entries: dict[str, str | Mapping[str, Any]] = {name: name for name in (MODEL, *CONVERSIONS)}
    entries |= {entry["name"]: entry for entry in listed(run.config)}
    opponents = [next((n for n in names if n in run.variants), None) for names in OPPONENTS]
    others = run.variants if run.grid.anisotropic else filter(None, opponents)
    names = list(dict.fromkeys([MODEL, *others, *CONVERSIONS]))
    return Plan(run, run.with_variants(entries[name] for name in names))
