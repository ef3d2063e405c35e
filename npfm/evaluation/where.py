"""Where the error of fits sits: by angles of the table, and by the slant of surfaces in pictures.

Of the objective of a fit (Bagher et al. 2016, equation 7) one part no reciprocal model can remove:
that cells which exchanging light and view maps on one another differ. It is the objective of the
best reciprocal table, which stands in the list as the variant `RECIPROCAL`.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.evaluation.comparison import read_reference
from npfm.fitting.objective import Objective, Samples, channel_samples, fold
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, INVALID, Table
from npfm.rendering.scenes import Scene
from npfm.rendering.view_angles import NOTHING, view_angles
from npfm.storage.pictures import read_exr

#: Edges of the bins of each angle, in degrees. `lowest` is the larger of theta_i and theta_o, and
#: `slant` the angle of normal and view at a pixel of a lone sphere.
EDGES: Mapping[str, tuple[float, ...]] = {
    "theta_h": (0, 1, 2, 5, 10, 20, 30, 45, 60, 75, 90),
    "theta_d": (0, 10, 20, 30, 40, 50, 60, 70, 80, 90),
    "lowest": (0, 15, 30, 45, 60, 70, 75, 80, 85, 90),
    "slant": (0, 15, 30, 45, 60, 70, 75, 80, 85, 90),
}
#: The best table that a reciprocal model could have, as a variant beside the fits.
RECIPROCAL = "reciprocal"
COLUMNS = ("material", "variant", "angle", "from_degrees", "to_degrees", "percent")


def reciprocal(samples: Sequence[Samples[HalfDifference]]) -> Table:
    """Table with the least objective of those that exchanging light and view leaves the same.

    Cells that do not count are not measured in it.

    Parameters
    ----------
    samples : sequence of Samples
        Of every channel of a measurement, on one half-difference grid.
    """
    values = []
    for folded in map(fold, samples):
        merged = np.where(folded.weight > 0, folded.value * folded.scale, INVALID)
        values.append(np.concatenate([merged, merged[..., ::-1]], axis=-1))
    return Table(np.stack(values), samples[0].grid)


def of_table(samples: Sequence[Samples[HalfDifference]], fitted: Table) -> dict[str, NDArray]:
    """Objective of a fit by the angles of cells, in percent of what black has.

    Parameters
    ----------
    samples : sequence of Samples
        Of every channel of the measurement, by the objective that counts.
    fitted : Table
        On their half-difference grid.

    Returns
    -------
    dict of str to ndarray
        By theta_h, theta_d and lowest, the parts in the bins of `EDGES`: mean over the channels.
        They sum to the relative objective of the fit's record, unless the variant was fitted by
        another objective than that of the samples.
    """
    angles = _angles(samples[0].grid)
    parts = {name: np.zeros(len(EDGES[name]) - 1) for name in angles}
    for of_channel, values in zip(samples, fitted.values, strict=True):
        difference = values / of_channel.scale - of_channel.value
        error = of_channel.weight * np.where(of_channel.weight > 0, difference, 0) ** 2
        share = 100 * error / (of_channel.energy or 1.0) / len(samples)
        for name, angle in angles.items():
            parts[name] += np.histogram(angle, EDGES[name], weights=share)[0]
    return parts


@lru_cache(maxsize=1)
def _angles(grid: HalfDifference) -> dict[str, NDArray[np.float64]]:
    """Angles of the cells of a grid in degrees, by the names that they have in `EDGES`."""
    lowest = np.arccos(np.clip(np.minimum(*grid.cosines), 0, 1))
    cells = np.broadcast_arrays(grid.theta_h[:, None, None], grid.theta_d[:, None], lowest)
    names = "theta_h", "theta_d", "lowest"
    return {name: np.degrees(angle) for name, angle in zip(names, cells, strict=True)}


def of_picture(reference: NDArray, picture: NDArray, inside: NDArray[np.bool_]) -> NDArray:
    """Squared error of a picture of a lone sphere by the slant of its pixels, in percent of all.

    Parameters
    ----------
    reference, picture : ndarray, shape (n, n, 3)
        Linear radiance.
    inside : ndarray of bool, shape (n, n)
        Pixels that are compared.

    Returns
    -------
    ndarray, shape (len(EDGES["slant"]) - 1,)
        NaN where the pictures are equal.
    """
    error = ((picture.astype(float) - reference) ** 2).sum(axis=2)
    slant = _slants(len(reference))
    seen = inside & (slant < NOTHING)
    found = np.histogram(slant[seen], EDGES["slant"], weights=error[seen])[0]
    return 100 * found / found.sum() if found.sum() > 0 else np.full_like(found, np.nan)


@cache
def _slants(resolution: int) -> NDArray[np.float64]:
    """Angles of normal and view on a lone sphere, by the pixels of all pictures of that size."""
    return view_angles(Scene(("sphere",)), resolution)


def where(
    run: str | Path,
    scenes: Sequence[str],
    fits: Mapping[str, Sequence[str]],
    objective: Objective,
    read: Callable[[str | Path], Table],
) -> pd.DataFrame:
    """Gather where the error of fits sits.

    Parameters
    ----------
    run : str or Path
        Folder of the run.
    scenes : sequence of str
        Those of a lone sphere.
    fits : mapping of str to sequence of str
        By material, the variants that count.
    objective : Objective
        By which cells are weighted.
    read : callable
        Gives the table of a measurement or of a fit at a path.

    Returns
    -------
    DataFrame
        `COLUMNS`: of every angle of the table, the percent of the objective of black; of `slant`,
        the percent of the squared error of the pictures, mean over the scenes.
    """
    folder, rows = Path(run), []
    for material, variants in fits.items():
        samples = _samples(read(folder / "materials" / f"{material}.binary"), objective)
        rows += _rows(material, RECIPROCAL, of_table(samples, reciprocal(samples)))
        renders = [folder / "renders" / scene / material for scene in scenes]
        references = [read_reference(seen / "measured.exr") for seen in renders]
        for variant in variants:
            fitted = read(folder / "fits" / variant / f"{material}.npz")
            rows += _rows(material, variant, of_table(samples, fitted))
            pictures = (read_exr(seen / f"{variant}.exr")[..., :3] for seen in renders)
            parts = [
                of_picture(reference, picture, inside)
                for (reference, inside), picture in zip(references, pictures, strict=True)
            ]
            if parts:
                rows += _rows(material, variant, {"slant": np.mean(parts, axis=0)})
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _samples(measured: Table, objective: Objective) -> list[Samples[HalfDifference]]:
    """Samples of every channel."""
    assert isinstance(measured.grid, HalfDifference)
    return [channel_samples(measured, channel, objective) for channel in range(len(CHANNELS))]


def _rows(material: str, variant: str, parts: Mapping[str, NDArray]) -> list[tuple]:
    return [
        (material, variant, angle, *edges, part)
        for angle, found in parts.items()
        for *edges, part in zip(EDGES[angle][:-1], EDGES[angle][1:], found, strict=True)
    ]
