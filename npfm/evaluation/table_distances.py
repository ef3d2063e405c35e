"""Distances of two tables: cells are weighted by the light that they can send to a viewer.

The weight of a cell is cos(theta_i) cos(theta_o) times the solid angles of light and view that it
stands for, with theta_i and theta_o up to `LIMIT`: the mean over all pairs of directions that a
surface turns to light and viewer.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import counted, importance, solid_angles
from npfm.reflectance.grids import Grid
from npfm.reflectance.table import Table

#: Largest theta_i and theta_o that count, in degrees; beyond it MERL is extrapolated.
LIMIT = 80.0
#: What is added before the logarithm, in 1/sr: of what reflects less (0.3 % of the light, if it
#: does so all around) nobody sees how much.
BLACK = 1e-3


def distances(table: Table, measured: Table) -> dict[str, float]:
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
def _weight(grid: Grid) -> NDArray[np.float64]:
    return np.where(counted(grid, LIMIT), solid_angles(grid) * importance(grid), 0.0)


def _rms(differences: NDArray, weights: NDArray) -> float:
    return float(np.sqrt(np.average(differences**2, weights=weights)))
