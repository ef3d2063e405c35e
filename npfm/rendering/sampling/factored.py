"""Directions distributed as the factors of a BRDF: a term first, then an angle, then an azimuth.

Lawrence et al. 2004, section 5; `npfm.reflectance.factored` tells what a fit has to hold. Each of
the three comes from the inverse of a cumulative distribution of its own. The term and the angle
share the first of two uniform numbers, whose place within the term's part of [0, 1] is uniform
again: so both keep the stratification of that number, the azimuth has the other.

In the recipe ``improved`` the distributions of the half vector are cut at the limits of
`npfm.rendering.sampling.half_vector`, beyond which the light is below the horizon: no sample is
lost. In the recipe ``paper`` such samples count as 0, as there.

Directions as a Lambertian surface reflects them are a term as well (`shares`): the paper has none,
and where factors are 0 the mean would be wrong.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.factored import HALF_PI, TWO_PI, Factors, read
from npfm.rendering.sampling.facets import drawn, reflected
from npfm.rendering.sampling.half_vector import azimuth_limit
from npfm.rendering.sampling.shares import with_cosine
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "factored"
NEEDS = ("parameters",)

Array = NDArray[np.float64]

#: Smallest azimuth in radians that is left at the rim of the range, where there is none.
LEAST_AZIMUTH = 1e-4
#: Share of directions spread evenly in each distribution, so that all of it can be inverted.
EVEN = 1e-4


class FactoredSampling:
    """Directions in proportion to factors; to the cosine where all of these are 0.

    Parameters
    ----------
    factors : Factors
    """

    def __init__(self, factors: Factors):
        self.angles = factors.angles
        n, m = self.angles.shape[2:]
        self.diffuse = np.pi * factors.rho_d.mean()
        mass = factors.rho_s.mean() * factors.v.sum(axis=-1)
        self.terms = (factors.F_o[:, None] * mass[..., None, None]).reshape(
            -1, *factors.F_o.shape[1:]
        )
        u = _shares(factors.u.reshape(-1, n), self.angles.bands)
        v = _shares(factors.v.reshape(-1, m), np.full(m, 1 / m))
        self.density = u / self.angles.bands, v * (m / TWO_PI)
        self.cumulative = _cumulative(u), _cumulative(v)

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        theta_o, phi_o = self._view(at)
        weight, reach = self._weights(theta_o, phi_o)
        term, part = drawn(np.cumsum(weight, axis=1), u[..., 0])
        # All as the cosine has them; those of the other terms take their places.
        cosine, azimuth = np.sqrt(1 - part), TWO_PI * u[..., 1]
        for k, (U, V) in enumerate(zip(*self.cumulative, strict=True)):
            chosen = np.nonzero(term == k)
            row = chosen[0]
            z = -np.interp(part[chosen] * reach[row, k], U, -np.cos(self.angles.edges))
            low, width = self._window(V, np.arccos(z), theta_o[row], phi_o[row])
            turns, share = np.divmod(low + u[chosen][:, 1] * width, 1)
            place = np.interp(share, V, np.linspace(0, TWO_PI, len(V)))
            cosine[chosen], azimuth[chosen] = z, place + TWO_PI * turns - phi_o[row]
        directions = at.directions(cosine, azimuth)
        if not self.angles.half:
            return directions
        mirrors = (term < len(self.terms))[..., None]
        return np.where(mirrors, reflected(directions, at), directions)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        theta_o, phi_o = self._view(at)
        weight, reach = self._weights(theta_o, phi_o)
        above = at.cosines(light) > 0
        p = np.where(above[..., None], light, at.normal[:, None])
        cosine, jacobian = at.cosines(p) / np.pi, np.ones(above.shape)
        if self.angles.half:
            p = p + at.view[:, None]
            length = np.linalg.norm(p, axis=-1)
            p, jacobian = p / length[..., None], 1 / (2 * length)
        x, y, z = np.moveaxis(p @ np.moveaxis(at.view_frame, 1, 2), -1, 0)
        theta = np.arccos(np.clip(z, 0, 1))
        bins = self.angles.bin_of(theta, np.arctan2(y, x) + phi_o[:, None])
        total = weight[:, -1:] * cosine
        for k, V in enumerate(self.cumulative[1]):
            width = self._window(V, theta, theta_o[:, None], phi_o[:, None])[1]
            share = (weight[:, k] / reach[:, k])[:, None] * self.density[0][k, bins[0]]
            total += share * self.density[1][k, bins[1]] / width * jacobian
        return np.where(above, total, 0)

    def _view(self, at: Shading) -> tuple[Array, Array]:
        """Angle of the views, and their azimuth as the factors have it, each (p,)."""
        theta_o = np.arccos(np.clip(at.cos_o, 0, 1))
        if self.angles.relative:
            return theta_o, np.zeros(len(at))
        if at.tangent is None:
            raise NpfmError(
                f"'{NAME}': these factors have azimuths of the view, and the surface has no "
                "tangent to count them from; factor with one azimuth, as in 16x1x128x16"
            )
        x, across = at.view_frame[:, 0], np.cross(at.normal, at.tangent)
        return theta_o, np.arctan2(*(np.einsum("ij,ij->i", x, a) for a in (across, at.tangent)))

    def _weights(self, theta_o: Array, phi_o: Array) -> tuple[Array, Array]:
        """Probability of each term, the last the cosine's, and how much of its angles counts.

        Shapes (p, L + 1) and (p, L).
        """
        limit = (HALF_PI + theta_o) / 2 if self.angles.jacobian else np.full_like(theta_o, HALF_PI)
        heights = np.cos(self.angles.edges)
        reach = np.stack([np.interp(-np.cos(limit), -heights, U) for U in self.cumulative[0]], 1)
        terms = self.angles.of_view(self.terms, theta_o, phi_o).T * reach
        return with_cosine(terms, self.diffuse), reach

    def _window(
        self, V: Array, theta_p: Array, theta_o: Array, phi_o: Array
    ) -> tuple[Array, Array]:
        """Where the azimuths that count begin in a cumulative distribution, and their share."""
        limit = (
            azimuth_limit(theta_p, theta_o)
            if self.angles.jacobian
            else np.full_like(theta_p, np.pi)
        )
        # The floor keeps the density finite.
        limit = np.maximum(limit, LEAST_AZIMUTH)
        low, high = (_turned(V, phi_o + sign * limit) for sign in (-1, 1))
        return low, high - low


def _shares(factor: Array, even: Array) -> Array:
    """Shares (L, bins) of factors, none of them 0, given those of directions spread evenly."""
    total = factor.sum(axis=1, keepdims=True)
    shares = np.where(total > 0, factor / np.where(total > 0, total, 1), even)
    return (1 - EVEN) * shares + EVEN * even


def _cumulative(shares: Array) -> Array:
    """Cumulative distributions (L, bins + 1), from 0 to 1."""
    return np.pad(np.cumsum(shares, axis=1), ((0, 0), (1, 0)))


def _turned(V: Array, azimuth: Array) -> Array:
    """Cumulative distribution (bins + 1,) of azimuths that may be of any turn."""
    turns, place = np.divmod(azimuth, TWO_PI)
    return turns + np.interp(place, np.linspace(0, TWO_PI, len(V)), V)


def make(given: Given) -> FactoredSampling:
    """Follow the factors of a fit."""
    return FactoredSampling(read(given.parameters))
