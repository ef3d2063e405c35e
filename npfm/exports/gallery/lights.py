"""Lights as coarse maps, which a page has room for."""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.lights.environment import Environment

ROWS = 128


def coarse(environment: Environment, rows: int = ROWS) -> NDArray[np.float64]:
    """Average a light over the texels of a coarser map; its integral over any of them stays.

    Parameters
    ----------
    environment : Environment
    rows : int
        Of the map that is made, which has twice as many columns.

    Returns
    -------
    ndarray, shape (rows, 2 * rows, 3)
        Linear RGB radiance; a light that has no more rows is left as it is.
    """
    radiance = environment.radiance
    height, width, _ = radiance.shape
    if height <= rows:
        return np.asarray(radiance, dtype=float)
    down = _shares(_heights(height), _heights(rows))
    across = _shares(np.linspace(0, 1, width + 1), np.linspace(0, 1, 2 * rows + 1))
    return np.einsum("ra,abk,cb->rck", down, radiance, across, optimize=True)


def _heights(rows: int) -> NDArray[np.float64]:
    """Edges of rows, in the share of the sphere that is above them."""
    return np.sin(np.arange(rows + 1) * (np.pi / rows) / 2) ** 2


def _shares(fine: NDArray, coarse: NDArray) -> NDArray[np.float64]:
    """Which share each of the intervals between `fine` edges has of those between `coarse` ones."""
    low = np.maximum(fine[:-1], coarse[:-1, None])
    high = np.minimum(fine[1:], coarse[1:, None])
    return np.maximum(high - low, 0) / np.diff(coarse)[:, None]
