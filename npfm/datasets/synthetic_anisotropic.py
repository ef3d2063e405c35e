"""Anisotropic materials written by the project itself: brushed metal, satin, cloth and wood.

They are tables on the grid of the UTIA database with the noise and the gaps that its measurements
have: at grazing angles some values are negative, and some are missing.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from npfm.datasets.anisotropic_formulas import (
    Pairs,
    beckmann_lobe,
    fibre_lobe,
    ggx_lobe,
    ward_lobe,
)
from npfm.datasets.formulas import fresnel
from npfm.datasets.synthetic import ALUMINIUM, CHROMIUM, COPPER, GOLD, PLASTIC
from npfm.errors import NpfmError, suggest
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.table import INVALID, Table

Array = NDArray[np.float64]

#: Standard deviation of the relative error of a value.
NOISE = 0.01
#: Standard deviation of the error that does not depend on the value, in 1/sr, head-on; it is that
#: of what the camera sees, so that it grows with 1 / (cos_i cos_o).
NOISE_FLOOR = 2e-4
#: At the last elevation of both directions so many of the values are missing.
MISSING = 0.05


@dataclass(frozen=True)
class Material:
    """A BRDF without noise: `brdf` gives 1/sr, shape (3, n), for n pairs of directions."""

    description: str
    brdf: Callable[[Pairs], Array]


def materials() -> list[str]:
    """Names of the synthetic anisotropic materials, sorted."""
    return sorted(MATERIALS)


def load(name: str, seed: int, grid: Directional = UTIA) -> Table[Directional]:
    """Simulate the measurement of a material.

    Parameters
    ----------
    name : str
        A key of `MATERIALS`.
    seed : int
        Of the noise, at least 0. A material's noise depends on the seed and its own name only.
    grid : Directional
        Where it is measured.

    Returns
    -------
    Table
        BRDF in 1/sr; with negative values from noise, and `INVALID` where one is missing.

    Raises
    ------
    NpfmError
        If there is no such material.
    """
    if name not in MATERIALS:
        raise NpfmError(f"no synthetic anisotropic material '{name}'; {suggest(name, MATERIALS)}")
    exact = tabulate(MATERIALS[name], grid)
    rng = np.random.default_rng([seed, crc32(name.encode())])
    cosines = np.cos(grid.theta_i)[:, None, None, None] * np.cos(grid.theta_o)[:, None]
    noisy = exact * (1 + NOISE * rng.standard_normal(exact.shape))
    noisy += NOISE_FLOOR / cosines * rng.standard_normal(exact.shape)
    grazing = noisy[:, -1, :, -1]
    grazing[:, rng.random(grazing.shape[1:]) < MISSING] = INVALID
    return Table(noisy, grid)


def tabulate(material: Material, grid: Directional) -> Array:
    """BRDF of a material in 1/sr at the directions of a grid, shape (3,) + grid.shape."""
    light, view = np.broadcast_arrays(grid.light[:, :, None, None], grid.view)
    values = material.brdf(Pairs(light.reshape(-1, 3), view.reshape(-1, 3)))
    return np.broadcast_to(values, (3, grid.size)).reshape(3, *grid.shape)


def _rgb(red: float, green: float, blue: float) -> Array:
    return np.array([[red], [green], [blue]])


def _metal(
    pairs: Pairs,
    lobe: Callable[..., Array],
    alpha: tuple[float, float],
    index: NDArray,
    turn: float = 0.0,
) -> Array:
    return lobe(pairs.turned(turn), *alpha, fresnel(pairs.cos_d, index))


def _milled(
    pairs: Pairs, alpha: tuple[float, float], index: NDArray, turn: float, haze: float = 0.01
) -> Array:
    # Beckmann's lobe has no tail, and no metal that was worked is black beside its highlight.
    lobe = _metal(pairs, beckmann_lobe, alpha, index, turn)
    return lobe + haze * fresnel(np.ones(1), index) / np.pi


def _transmitted(pairs: Pairs) -> Array:
    """Share of light that enters a smooth clear coat and leaves it towards the view."""
    light, view = (1 - fresnel(d[:, 2], PLASTIC) for d in (pairs.light, pairs.view))
    return light * view


def _lacquered(pairs: Pairs) -> Array:
    # The coat is isotropic, so that its highlight is round above the long one of the metal.
    metal = _metal(pairs, ggx_lobe, (0.12, 0.5), COPPER)
    return ggx_lobe(pairs, 0.2, 0.2, fresnel(pairs.cos_d, PLASTIC)) + _transmitted(pairs) * metal


def _shot_silk(pairs: Pairs) -> Array:
    # Warp and weft are bundles of cylinders: their facets face across the thread.
    warp = ggx_lobe(pairs, 0.15, 0.6, _rgb(0.50, 0.06, 0.08))
    weft = ggx_lobe(pairs.turned(90), 0.2, 0.7, _rgb(0.04, 0.10, 0.40))
    return 0.55 * warp + 0.45 * weft + _rgb(0.06, 0.02, 0.05) / np.pi


def _twill(pairs: Pairs) -> Array:
    # Threads that do not cross at a right angle, and one of them dull.
    light = ggx_lobe(pairs.turned(30), 0.25, 0.6, _rgb(0.18, 0.17, 0.15))
    dark = beckmann_lobe(pairs.turned(105), 0.4, 0.6, _rgb(0.05, 0.08, 0.16))
    return light + dark + _rgb(0.10, 0.12, 0.20) / np.pi


def _satin(pairs: Pairs) -> Array:
    # Floats shade themselves when they are looked at, or lit, along their length.
    bright = np.ones(len(pairs.light))
    for direction in (pairs.light, pairs.view):
        x, y = direction[:, 0], direction[:, 1]
        bright = bright * (1 + 0.45 * (y**2 - x**2))
    body = _rgb(0.42, 0.30, 0.34) * bright / np.pi
    return body + beckmann_lobe(pairs, 0.2, 0.5, 2 * fresnel(pairs.cos_d, PLASTIC))


def _ward_plastic(pairs: Pairs) -> Array:
    return _rgb(0.04, 0.20, 0.12) / np.pi + ward_lobe(
        pairs.turned(-45), 0.12, 0.4, _rgb(1, 1, 1) / 8
    )


def _finished_wood(pairs: Pairs) -> Array:
    # Fibres dive into the surface, so that half a turn does not bring the same back.
    fibres = fibre_lobe(pairs, np.radians(12), np.radians(14), _rgb(0.10, 0.06, 0.03))
    body = _transmitted(pairs) * (fibres + _rgb(0.30, 0.16, 0.07) / np.pi)
    return body + ggx_lobe(pairs, 0.25, 0.25, fresnel(pairs.cos_d, PLASTIC))


#: All materials, from the longest highlight to the roundest.
MATERIALS: Mapping[str, Material] = MappingProxyType(
    {
        "brushed-steel": Material(
            "GGX, ten times as rough across the brushing as along it",
            partial(_metal, lobe=ggx_lobe, alpha=(0.05, 0.5), index=CHROMIUM),
        ),
        "brushed-aluminium": Material(
            "GGX, brushed at 30 degrees",
            partial(_metal, lobe=ggx_lobe, alpha=(0.08, 0.45), index=ALUMINIUM, turn=30.0),
        ),
        "milled-copper": Material(
            "Beckmann, milled at -60 degrees",
            partial(_milled, alpha=(0.1, 0.4), index=COPPER, turn=-60.0),
        ),
        "lacquered-copper": Material("a round coat over a long highlight", _lacquered),
        "shot-silk": Material("crossed threads of two colours", _shot_silk),
        "finished-wood": Material("fibres that dive under a varnish: a cone", _finished_wood),
        "ward-plastic": Material("Ward's model over a diffuse body, turned", _ward_plastic),
        "rolled-gold": Material(
            "Beckmann, twice as rough across as along",
            partial(_milled, alpha=(0.15, 0.3), index=GOLD, turn=15.0),
        ),
        "satin": Material("an albedo that depends on direction", _satin),
        "twill": Material("threads that cross at 75 degrees, one of them dull", _twill),
        "cast-chrome": Material(
            "GGX, nearly isotropic",
            partial(_metal, lobe=ggx_lobe, alpha=(0.3, 0.33), index=CHROMIUM),
        ),
        "bead-blasted-aluminium": Material(
            "GGX, isotropic",
            partial(_metal, lobe=ggx_lobe, alpha=(0.45, 0.45), index=ALUMINIUM),
        ),
    }
)
