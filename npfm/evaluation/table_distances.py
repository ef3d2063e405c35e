"""Distances of two tables: cells are weighted by the light that they can send to a viewer.

The weight of a cell is cos(theta_i) cos(theta_o) times the solid angles of light and view that it
stands for, with theta_i and theta_o up to `LIMIT`: the mean over all pairs of directions that a
surface turns to light and viewer.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import counted, importance
from npfm.fitting.parametric.author_metrics import solid_angles
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

#: Largest theta_i and theta_o that count, in degrees; beyond it MERL is extrapolated.
LIMIT = 80.0
#: What is added before the logarithm, in 1/sr: of what reflects less (0.3 % of the light, if it
#: does so all around) nobody sees how much.
BLACK = 1e-3


Weighted = HalfDifference | Directional


def distances(table: Table[Weighted], measured: Table[Weighted]) -> dict[str, float]:
    """Root mean square differences of cube roots and of logarithms.

    Parameters
    ----------
    table, measured : Table
        On one grid. Only cells with a measurement count; negative values of `table` are black.

    Returns
    -------
    dict of str to float
        ``cube-root``, of the BRDF in 1/sr, in sr^(-1/3); ``logarithm``, the natural one of the BRDF
        plus `BLACK`, without unit. NaN if no cell counts.
    """
    weight = _weight(measured.grid)
    counts = measured.valid & (weight > 0)
    if not counts.any():
        return {"cube-root": float("nan"), "logarithm": float("nan")}
    weights = np.broadcast_to(weight, counts.shape)[counts]
    one, other = (np.maximum(t.values[counts], 0) for t in (table, measured))
    return {
        "cube-root": _rms(np.cbrt(one) - np.cbrt(other), weights),
        "logarithm": _rms(np.log(one + BLACK) - np.log(other + BLACK), weights),
    }


@lru_cache(maxsize=1)
def _weight(grid: Weighted) -> NDArray[np.float64]:
    if isinstance(grid, HalfDifference):
        inside = counted(grid, LIMIT)
        return np.where(inside, solid_angles(grid) * importance(grid), 0.0)
    light, view = (
        np.where(theta <= np.deg2rad(LIMIT), np.cos(theta) * np.sin(theta), 0.0)
        for theta in (grid.theta_i, grid.theta_o)
    )
    return np.broadcast_to(light[:, None, None, None] * view[:, None], grid.shape)


def _rms(differences: NDArray, weights: NDArray) -> float:
    return float(np.sqrt(np.average(differences**2, weights=weights)))
