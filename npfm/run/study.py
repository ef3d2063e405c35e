"""Fits beyond the variants of a run, for a question of their own."""

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from npfm.run.config import Run


@dataclass(frozen=True)
class Study:
    """What a target makes beside a run, with fits of its own.

    Parameters
    ----------
    run : Run
    study : Run
        The same run with the variants that are compared or followed.
    """

    #: Name of the folder that all of it goes to but tables and figures.
    name: ClassVar[str]

    run: Run
    study: Run

    @property
    def folder(self) -> str:
        """Where all of it goes but tables and figures."""
        return f"{self.run.folder}/{self.name}"

    @property
    def folders(self) -> dict[str, str]:
        """Folder of the fits of each variant of the study: the run's, where it has them."""
        return fit_folders(self.run, self.study, self.folder)

    def fit(self, variant: str, material: str) -> str:
        """A fit of the study: the run's, if that has it."""
        return f"{self.folders[variant]}/{material}.npz"


def table_inputs(run: Run, name: str) -> list[str]:
    """The table of a study, if it is there: the page of claims has it made for no other."""
    table = f"{run.folder}/tables/{name}.csv"
    return [table] if Path(table).exists() else []


def fit_folders(run: Run, study: Run, folder: str) -> dict[str, str]:
    """Folder of the fits of each variant of a study; equal settings are fitted once.

    Parameters
    ----------
    run : Run
        What the study goes with; fits that it has are taken from there.
    study : Run
        The same run with variants of its own.
    folder : str
        Where the other fits of the study go.
    """
    folders = {v.options: f"{run.folder}/fits/{v.name}" for v in run.variants.values()}
    for variant in study.variants.values():
        folders.setdefault(variant.options, f"{folder}/fits/{variant.name}")
    return {variant.name: folders[variant.options] for variant in study.variants.values()}
