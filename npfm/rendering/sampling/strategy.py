"""What a strategy is: a way of choosing light directions, with the density of its choice.

A strategy is a file of this folder with a constant NAME, found by the registry beside it, and a
function ``make(given)`` that makes one from what it needs of `Given`. Which of the optional parts
of `Given` it cannot do without stands in the file as NEEDS.

Everywhere p counts points and m samples at each; all directions are unit vectors away from the
surface, and densities are per steradian.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.grids import Grid
from npfm.reflectance.table import Table
from npfm.rendering.lights.environment import Environment
from npfm.rendering.shading import Shading

Array = NDArray[np.float64]


class Strategy(Protocol):
    """A way of choosing light directions."""

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density (p, m) with which `sample` chooses directions `light` (p, m, 3).

        It may be 0 below the horizon, where no light counts, though samples fall there.
        """


@dataclass(frozen=True)
class Given:
    """What strategies are made from.

    Parameters
    ----------
    environment : Environment
        The light.
    grid : Grid
        Of the tables that are rendered.
    table : Table, optional
        The material that the directions are for.
    parameters : mapping of str to ndarray
        Arrays of a fit of the material.
    """

    environment: Environment
    grid: Grid
    table: Table | None = None
    parameters: Mapping[str, NDArray] = field(default_factory=dict)
