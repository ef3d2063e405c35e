"""What a run has to say about the paper's claims: its tables, and questions put to them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from npfm.evaluation.head_to_head import renderings
from npfm.fitting.fits import load_record
from npfm.fitting.solvers.problem import NEGLIGIBLE

#: Under what names a run may have a model of the paper; the authors' own fits before ours.
NAMES = {
    "bivariate": ("bivariate",),
    "independent-g": ("independent-g",),
    "naive": ("naive",),
    "g-from-d": ("g-from-d",),
    "Bilgili": ("tucker-20",),
    "Loew": ("abc-published", "abc-e2"),
    "Loew, our metric": ("abc-ours",),
    "Bagher 2012": ("shifted-gamma-published", "shifted-gamma"),
    "Ngan": ("cook-torrance-published", "cook-torrance"),
}
#: And models of the 2015 paper, which compares them with some of those.
NAMES_2015 = {
    "power iterations": ("power-iteration",),
    "GGX": ("ggx",),
    "Beckmann": ("beckmann",),
}
#: And the model of the 2017 paper.
NAMES_2017 = {"shared lobes": ("shared-lobes",)}


class Untestable(Exception):
    """A run lacks what a claim is about; the message says what."""


@dataclass(frozen=True)
class Evidence:
    """Tables of a run.

    Parameters
    ----------
    psnr : DataFrame
        Columns scene, material, variant, psnr_db.
    bytes : Series
        Size of a fit by variant.
    diffuseness : Series, optional
        Equation 19, by material.
    starts : DataFrame, optional
        As `starts` makes it.
    weighting : DataFrame, optional
        As `psnr`, of the fits with and without the compressive weight (Figures 7 and 15).
    worst : sequence of str
        Materials, those that independent-g shows most visibly wrong first.
    fits : DataFrame, optional
        Columns material, variant, seconds and status, a row each channel.
    fidelity : DataFrame, optional
        As `npfm.evaluation.fidelity` makes it.
    variance : DataFrame, optional
        As `npfm.evaluation.importance.gather` makes it.
    """

    psnr: pd.DataFrame
    bytes: pd.Series
    diffuseness: pd.Series | None = None
    starts: pd.DataFrame | None = None
    weighting: pd.DataFrame | None = None
    worst: Sequence[str] = ()
    fits: pd.DataFrame | None = None
    fidelity: pd.DataFrame | None = None
    variance: pd.DataFrame | None = None

    def variant(self, model: str) -> str:
        """Name under which the run has a model of the paper.

        Raises
        ------
        Untestable
            If it has none.
        """
        available = set(self.psnr["variant"])
        names = (NAMES | NAMES_2015 | NAMES_2017)[model]
        for name in names:
            if name in available:
                return name
        raise Untestable(f"the run has no {' or '.join(names)}")

    def models(self) -> list[str]:
        """Models of the paper that the run has, best average of the paper first."""
        available = set(self.psnr["variant"])
        return [model for model, names in NAMES.items() if available & set(names)]

    def renderings(self, models: Sequence[str]) -> pd.DataFrame:
        """PSNR in dB by (material, scene) and model, of the pictures that all of them have.

        Without those that equal the measurement's in some model: they have no mean, and no
        difference from others.
        """
        variants = [self.variant(model) for model in models]
        table = renderings(self.psnr, variants).replace(np.inf, np.nan).dropna()
        table = table.set_axis(list(models), axis=1)
        if table.empty:
            raise Untestable(f"the run has no picture of all of {', '.join(models)}")
        return table

    def materials(self, models: Sequence[str]) -> pd.DataFrame:
        """Mean PSNR over the scenes in dB by material and model."""
        return self.renderings(models).groupby("material").mean()


def starts(run: str, materials: Iterable[str]) -> pd.DataFrame:
    """How far apart the starts of each fit of independent-g end.

    Parameters
    ----------
    run : str
        Folder of the run, with ``fits/independent-g/<material>.json``.
    materials : iterable of str
        What counts.

    Returns
    -------
    DataFrame
        Columns material, channel, spread: how much greater the objective of the worst start is
        than that of the best, as a share of the latter, on the samples that all of them were
        compared on. Where nothing is left of the objective, as in a black channel, the share is
        of the least that counts as an objective at all.
    """
    rows = []
    for material in materials:
        for channel in load_record(f"{run}/fits/independent-g/{material}.npz")["channels"]:
            ends = [trace.end for trace in channel.traces]
            if len(ends) > 1:
                spread = float(np.ptp(ends)) / max(min(ends), NEGLIGIBLE)
                rows.append((material, channel.channel, spread))
    return pd.DataFrame(rows, columns=["material", "channel", "spread"])
