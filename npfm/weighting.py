"""What Figures 7 and 15 need beside a run: fits without the compressive weight, or of fewer angles.

Bagher et al. 2016 restrict theta_i and theta_o, and in their text theta_h and theta_d as well,
which follows: the half vector of two directions is no farther from the normal than the farther one,
and theta_d is half of their angle.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from npfm.config import Run, check
from npfm.figures.choice import CAPTIONS, chosen
from npfm.study import fit_folders

#: The models of Figure 7, by the letters they have there; Figure 15 is of the first.
MODELS = ("independent-g", "g-from-d", "naive")
#: Degrees; the second is that of Figure 15.
FULL_RANGE, RESTRICTED_RANGE = 89.0, 80.0


@dataclass(frozen=True)
class Weighting:
    """Which variants the figures show, and which of them are fitted for them alone.

    Parameters
    ----------
    study : Run
        The run with the variants of the figures.
    folders : dict of str to str
        Folder of the fits of each variant of the study.
    folder : str
        Where fits are that the run itself does not have.
    """

    study: Run
    folders: Mapping[str, str]
    folder: str

    @property
    def materials(self) -> dict[int, list[str]]:
        """Materials of each figure."""
        return {figure: chosen(CAPTIONS[figure], self.study.materials) for figure in (7, 15)}

    @property
    def columns(self) -> dict[int, list[str]]:
        """Variants of each figure, by the names that their pictures have: with and without."""
        names = {variant: Path(folder).name for variant, folder in self.folders.items()}
        return {
            7: [names[v] for v in self.study.variants if not v.startswith("restricted")],
            15: [names[v] for v in self.study.variants if MODELS[0] in v],
        }

    @property
    def added(self) -> list[str]:
        """Variants that are fitted for the figures alone."""
        return [v for v, folder in self.folders.items() if folder.startswith(self.folder)]


def plan(run: Run) -> Weighting:
    """Work out what to make: of the models that the run has."""
    has = {variant.model for variant in run.variants.values()}
    models = [model for model in MODELS if model in has]
    entries = [entry for model in models for entry in _pair("full", model, FULL_RANGE)]
    if MODELS[0] in models:
        entries += _pair("restricted", MODELS[0], RESTRICTED_RANGE)
    named = check({**run.config, "variants": entries}).variants if entries else {}
    study = replace(run, variants=named)
    folder = f"{run.folder}/weighting"
    return Weighting(study, fit_folders(run, study, folder), folder)


def _pair(name: str, model: str, max_angle: float) -> list[dict]:
    """Entries of the key `variants` with and without the compressive weight."""
    return [
        {
            "name": f"{name}-{model}" + ("" if compressive else "-uncompressed"),
            "model": model,
            "objective": {"compressive": compressive, "max_angle": max_angle},
        }
        for compressive in (True, False)
    ]
