"""Lights that the project makes itself: four with the character of the paper's four, and none.

The constant light is 1 from everywhere. Each of the four is a small ray-cast place seen from one
point (`npfm.rendering.lights.places`); it is meant to look right, not to be right: lamps cast no
shadows. Medians, means and largest values follow the real probes, times `GAIN` for all but the
house, because the paper shows its other three pictures at an exposure of 0.02 and the Ennis house,
which it calls darker, at an exposure of 1.
"""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

import numpy as np

from npfm.errors import NpfmError, suggest
from npfm.rendering.lights.environment import Environment, tabulate
from npfm.rendering.lights.places import basilica, cathedral, grove, house
from npfm.rendering.lights.places.shapes import Array

#: The ratio of the paper's two exposures.
GAIN = 1 / 0.02
#: Texels are averaged over a grid of directions with at least this many rows.
FINE_ROWS = 1024


def generate(name: str, height: int) -> Environment:
    """Make one of the project's own lights.

    Parameters
    ----------
    name : str
        A name in `LIGHTS`.
    height : int
        Rows of the map; it has twice as many columns. Another height shows the same place.

    Returns
    -------
    Environment
        The light; the same for the same name and height.

    Raises
    ------
    NpfmError
        If there is no such light.
    """
    if name not in LIGHTS:
        raise NpfmError(f"unknown generated light '{name}'; {suggest(name, LIGHTS)}")
    return LIGHTS[name](height)


def _make(place: Callable[[Array], Array], gain: float, height: int) -> Environment:
    radiance = tabulate(place, height, max(2, -(-FINE_ROWS // height)))
    return Environment(gain * radiance)


def _constant(height: int) -> Environment:
    return Environment(np.ones((height, 2 * height, 3)))


#: The lights by name, each a function of the height of the map.
LIGHTS: Mapping[str, Callable[[int], Environment]] = MappingProxyType(
    {
        "cathedral": partial(_make, cathedral.radiance, GAIN),
        "house": partial(_make, house.radiance, 1.0),
        "grove": partial(_make, grove.radiance, GAIN),
        "basilica": partial(_make, basilica.radiance, GAIN),
        "constant": _constant,
    }
)
