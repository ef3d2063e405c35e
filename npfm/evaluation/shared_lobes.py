"""What shared lobes gain, which of their ideas brings it, and what their D is worth as a density.

Figures 2 and 3 of Peng et al. 2017, and a table that it does not have: lobes by number, which the
channels share or have each for itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.metrics import mean_db
from npfm.fitting.fits import Fit
from npfm.reflectance.table import Table
from npfm.rendering import assembly
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import STRATEGIES, Scene
from npfm.rendering.transport import render

#: Stages of ``npfm accuracy-cost fits``: models compared, and lobes by number and sharing.
COMPARED, BY_LOBES = "compared", "lobes"
SHARED, OWN = "shared", "own"
PSNR = "material", "variant", "psnr_db"
LOBES = "material", "lobes", "shared", "bytes", "seconds", "psnr_db"
SAMPLING = "material", "way", "samples", "rms", "psnr_db", "repetitions"
#: Ways of choosing light directions: as renderers do by default, as the paper does, and the remedy
#: for what D leaves to chance.
WAYS = {
    "cosine": ("cosine",),
    "D": ("normal-distribution",),
    "D and cosine": ("normal-distribution", "cosine"),
}
SPHERE = Scene(("sphere",))


def psnr(fits: pd.DataFrame) -> pd.DataFrame:
    """PSNR of every material by each model, mean over the scenes.

    Parameters
    ----------
    fits : DataFrame
        As `npfm.evaluation.accuracy_cost.fits` makes it, of all materials; the stage `COMPARED`
        counts.

    Returns
    -------
    DataFrame
        Columns `PSNR`.

    Raises
    ------
    NpfmError
        If there is no such stage.
    """
    own = _stage(fits, COMPARED)
    groups = own.groupby(["material", "setting"], sort=False)["psnr_db"].agg(mean_db)
    return groups.reset_index().rename(columns={"setting": "variant"})[list(PSNR)]


def lobes(fits: pd.DataFrame) -> pd.DataFrame:
    """Bytes, seconds and PSNR, mean over the scenes, of lobes by number and sharing.

    Parameters
    ----------
    fits : DataFrame
        As of `psnr`; the stage `BY_LOBES` counts, whose settings are such as ``3-shared``.

    Returns
    -------
    DataFrame
        Columns `LOBES`; shared is 1 or 0.

    Raises
    ------
    NpfmError
        If there is no such stage.
    """
    own = _stage(fits, BY_LOBES)
    groups = own.groupby(["material", "setting"], sort=False)
    found = groups.agg({"bytes": "max", "seconds": "mean", "psnr_db": mean_db}).reset_index()
    parts = found["setting"].str.split("-", expand=True)
    found["lobes"], found["shared"] = parts[0].astype(int), (parts[1] == SHARED).astype(int)
    return found[list(LOBES)]


def _stage(fits: pd.DataFrame, stage: str) -> pd.DataFrame:
    own = fits[fits["stage"] == stage]
    if own.empty:
        raise NpfmError(f"no fits of the stage '{stage}'; name them to npfm accuracy-cost fits")
    return own


def wins(psnr: pd.DataFrame, ours: str, other: str) -> tuple[int, int]:
    """For how many materials one variant is above another, and how many have both."""
    table = psnr.pivot(index="material", columns="variant", values="psnr_db")
    both = table[[ours, other]].dropna()
    return int((both[ours] > both[other]).sum()), len(both)


@dataclass(frozen=True)
class Effort:
    """How well ways of sampling are looked at.

    Parameters
    ----------
    resolution : int
        Pixels along one side.
    samples : sequence of int
        Light directions a pixel.
    reference_samples : int
        Of the picture that others are compared with.
    repetitions : int
        With other random numbers each.
    """

    resolution: int
    samples: Sequence[int]
    reference_samples: int
    repetitions: int


def sampling(fit: Fit, table: Table, environment: Environment, effort: Effort) -> pd.DataFrame:
    """Error of pictures of a sphere by the way and the number of light directions (Figure 2).

    What is rendered is the fit, as in the paper: noise is all that differs.

    Parameters
    ----------
    fit, table : Fit, Table
        Whose D is followed, and its table.
    environment : Environment
    effort : Effort

    Returns
    -------
    DataFrame
        Columns `SAMPLING` but material: the root mean square error over pixels and repetitions as
        a share of the largest value of the reference, and as a PSNR in dB.
    """
    given = Given(environment, table.grid, table, fit.parameters)
    best, inside = _picture(given, table, effort, effort.reference_samples, 0, STRATEGIES)
    peak = best[inside].max()
    rows = []
    for way, names in WAYS.items():
        for samples in effort.samples:
            squares = []
            for seed in range(1, effort.repetitions + 1):
                picture, _ = _picture(given, table, effort, samples, seed, names)
                squares.append(np.mean((picture[inside] - best[inside]) ** 2))
            rms = float(np.sqrt(np.mean(squares)) / peak)
            rows.append((way, samples, rms, -20 * np.log10(rms), effort.repetitions))
    return pd.DataFrame(rows, columns=SAMPLING[1:])


def _picture(
    given: Given, table: Table, effort: Effort, samples: int, seed: int, names: Sequence[str]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Linear radiance of the sphere, and where it is."""
    transport = assembly.build(
        SPHERE,
        given.environment,
        given.grid,
        effort.resolution,
        samples,
        seed,
        registry.make(names, given),
    )
    return render(transport, table)[..., :3].astype(float), transport.foreground


def read_sampling(paths: Sequence[str]) -> pd.DataFrame:
    """Read the tables of `sampling` of several materials; errors are those of `tables.read`."""
    text, numbers = list(SAMPLING[:2]), list(SAMPLING[2:])
    return pd.concat([tables.read(path, text, numbers) for path in paths], ignore_index=True)
