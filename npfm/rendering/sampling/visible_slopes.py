"""Half vectors distributed as those microfacets of a fit that the camera sees.

Heitz and d'Eon 2014, "Importance sampling microfacet-based BSDFs using the distribution of visible
normals": max(0, o.h) D(h), for a D that is tabulated by theta_h.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.slopes import facing
from npfm.rendering.sampling.facets import Facets, drawn, facets, half_angles, reflected
from npfm.rendering.sampling.strategy import Given, Strategy
from npfm.rendering.sampling.turned_facets import (
    TurnedFacets,
    frames,
    local_half,
    turned_facets,
)
from npfm.rendering.shading import Shading

NAME = "visible-slopes"
NEEDS = ("parameters",)
#: Steps that solve for the azimuth: Newton's, or halvings where those lead out of the bracket.
STEPS = 30

Array = NDArray[np.float64]


class VisibleSlopeSampling:
    """Half vectors with the density max(0, o.h) D(h).

    Bins of theta_h come first, each with the visible area of its facets at its middle; inside a
    bin half vectors are uniform in projected solid angle, and of their azimuths the visible ones
    are chosen in proportion to o.h.
    """

    def __init__(self, surface: Facets):
        self.surface = surface
        self.middle = np.sqrt(1 - (surface.squares[1:] + surface.squares[:-1]) / 2)

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        cos_h = self.surface.cosines(*drawn(np.cumsum(self._shares(at), axis=1), u[..., 0]))
        azimuth = _azimuth(_elevation(at), np.arccos(cos_h), u[..., 1])
        return reflected(at.directions(cos_h, azimuth), at)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3).

        The o.h of the density of half vectors cancels against that of Walter et al. 2007,
        equation 14.
        """
        above, cos_h, _ = half_angles(light, at)
        k = self.surface.bins(cos_h)
        share = np.take_along_axis(self._shares(at), k.astype(np.intp), axis=1)
        visible = facing(_elevation(at), np.arccos(cos_h))
        density = share * cos_h / (2 * np.diff(self.surface.squares)[k])
        return np.where(above & (visible > 0), density / np.where(visible > 0, visible, 1), 0)

    def _shares(self, at: Shading) -> Array:
        """Share of each bin in the visible area, (p, bins)."""
        visible = facing(_elevation(at), np.arccos(self.middle)) / self.middle
        weight = self.surface.areas * visible
        return weight / weight.sum(axis=1, keepdims=True)


def _elevation(at: Shading) -> Array:
    """theta_o, (p, 1)."""
    return np.arccos(np.clip(at.cos_o, 0, 1))[:, None]


def _azimuth(theta_o: Array, theta_h: Array, u: Array) -> Array:
    """Azimuths from the view's with the density max(0, a + b cos), a + b cos being o.h.

    On both sides of 0 the solution of a phi + b sin(phi) = |2 u - 1| (a t + b sin(t)), with t the
    last visible azimuth.
    """
    a, b = np.cos(theta_o) * np.cos(theta_h), np.sin(theta_o) * np.sin(theta_h)
    last = np.arccos(np.clip(-a / np.maximum(b, np.finfo(float).tiny), -1, 1))
    wanted = np.abs(2 * u - 1) * (a * last + b * np.sin(last))
    lower, upper = np.zeros_like(wanted), last
    phi = np.abs(2 * u - 1) * last
    for _ in range(STEPS):
        excess = a * phi + b * np.sin(phi) - wanted
        lower, upper = np.where(excess < 0, phi, lower), np.where(excess < 0, upper, phi)
        slope = a + b * np.cos(phi)
        step = phi - excess / np.where(slope > 0, slope, 1)
        inside = (slope > 0) & (step > lower) & (step < upper)
        phi = np.where(inside, step, (lower + upper) / 2)
    return np.copysign(phi, u - 0.5)


class TurnedVisibleSlopeSampling:
    """The same for facets that are turned about the normal: cells of theta_h and phi_h come first.

    A cell has the area that its facets show where they face the view most, so that one whose middle
    is seen from behind has its share too; inside it half vectors are uniform in projected solid
    angle.
    """

    def __init__(self, surface: TurnedFacets):
        self.surface = surface
        middles = surface.middles
        self.middles = middles.reshape(-1, 3)
        theta = np.arcsin(np.sqrt(surface.squares))
        half_width = np.pi / len(surface.D) * np.sin(theta[1:])
        self.radius = np.hypot(np.diff(theta), half_width)
        self.areas = surface.D * surface.solid_angles / middles[..., 2]

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        normals = self.surface.normals(np.cumsum(self._shares(at), axis=1), u)
        return reflected(normals @ frames(at), at)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        above, half, cos_d = local_half(light, at)
        cell = self.surface.cells(half)
        share = np.take_along_axis(self._shares(at), cell, axis=1)
        angle = self.surface.solid_angles[cell % self.surface.D.shape[1]]
        return np.where(above, share / angle * half[..., 2] / (4 * cos_d), 0)

    def _shares(self, at: Shading) -> Array:
        """Share of each cell in the visible area, (p, azimuths * bins)."""
        view = np.einsum("pij,pj->pi", frames(at), at.view)
        seen = (view @ self.middles.T).reshape(len(at), *self.areas.shape) + self.radius
        weight = (np.maximum(seen, 0) * self.areas).reshape(len(at), -1)
        return weight / weight.sum(axis=1, keepdims=True)


def make(given: Given) -> Strategy:
    """Follow the factor D of a fit."""
    if given.grid.anisotropic:
        return TurnedVisibleSlopeSampling(turned_facets(given))
    return VisibleSlopeSampling(facets(given))
