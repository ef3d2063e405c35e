"""Half vectors distributed as the generalised Blinn-Phong lobes of a fit.

Ashikhmin and Shirley 2000: half vectors have the density (n + 1) / (2 pi) cos(theta_h)^n; those
that reflect below the horizon are lost. Which lobe is chosen goes by what it reflects of even
light if it is narrow, rho_s F 8 pi / (n + 1); a Lambertian part is chosen as well (`shares`).
"""

import numpy as np
from numpy.typing import NDArray

from npfm.rendering.sampling.facets import drawn, half_angles, reflected
from npfm.rendering.sampling.lafortune import lobes
from npfm.rendering.sampling.shares import with_cosine
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "blinn-phong"
NEEDS = ("parameters",)

Array = NDArray[np.float64]


class BlinnPhongSampling:
    """Half vectors about the normal.

    Parameters
    ----------
    rho_d : float
        Lambertian part in 1/sr.
    rho_s, n, F_0 : ndarray, shape (L,)
        Of each lobe.
    """

    def __init__(self, rho_d: float, rho_s: Array, n: Array, F_0: Array):
        self.diffuse = np.pi * rho_d
        self.rho_s, self.n, self.F_0 = rho_s, n, F_0

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        term, part = drawn(np.cumsum(self._weights(at), axis=1), u[..., 0])
        exponent = np.append(1 / (self.n + 1), 0.5)[term]
        directions = at.directions(part**exponent, 2 * np.pi * u[..., 1])
        mirrors = (term < len(self.n))[..., None]
        return np.where(mirrors, reflected(directions, at), directions)

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        weight = self._weights(at)
        above, cos_h, cos_d = half_angles(light, at)
        density = weight[:, -1:] * at.cosines(light) / np.pi
        for k, n in enumerate(self.n):
            density += weight[:, k, None] * (n + 1) / (8 * np.pi * cos_d) * cos_h**n
        return np.where(above, density, 0)

    def _weights(self, at: Shading) -> Array:
        """Probabilities (p, L + 1) of the lobes and, as the last, of the cosine."""
        fresnel = self.F_0 + (1 - self.F_0) * (1 - np.clip(at.cos_o, 0, 1)[:, None]) ** 5
        return with_cosine(8 * np.pi * self.rho_s * fresnel / (self.n + 1), self.diffuse)


def make(given: Given) -> BlinnPhongSampling:
    """Follow the lobes of a fit, in the mean over the channels."""
    rho_d, *rest = lobes(given.parameters, ("n", "F_0"), "ashikhmin-shirley")
    return BlinnPhongSampling(float(rho_d), *rest)
