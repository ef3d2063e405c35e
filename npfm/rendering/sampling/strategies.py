"""Strategies that choose light directions, and their combination.

A strategy has `sample` and `pdf`. Everywhere p counts surface points and m samples at each; all
directions are unit vectors away from the surface, and densities are per steradian.
"""

from collections.abc import Sequence
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.half_difference import HALF_PI, Grid
from npfm.rendering.lights.environment import Environment

Array = NDArray[np.float64]


class Strategy(Protocol):
    """A way of choosing light directions."""

    def sample(self, u: Array, view: Array, normal: Array) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""

    def pdf(self, light: Array, view: Array, normal: Array) -> Array:
        """Density (p, m) with which `sample` chooses directions `light` (p, m, 3)."""


class LightSampling:
    """Directions distributed as the light is."""

    def __init__(self, environment: Environment):
        self.environment = environment

    def sample(self, u: Array, view: Array, normal: Array) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        return self.environment.sample(u.reshape(-1, 2)).reshape(*u.shape[:2], 3)

    def pdf(self, light: Array, view: Array, normal: Array) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        return self.environment.pdf(light)


class HalfVectorSampling:
    """Half vectors spread evenly over the theta_h bins of a grid, whatever the material.

    Every bin, so every width of a highlight, gets the same share. Inside a bin, half vectors
    are uniform in solid angle. Their azimuth is uniform over those for which the light lies above
    the horizon, which is the case where, azimuths being counted from the view direction's,

        cos(phi_h) >= -cot(2 theta_h) cot(theta_o),

    so that no sample is lost; bins beyond theta_h = 45 degrees + theta_o / 2 have none of these.
    """

    def __init__(self, grid: Grid):
        self.bins = grid.theta_h_bins
        self.edges = (np.arange(self.bins + 1) / self.bins) ** 2 * HALF_PI

    def sample(self, u: Array, view: Array, normal: Array) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        theta_o, limit, count = self._range(view, normal)
        position = u[..., 0] * count
        k = np.minimum(position.astype(int), count - 1)
        upper, lower = self._cosines(k, limit)
        cos_h = upper + (position - k) * (lower - upper)
        phi = (2 * u[..., 1] - 1) * _azimuth_limit(np.arccos(cos_h), theta_o)
        sin_h = np.sqrt(1 - cos_h**2)
        local = np.stack([sin_h * np.cos(phi), sin_h * np.sin(phi), cos_h], axis=-1)
        half = local @ _frame(view, normal)
        return 2 * (half @ view[:, :, None]) * half - view[:, None]

    def pdf(self, light: Array, view: Array, normal: Array) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3).

        That of the half vector over 4 (o . h), Walter et al. 2007, equation 14.
        """
        theta_o, limit, count = self._range(view, normal)
        cos_i, cos_io = np.moveaxis(light @ np.stack([normal, view], axis=-1), -1, 0)
        above = cos_i > 0
        cos_d = np.sqrt((1 + np.where(above, cos_io, 0)) / 2)
        cos_h = np.where(above, np.minimum((cos_i + np.cos(theta_o)) / (2 * cos_d), 1), 1)
        theta_h = np.arccos(cos_h)
        k = (np.sqrt(theta_h / HALF_PI) * self.bins).astype(int)
        upper, lower = self._cosines(np.minimum(k, count - 1), limit)
        # At the rim of the range no azimuth is left; the floor keeps the density finite there.
        azimuths = 2 * np.maximum(_azimuth_limit(theta_h, theta_o), 1e-9)
        return np.where(above, 1 / (count * (upper - lower) * azimuths * 4 * cos_d), 0)

    def _range(self, view: Array, normal: Array) -> tuple[Array, Array, NDArray[np.int64]]:
        """theta_o, the largest useful theta_h and the number of bins up to it, each (p, 1)."""
        theta_o = np.arccos(np.clip(np.einsum("ij,ij->i", view, normal), 0, 1))[:, None]
        limit = (HALF_PI + theta_o) / 2
        return theta_o, limit, np.searchsorted(self.edges, limit)

    def _cosines(self, k: NDArray[np.int64], limit: Array) -> tuple[Array, Array]:
        """Cosines of the two edges of bins k, cut at the limit."""
        return np.cos(self.edges)[k], np.cos(np.minimum(self.edges[k + 1], limit))


def _azimuth_limit(theta_h: Array, theta_o: Array) -> Array:
    """Largest |phi_h| for which the light is above the horizon."""
    sine = np.sin(2 * theta_h) * np.sin(theta_o)
    cosine = -np.cos(2 * theta_h) * np.cos(theta_o)
    return np.arccos(np.clip(cosine / np.maximum(sine, 1e-12), -1, 1))


def _frame(view: Array, normal: Array) -> Array:
    """Rows x, y, z of frames with z = `normal` and the view in the half plane y = 0, x > 0."""
    x = view - np.einsum("ij,ij->i", view, normal)[:, None] * normal
    # Looking straight down, any x will do: the coordinate axis that is farthest from the normal.
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    along = np.einsum("ij,ij->i", axis, normal)[:, None] * normal
    x = np.where(np.linalg.norm(x, axis=1, keepdims=True) > 1e-7, x, axis - along)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([x, np.cross(normal, x), normal], axis=1)


def combine(
    strategies: Sequence[Strategy], points: Sequence[Array], view: Array, normal: Array
) -> tuple[Array, Array]:
    """Draw from several strategies, weighted by the balance heuristic (Veach 1997, eq. 9.8).

    Parameters
    ----------
    strategies : sequence of Strategy
    points : sequence of ndarray, shape (p, m_s, 2)
        Points of the unit square for each strategy.
    view, normal : ndarray, shape (p, 3)

    Returns
    -------
    light : ndarray, shape (p, sum of m_s, 3)
    density : ndarray, shape (p, sum of m_s)
        Samples per steradian. The sum of f(light) / density estimates the integral of f.
    """
    light = np.concatenate(
        [s.sample(u, view, normal) for s, u in zip(strategies, points, strict=True)], axis=1
    )
    density = np.zeros(light.shape[:2])
    for strategy, u in zip(strategies, points, strict=True):
        density += u.shape[1] * strategy.pdf(light, view, normal)
    return light, density


@cache
def low_discrepancy(count: int) -> Array:
    """First points of the two-dimensional Sobol sequence, shape (count, 2)."""
    # scipy.stats alone takes half a second to import.
    from scipy.stats import qmc

    power = max(count - 1, 0).bit_length()
    return qmc.Sobol(2, scramble=False).random_base2(power)[:count]


def rotate(points: Array, shift: Array) -> Array:
    """Cranley-Patterson rotation: `points` (..., 2) moved by `shift` on the torus."""
    return (points + shift) % 1.0
