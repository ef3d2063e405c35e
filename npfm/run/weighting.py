"""What Figures 7 and 15 need beside a run: fits without the compressive weight, or of fewer angles.

Bagher et al. 2016 restrict theta_i and theta_o, and in their text theta_h and theta_d as well,
which follows: the half vector of two directions is no farther from the normal than the farther one,
and theta_d is half of their angle.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from npfm.papers.captions import CAPTIONS, chosen
from npfm.run.config import Run
from npfm.run.study import fit_folders

#: The models of Figure 7, by the letters they have there; Figure 15 is of the first.
MODELS = ("independent-g", "g-from-d", "naive")
#: Degrees; the second is that of Figure 15.
FULL_RANGE, RESTRICTED_RANGE = 89.0, 80.0

#: Variants with and without the compressive weight, by what they have in common.
Pairs = dict[str, tuple[str, str]]


@dataclass(frozen=True)
class Weighting:
    """Which variants the figures show, and which of them are fitted for them alone.

    Parameters
    ----------
    study : Run
        The run with the variants of the figures.
    folder : str
        Where fits go that the run itself does not have.
    folders : mapping of str to str
        Folder of the fits of each variant of the study.
    columns : mapping of int to Pairs
        Variants of the study that each figure shows.
    """

    study: Run
    folder: str
    folders: Mapping[str, str]
    columns: Mapping[int, Pairs]

    @property
    def materials(self) -> dict[int, list[str]]:
        """Materials of each figure."""
        return {figure: chosen(CAPTIONS[figure], self.study.materials) for figure in self.columns}

    @property
    def all_materials(self) -> list[str]:
        """Materials of any of the figures."""
        return sorted({name for names in self.materials.values() for name in names})

    @property
    def all_pictures(self) -> list[str]:
        """Variants of any of the figures by the names of their pictures."""
        shown = [pair for pairs in self.pictures.values() for pair in pairs.values()]
        return list(dict.fromkeys(name for pair in shown for name in pair))

    @property
    def pictures(self) -> dict[int, Pairs]:
        """Variants of each figure by the names of their pictures, which may be the run's own."""
        return {
            figure: {
                what: (self._picture(weighted), self._picture(plain))
                for what, (weighted, plain) in pairs.items()
            }
            for figure, pairs in self.columns.items()
        }

    def _picture(self, variant: str) -> str:
        return Path(self.folders[variant]).name

    @property
    def added(self) -> list[str]:
        """Variants that are fitted for the figures alone."""
        return [v for v, folder in self.folders.items() if folder.startswith(f"{self.folder}/")]


def plan(run: Run) -> Weighting:
    """Work out what to make: of the models that the run has."""
    has = {variant.model for variant in run.variants.values()}
    models = [model for model in MODELS if model in has]
    columns = {7: {model: (model, FULL_RANGE) for model in models}} if models else {}
    if MODELS[0] in models:
        ranges = FULL_RANGE, RESTRICTED_RANGE
        columns[15] = {f"up to {angle:g} degrees": (MODELS[0], angle) for angle in ranges}
    entries = {
        entry["name"]: entry
        for figure in columns.values()
        for setting in figure.values()
        for entry in _pair(*setting)
    }
    study, folder = run.with_variants(entries.values()), f"{run.folder}/weighting"
    pairs = {
        figure: {what: tuple(e["name"] for e in _pair(*setting)) for what, setting in both.items()}
        for figure, both in columns.items()
    }
    return Weighting(study, folder, fit_folders(run, study, folder), pairs)


def _pair(model: str, max_angle: float) -> list[dict]:
    """Entries of the key `variants` with and without the compressive weight."""
    return [
        {
            "name": f"{model}-to-{max_angle:g}-{name}",
            "model": model,
            "objective": {"compressive": compressive, "max_angle": max_angle},
        }
        for name, compressive in (("weighted", True), ("unweighted", False))
    ]
