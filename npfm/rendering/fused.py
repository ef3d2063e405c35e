"""The strategies that scenes are sampled by unless they name others, in one compiled pass.

`light` and `half-vector`, combined by the balance heuristic. What they are is defined by their own
files, and `npfm.rendering.directions.Combined` gives the same directions for them.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.grids import Grid
from npfm.rendering import kernels
from npfm.rendering.directions import Directions, unit_square
from npfm.rendering.lights.environment import LUMINANCE, Environment
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.sampling.strategy import Strategy
from npfm.rendering.shading import Shading
from npfm.rendering.surfaces import Surface

Array = NDArray[np.float64]
Counts = NDArray[np.int64]


def serves(environment: Environment, strategies: Sequence[Strategy], power: float) -> bool:
    """Whether directions of these strategies can be had from `Fused`."""
    if power != 1 or [type(s) for s in strategies] != [LightSampling, HalfVectorSampling]:
        return False
    return getattr(strategies[0], "environment", None) is environment


class Fused:
    """Directions of `light` and `half-vector`.

    Parameters
    ----------
    environment : Environment
    strategies : sequence of Strategy
        Such that `serves` says so.
    rays : int
        Camera rays of a pixel.
    shifts : ndarray, shape (2, pixels, 2)
        By which points of the unit square are rotated.
    levels : ndarray of int, shape (k,)
        Numbers of directions that points may have, ascending.
    """

    def __init__(
        self,
        environment: Environment,
        strategies: Sequence[Strategy],
        rays: int,
        shifts: Array,
        levels: Counts,
    ):
        _, half_vector = strategies
        assert isinstance(half_vector, HalfVectorSampling)
        self.light, self.bins = light_tables(environment), bins(half_vector.grid)
        self.half_vector, self.levels = half_vector, levels
        self.shifts = np.ascontiguousarray(shifts.swapaxes(0, 1))
        squares = [unit_square(rays, count).reshape(-1, 2) for count in levels.tolist()]
        self.square = np.concatenate(squares)
        self.starts = np.cumsum([0, *map(len, squares)])

    def __call__(self, surface: Surface, count: Counts) -> Directions:
        """Directions for p points, `count` (p,) of each strategy."""
        first = self.starts[np.searchsorted(self.levels, count)] + surface.ray * count
        found = kernels.light_directions(
            self.square,
            _points(surface, self.half_vector),
            self.shifts[surface.pixel],
            first,
            count,
            self.light,
            self.bins,
        )
        return Directions(*found)


def highlights(at: Shading, square: Array, environment: Environment, grid: Grid) -> Array:
    """Mean luminance that half vectors of points of the unit square, (m, 2), show: shape (p,)."""
    points = _points(at, HalfVectorSampling(grid))
    rows, columns, _ = environment.radiance.shape
    luminance = environment.texels @ LUMINANCE
    return kernels.highlights(square, points, bins(grid), rows, columns, luminance)


def light_tables(environment: Environment) -> kernels.Light:
    """Tables that directions of a light are sampled and looked up by."""
    rows, columns, _ = environment.radiance.shape
    cumulative = environment.cumulative
    starts = np.ascontiguousarray(cumulative[::columns])
    places = starts[:-1, None] + np.arange(columns) / columns * np.diff(starts)[:, None]
    guide = np.searchsorted(cumulative, places.ravel(), side="right").reshape(places.shape) - 1
    first = np.arange(rows)[:, None] * columns
    guide = np.clip(guide, first, first + columns - 1).astype(np.int32)
    return kernels.Light(
        environment.heights, starts, cumulative, guide.ravel(), environment.density
    )


def bins(grid: Grid) -> kernels.Bins:
    """Bins of theta_h of a grid."""
    edges = np.ascontiguousarray(grid.theta_h_edges)
    # Slots so narrow that no two edges lie in one.
    slots = int(np.ceil(1.01 / np.diff(np.sqrt(edges / np.pi)).min()))
    angles = (np.arange(slots + 1) / slots) ** 2 * np.pi
    guide = np.clip(np.searchsorted(edges, angles * (1 - 1e-12)) - 1, 0, len(edges) - 2)
    return kernels.Bins(edges, np.cos(edges), guide.astype(np.int32))


def _points(at: Shading, half_vector: HalfVectorSampling) -> kernels.Points:
    """Surface points, and the bins of theta_h that half vectors are spread over there."""
    theta_o, limit, used = half_vector.range(at)
    return kernels.Points(
        frames=np.ascontiguousarray(at.view_frame),
        views=np.ascontiguousarray(at.view),
        cos_o=np.cos(theta_o[:, 0]),
        cos_limit=np.cos(limit[:, 0]),
        bins=used[:, 0],
    )
