"""What a measured material of Mitsuba 3 and pbrt-v4 holds (Dupuy and Jakob 2018, section 5).

For each of some views there is a density over half vectors, `vndf`, which takes the unit square to
where the material reflects much; and, at points of an even grid over that square, what is reflected
there, with the cosine of the light, over `ndf` / (4 `sigma`). `luminance` is the density of
directions that is left to be sampled when the warp has done its share.

Half vectors are at x = sqrt(theta_h / 90 degrees), as the bins of theta_h are, and y = their
azimuth from the view's. `ndf` is any profile over theta_h, and `sigma` any over theta_o: readers
multiply by the one and divide by the other. Here they are the mean reflectance of the table over
theta_h and the projected area that belongs to it, by which what is left to store varies little.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.exports.interpolated import Interpolated
from npfm.reflectance.half_difference import HALF_PI, HalfDifference
from npfm.reflectance.slopes import ELEVATIONS, normalised, projected_area
from npfm.reflectance.table import Table
from npfm.reflectance.warps import forward
from npfm.rendering.lights.environment import LUMINANCE

Array = NDArray[np.float64]

#: Share of the warp that is even over all half vectors above the horizon: where it is small, the
#: diffuse part of a glossy material has hardly a point.
EVEN = 2 / 3
#: Views stand at the k-th of n to this power: closer together where they graze.
CROWDED = 0.8
#: The last view, in degrees: at 90 everything is seen along the surface.
LAST = 89.0
#: Points of `ndf` between centres of bins of theta_h.
FINE = 2
#: Points of `sigma`.
SIGMAS = 128
#: How far below the horizon, as a cosine, lights are still within the warp: between two views its
#: edge is somewhere between theirs.
BELOW = -0.05
#: Profiles are cut off at this share of their largest value.
SMALLEST = 1e-9
#: Density that is left to directions of no light, as a share of the mean.
LEAST = 1e-3


@dataclass(frozen=True)
class Measured:
    """Arrays of a measured material, without units but for `reflected`.

    Parameters
    ----------
    theta_i : ndarray, shape (views,)
        Elevations of the views in radians.
    ndf, sigma : ndarray, shape (2, n)
        Profiles over theta_h and theta_o, each twice, for two azimuths.
    vndf : ndarray, shape (views, size, size)
        Densities over half vectors, by their azimuth and elevation.
    luminance : ndarray, shape (views, size, size)
        Densities over the square that they are warped from.
    reflected : ndarray, shape (views, 3, size, size)
        BRDF times cosine of the light, over `ndf` / (4 `sigma`), at the grid of that square.
    """

    theta_i: Array
    ndf: Array
    sigma: Array
    vndf: Array
    luminance: Array
    reflected: Array


def measured(table: Table[HalfDifference], views: int, size: int) -> Measured:
    """Resample a table.

    Parameters
    ----------
    table : Table
        On a half-difference grid.
    views : int
        Elevations of the view, at least 2.
    size : int
        Points along a side of the square, at least 2.
    """
    smooth, profile = Interpolated(table), _profile(table)
    x = np.linspace(0, 1, FINE * table.grid.theta_h_bins + 1)
    ndf = _along(profile, x)
    root = np.linspace(0, 1, SIGMAS)
    areas = np.interp(root**2 * HALF_PI, ELEVATIONS, projected_area(profile, table.grid))
    theta = np.minimum(np.linspace(0, 1, views) ** CROWDED * HALF_PI, np.radians(LAST))
    seen = []
    for elevation in theta:
        view = np.array([np.sin(elevation), 0.0, np.cos(elevation)])
        vndf = _visible(profile, view, size)
        places, density = forward(vndf, size)
        half = _half_vectors(places[..., 0], places[..., 1])
        cos_d = half @ view
        light = 2 * cos_d[..., None] * half - view
        value = smooth.brdf(light, np.broadcast_to(view, light.shape)) * light[..., 2]
        sampled = np.maximum(np.tensordot(LUMINANCE, value, 1), 0) * np.maximum(cos_d, 0)
        sampled *= np.divide(
            _stretch(places[..., 0]), density, out=np.zeros_like(density), where=density > 0
        )
        scale = 4 * np.interp(np.sqrt(elevation / HALF_PI), root, areas)
        seen.append((vndf, _positive(sampled), value * scale / np.interp(places[..., 0], x, ndf)))
    vndfs, luminances, values = (np.stack(parts) for parts in zip(*seen, strict=True))
    return Measured(theta, np.tile(ndf, (2, 1)), np.tile(areas, (2, 1)), vndfs, luminances, values)


def _profile(table: Table[HalfDifference]) -> Array:
    """Mean luminance over theta_h, weighted by both cosines, in the scale of a distribution."""
    cos_i, cos_o = table.grid.cosines
    weight = np.where(table.valid.all(0), np.maximum(cos_i * cos_o, 0), 0)
    bright = np.tensordot(LUMINANCE, np.maximum(table.values, 0), 1) * weight
    there = weight.sum((1, 2)) > 0
    means = bright.sum((1, 2))[there] / weight.sum((1, 2))[there]
    bins = np.arange(table.grid.theta_h_bins)
    mean = np.interp(bins, bins[there], means) if there.any() else np.zeros(bins.size)
    if not mean.any():
        return normalised(np.ones_like(mean), table.grid)
    return normalised(np.maximum(mean, SMALLEST * mean.max()), table.grid)


def _along(profile: Array, x: Array) -> Array:
    """A profile at places x, its logarithm linear between bins."""
    bins = np.arange(profile.size)
    return np.exp(np.interp(x * profile.size - 0.5, bins, np.log(profile)))


def _visible(profile: Array, view: Array, size: int) -> Array:
    """Density over half vectors for a view: visible ones of the profile, and an even share."""
    x, y = np.linspace(0, 1, size), np.linspace(0, 1, size)[:, None]
    half = _half_vectors(x, y)
    cos_d = half @ view
    inside = (2 * cos_d * half[..., 2] - view[2] > BELOW) & (cos_d > 0)
    visible = np.where(inside, _along(profile, x) * cos_d * _stretch(x), 0)
    mixed = (1 - EVEN) * visible / _mean(visible) + EVEN * inside / _mean(inside.astype(float))
    # What readers warp by.
    return mixed.astype(np.float32).astype(float)


def _half_vectors(x: Array, y: Array) -> Array:
    """Half vectors at places of the square, the view's azimuth being 0."""
    theta, phi = x**2 * HALF_PI, (2 * y - 1) * np.pi
    sine = np.sin(theta)
    parts = (sine * np.cos(phi), sine * np.sin(phi), np.cos(theta))
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def _stretch(x: Array) -> Array:
    """Solid angle of half vectors over area of the square."""
    return np.maximum(2 * np.pi**2 * x * np.sin(x**2 * HALF_PI), 1e-6)


def _mean(density: Array) -> float:
    """Integral over the square of a density that is linear between its points."""
    return float(np.trapezoid(np.trapezoid(density)) / (np.array(density.shape) - 1).prod())


def _positive(density: Array) -> Array:
    """A density that leaves no place out."""
    return density + (LEAST * density.mean() or 1.0)
