"""Materials written by the project itself, with the noise and the gaps of a measurement.

They run from a mirror to felt. Some are microfacet models and can be fitted exactly but for the
noise; others do what a product of one-dimensional factors cannot express.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from npfm.datasets.formulas import Angles, beckmann_lobe, fresnel, ggx_lobe, rough_diffuse
from npfm.errors import NpfmError, suggest
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID, Table

Array = NDArray[np.float64]

#: Complex refractive indices (red, green, blue): the measured spectra that come with PBRT
#: (Pharr and Humphreys 2010), as averaged over RGB in Yocto/GL's table of metals.
ALUMINIUM = np.array([[1.657 + 9.224j], [0.880 + 6.270j], [0.521 + 4.837j]])
CHROMIUM = np.array([[4.370 + 5.206j], [2.917 + 4.231j], [1.655 + 3.755j]])
COPPER = np.array([[0.200 + 3.913j], [0.924 + 2.453j], [1.102 + 2.142j]])
GOLD = np.array([[0.143 + 3.983j], [0.375 + 2.386j], [1.442 + 1.603j]])
#: Refractive index of common plastics, varnish and glass.
PLASTIC = 1.5
#: Wavelengths that stand for red, green and blue, in micrometres.
WAVELENGTHS = np.array([[0.61], [0.55], [0.465]])

#: Standard deviation of the relative error of a sample, head-on and at grazing angles.
NOISE_HEAD_ON, NOISE_GRAZING = 0.02, 0.05
#: Standard deviation of the error that does not depend on the value, in 1/sr.
NOISE_FLOOR = 1e-4
#: Beyond this theta_i or theta_o samples go missing, all of them at 90 degrees.
RAGGED_FROM = np.radians(88.0)


@dataclass(frozen=True)
class Material:
    """A BRDF without noise: `brdf` gives 1/sr, shape (3, n), for n samples."""

    description: str
    brdf: Callable[[Angles], Array]


def materials() -> list[str]:
    """Names of the synthetic materials, sorted."""
    return sorted(MATERIALS)


def load(name: str, seed: int) -> Table:
    """Simulate the measurement of a material.

    Parameters
    ----------
    name : str
        A key of `MATERIALS`.
    seed : int
        Of the noise, at least 0. A material's noise depends on the seed and its own name only.

    Returns
    -------
    Table
        BRDF in 1/sr on the MERL grid; `INVALID` below the horizon and in a ragged band above it.

    Raises
    ------
    NpfmError
        If there is no such material.
    """
    if name not in MATERIALS:
        raise NpfmError(f"no synthetic material '{name}'; {suggest(name, MATERIALS)}")
    above = MERL.above_horizon
    cos_i, cos_o = (cosine[above] for cosine in MERL.cosines)
    cos_h = np.broadcast_to(np.cos(MERL.theta_h)[:, None, None], MERL.shape)[above]
    cos_d = np.broadcast_to(np.cos(MERL.theta_d)[:, None], MERL.shape)[above]
    rng = np.random.default_rng([seed, crc32(name.encode())])
    brdf = MATERIALS[name].brdf(Angles(cos_h, cos_d, cos_i, cos_o))
    values = np.full((3, *MERL.shape), INVALID)
    values[:, above] = _measure(brdf, np.minimum(cos_i, cos_o), rng)
    return Table(values)


def _measure(brdf: Array, lowest: Array, rng: np.random.Generator) -> Array:
    """Add noise and gaps; `lowest` is the cosine of theta_i or theta_o, whichever is larger.

    Each sample has its own error, so reciprocity holds only on average, as in a measurement.
    """
    relative = NOISE_HEAD_ON + (NOISE_GRAZING - NOISE_HEAD_ON) * (1 - lowest) ** 2
    noisy = brdf * (1 + relative * rng.standard_normal(brdf.shape))
    noisy += NOISE_FLOOR * rng.standard_normal(brdf.shape)
    depth = (np.arccos(lowest) - RAGGED_FROM) / (np.pi / 2 - RAGGED_FROM)
    return np.where(rng.random(lowest.shape) < depth, INVALID, np.maximum(noisy, 0))


def _transmitted(angles: Angles) -> Array:
    """Share of light that enters a smooth plastic surface and leaves it towards the view."""
    return (1 - fresnel(angles.cos_i, PLASTIC)) * (1 - fresnel(angles.cos_o, PLASTIC))


def _rgb(red: float, green: float, blue: float) -> Array:
    return np.array([[red], [green], [blue]])


def _metal(angles: Angles, lobe: Callable[..., Array], alpha: float, index: NDArray) -> Array:
    return lobe(angles, alpha, fresnel(angles.cos_d, index))


def _plastic(angles: Angles, alpha: float, albedo: Array) -> Array:
    return albedo / np.pi + ggx_lobe(angles, alpha, fresnel(angles.cos_d, PLASTIC))


def _hazy_chrome(angles: Angles) -> Array:
    reflectance = fresnel(angles.cos_d, CHROMIUM)
    return ggx_lobe(angles, 0.03, 0.6 * reflectance) + ggx_lobe(angles, 0.3, 0.4 * reflectance)


def _tarnished_bronze(angles: Angles) -> Array:
    # A surface looks smoother at grazing incidence (He et al. 1991): no D(theta_h) F(theta_d).
    tarnish = _rgb(0.85, 0.75, 0.60)
    alpha = 0.04 + 0.26 * angles.cos_d**2
    return ggx_lobe(angles, alpha, tarnish * fresnel(angles.cos_d, COPPER))


def _pearl_paint(angles: Angles) -> Array:
    # Two-beam interference in a film: the phase falls with the angle, so the colour wanders.
    index, thickness = 1.5, 0.42
    refracted = np.sqrt(index**2 - 1 + angles.cos_d**2)
    interference = np.sin(2 * np.pi * thickness * refracted / WAVELENGTHS) ** 2
    surface = fresnel(angles.cos_d, PLASTIC)
    flakes = surface + (1 - surface) ** 2 * 0.5 * interference
    return _rgb(0.10, 0.10, 0.12) / np.pi + ggx_lobe(angles, 0.18, flakes)


def _car_paint(angles: Angles) -> Array:
    flakes = beckmann_lobe(angles, 0.28, _rgb(0.45, 0.05, 0.04))
    base = _rgb(0.12, 0.01, 0.01) / np.pi + flakes
    return ggx_lobe(angles, 0.015, fresnel(angles.cos_d, PLASTIC)) + _transmitted(angles) * base


def _snooker_ball(angles: Angles) -> Array:
    pigment = _transmitted(angles) * _rgb(0.55, 0.03, 0.03) / np.pi
    return pigment + ggx_lobe(angles, 0.03, fresnel(angles.cos_d, PLASTIC))


def _reflective_tape(angles: Angles) -> Array:
    # Light and view are 2 theta_d apart, whatever theta_h is.
    width = np.radians(8.0)
    beads = np.exp(-((2 * np.arccos(angles.cos_d) / width) ** 2)) / (np.pi * width**2)
    retro = _rgb(0.35, 0.35, 0.30) * beads * np.sqrt(angles.cos_i * angles.cos_o)
    surface = ggx_lobe(angles, 0.1, fresnel(angles.cos_d, PLASTIC))
    return _transmitted(angles) * (retro + _rgb(0.20, 0.22, 0.05) / np.pi) + surface


def _nylon(angles: Angles) -> Array:
    # Light that passes through the edge of a translucent body: both directions low, and opposite.
    low = (1 - angles.cos_i) * (1 - angles.cos_o)
    opposite = (1 - angles.cos_d**2) ** 4
    backlight = _rgb(0.80, 0.76, 0.62) * low * opposite
    body = _transmitted(angles) * _rgb(0.55, 0.53, 0.45) / np.pi
    return body + backlight + ggx_lobe(angles, 0.25, fresnel(angles.cos_d, PLASTIC))


def _felt(angles: Angles) -> Array:
    # Fibres stand out: distribution of Estevez and Kulla 2017, shadowing of Neubelt and
    # Pettineo 2013 in place of G / (4 cos_i cos_o).
    roughness = 0.4
    sin_h = np.sqrt(np.maximum(1 - angles.cos_h**2, 0))
    density = (2 + 1 / roughness) * sin_h ** (1 / roughness) / (2 * np.pi)
    both = angles.cos_i + angles.cos_o - angles.cos_i * angles.cos_o
    sheen = _rgb(0.50, 0.30, 0.36) * density / (4 * both)
    return rough_diffuse(angles, _rgb(0.45, 0.12, 0.20), 0.6) + sheen


#: All materials, from the most mirror-like to the most diffuse.
MATERIALS: Mapping[str, Material] = MappingProxyType(
    {
        "mirror-metal": Material(
            "polished aluminium: a highlight of half a degree",
            partial(_metal, lobe=ggx_lobe, alpha=0.01, index=ALUMINIUM),
        ),
        "hazy-chrome": Material("a sharp lobe in a broad haze", _hazy_chrome),
        "snooker-ball": Material("gloss over a diffuse body that it shades", _snooker_ball),
        "car-paint": Material("clear coat over coloured flakes: two lobes", _car_paint),
        "reflective-tape": Material("light sent back where it came from", _reflective_tape),
        "blue-plastic": Material(
            "an exact microfacet model plus Lambert",
            partial(_plastic, alpha=0.12, albedo=_rgb(0.02, 0.06, 0.35)),
        ),
        "pearl-paint": Material("Fresnel colour that shifts with theta_d", _pearl_paint),
        "tarnished-bronze": Material("a highlight that narrows with theta_d", _tarnished_bronze),
        "rough-gold": Material(
            "an exact microfacet model with a coloured Fresnel factor",
            partial(_metal, lobe=ggx_lobe, alpha=0.2, index=GOLD),
        ),
        "satin-copper": Material(
            "the same with a lobe that has no tail",
            partial(_metal, lobe=beckmann_lobe, alpha=0.35, index=COPPER),
        ),
        "nylon": Material("translucent: bright silhouettes against the light", _nylon),
        "dark-rubber": Material(
            "nearly black, its broad gloss seen at grazing angles only",
            partial(_plastic, alpha=0.5, albedo=_rgb(0.025, 0.025, 0.028)),
        ),
        "terracotta": Material(
            "rough and diffuse, brighter towards the light",
            partial(rough_diffuse, albedo=_rgb(0.60, 0.28, 0.17), sigma=0.6),
        ),
        "chalk": Material(
            "nearly Lambertian",
            partial(rough_diffuse, albedo=_rgb(0.88, 0.87, 0.84), sigma=0.15),
        ),
        "pink-felt": Material("fibres: retro-reflection and sheen at the rim", _felt),
    }
)
