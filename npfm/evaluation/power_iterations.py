"""What power iterations recover of known surfaces, what they take, and what they find in a run."""

import time
from collections.abc import Callable, Iterable, Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Samples
from npfm.fitting.power_iterations.eigenproblem import distribution
from npfm.fitting.power_iterations.fresnel import fresnel
from npfm.fitting.power_iterations.mirrors import cells, mirrors
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import beckmann, beckmann_area, ggx, ggx_area
from npfm.reflectance.slopes import (
    ELEVATIONS,
    area_matrix,
    bands,
    beckmann_roughness,
    facing,
    ggx_roughness,
    normalised,
    projected_area,
)

Array = NDArray[np.float64]

SURFACES = {
    "beckmann": (beckmann, beckmann_area, beckmann_roughness),
    "ggx": (ggx, ggx_area, ggx_roughness),
}
#: First bins of theta_h, of which MERL's cameras saw no more than the blur of a mirror.
FIRST_BINS = 5
#: Share by which a roughness may change when those bins are made equal.
RESOLVED = 0.1


def recovery(nodes: Iterable[int], roughness: Iterable[float]) -> pd.DataFrame:
    """Distributions found again from backscattered light: Table 1 of Dupuy et al. 2015.

    Each is shadowed and searched for as in equation 12 there (the paper's kernel).

    Parameters
    ----------
    nodes : iterable of int
        Numbers of backscattering samples.
    roughness : iterable of float
        Values of alpha.

    Returns
    -------
    DataFrame
        Columns surface, nodes, alpha; backscatter_error, the largest relative error of what the
        found surface reflects back, itself by the formula, and alpha_error, that of alpha.
    """
    rows = [
        (surface, count, alpha, *_errors(surface, count, alpha))
        for surface in SURFACES
        for count in nodes
        for alpha in roughness
    ]
    columns = ["surface", "nodes", "alpha", "backscatter_error", "alpha_error"]
    return pd.DataFrame(rows, columns=columns)


def _errors(surface: str, nodes: int, alpha: float) -> tuple[float, float]:
    D, area, roughness = SURFACES[surface]
    grid = HalfDifference(nodes, 1, 2)
    cosine = np.cos(grid.theta_h)
    exact = D(cosine, alpha) / (4 * cosine * area(cosine, alpha))
    samples = Samples(np.ones((nodes, 1, 1)), exact[:, None, None], 1.0, 0.0, grid)
    found = normalised(distribution([samples], "paper")[0], grid)
    areas = (facing(grid.theta_h[:, None], grid.theta_h) * bands(grid)) @ found
    reflected = found / (4 * cosine * areas)
    seen = exact > np.finfo(float).tiny
    error = np.abs(reflected[seen] / exact[seen] - 1).max()
    return float(error), abs(roughness(found, grid) / alpha - 1)


def timing(nodes: Iterable[int], repeats: int) -> pd.DataFrame:
    """Seconds of the parts of a fit against the number of backscattering samples (Figure 5).

    Of a GGX surface in three channels, on grids with so many bins of theta_h and 90 x 180 of the
    other angles.

    Returns
    -------
    DataFrame
        Columns nodes, part, seconds: of processor time, the median of the repeats. ``once`` is
        what is the same for every material of a grid.
    """
    rows = []
    for count in nodes:
        grid = HalfDifference(count, 90, 180)
        began = time.process_time()
        cells(grid), area_matrix(grid)
        rows.append((count, "once", time.process_time() - began))
        rows += [(count, *part) for part in _parts(grid, repeats)]
    return pd.DataFrame(rows, columns=["nodes", "part", "seconds"])


def _parts(grid: HalfDifference, repeats: int) -> list[tuple[str, float]]:
    cosine = np.cos(grid.theta_h)
    ideal = mirrors(ggx(cosine, 0.2), ggx_area(np.cos(ELEVATIONS), 0.2), grid)
    weight = (ideal > 0).astype(float)
    samples = [Samples(weight, ideal, 1.0, 0.0, grid) for _ in range(3)]
    D = normalised(ggx(cosine, 0.2), grid)
    parts = {
        "eigenproblem": lambda: distribution(samples, "consistent"),
        "mirrors": lambda: mirrors(D, projected_area(D, grid), grid),
        "fresnel": lambda: [fresnel(channel, ideal, "least-squares") for channel in samples],
    }
    return [(name, _median(part, repeats)) for name, part in parts.items()]


def _median(part: Callable[[], object], repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        began = time.process_time()
        part()
        seconds.append(time.process_time() - began)
    return float(np.median(seconds))


def surfaces(fits: Mapping[str, Fit]) -> pd.DataFrame:
    """What an artist reads off the power iterations: roughness, and colour at normal incidence.

    Parameters
    ----------
    fits : mapping of str to Fit
        Of the model ``power-iteration``, by material; or of ``ggx``, all of tables of both
        directions.

    Returns
    -------
    DataFrame
        Columns material, alpha_ggx, alpha_beckmann; red, green, blue: F at normal incidence;
        alpha_flattened, that of GGX with the first bins of D made equal; first_bins, the slope at
        their upper edge; resolved, whether the two roughnesses are nearly the same. If not, the
        surface is smoother than the table can tell. Of tables of both directions, in place of all
        but the material and the colour: alpha_x, alpha_y and rho.
    """
    if all(fit.grid.anisotropic for fit in fits.values()):
        return _turned(fits)
    rows = []
    for material, fit in fits.items():
        D, grid = fit.parameters["D"][0].astype(float), fit.grid
        flat = np.where(np.arange(len(D)) < FIRST_BINS, D[FIRST_BINS], D)
        alpha, flattened = ggx_roughness(D, grid), ggx_roughness(flat, grid)
        head_on = fit.parameters["rho_s"] * fit.parameters["F"][:, 0]
        resolved = abs(flattened / alpha - 1) <= RESOLVED
        edge = np.tan((FIRST_BINS / len(D)) ** 2 * np.pi / 2)
        numbers = alpha, beckmann_roughness(D, grid), *head_on, flattened, edge
        rows.append((material, *numbers, resolved))
    names = ["material", "alpha_ggx", "alpha_beckmann", "red", "green", "blue"]
    return pd.DataFrame(rows, columns=[*names, "alpha_flattened", "first_bins", "resolved"])


def _turned(fits: Mapping[str, Fit]) -> pd.DataFrame:
    """Roughness along two axes, and how they are turned."""
    names = ["alpha_x", "alpha_y", "rho"]
    rows = []
    for material, fit in fits.items():
        head_on = fit.parameters["rho_s"] * fit.parameters["F"][:, 0]
        rows.append((material, *(float(fit.parameters[name][0]) for name in names), *head_on))
    return pd.DataFrame(rows, columns=["material", *names, "red", "green", "blue"])
