"""Half vectors distributed as the microfacets of a fit, by the quantiles of their slopes.

Dupuy et al. 2015, appendix A, after Walter et al. 2007. Slopes of isotropic facets have no
preferred azimuth, so that the two tables of quantiles are one, of theta_h; where a fit tells
azimuths apart they are two (`turned_facets`).
"""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.sampling.facets import Facets, drawn, facets, half_angles, reflected
from npfm.rendering.sampling.strategy import Given, Strategy
from npfm.rendering.sampling.turned_facets import (
    TurnedFacets,
    frames,
    local_half,
    turned_facets,
)
from npfm.rendering.shading import Shading

NAME = "quantiles"
NEEDS = ("parameters",)

Array = NDArray[np.float64]


class QuantileSampling:
    """Half vectors with the density D cos(theta_h), whatever the view."""

    def __init__(self, surface: Facets):
        self.surface = surface
        self.total = surface.areas.sum()
        self.quantiles = np.cumsum(surface.areas) / self.total

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square.

        Below the horizon where a facet is seen from behind, or reflects down.
        """
        rows = np.broadcast_to(self.quantiles, (len(at), self.quantiles.size))
        cos_h = self.surface.cosines(*drawn(rows, u[..., 0]))
        return reflected(at.directions(cos_h, 2 * np.pi * u[..., 1]), at)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        above, cos_h, cos_d = half_angles(light, at)
        D = self.surface.D[self.surface.bins(cos_h)] / (np.pi * self.total)
        return np.where(above, D * cos_h / (4 * cos_d), 0)


class TurnedQuantileSampling:
    """The same for facets that are turned about the normal."""

    def __init__(self, surface: TurnedFacets):
        self.surface = surface
        areas = (surface.D * surface.solid_angles).ravel()
        self.total = areas.sum()
        self.quantiles = np.cumsum(areas) / self.total

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        rows = np.broadcast_to(self.quantiles, (len(at), self.quantiles.size))
        return reflected(self.surface.normals(rows, u) @ frames(at), at)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        above, half, cos_d = local_half(light, at)
        D = self.surface.D.ravel()[self.surface.cells(half)] / self.total
        return np.where(above, D * half[..., 2] / (4 * cos_d), 0)


def make(given: Given) -> Strategy:
    """Follow the factor D of a fit."""
    if given.grid.anisotropic:
        return TurnedQuantileSampling(turned_facets(given))
    return QuantileSampling(facets(given))
