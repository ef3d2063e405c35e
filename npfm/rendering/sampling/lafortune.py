"""Directions distributed as the cosine lobes of a fit (Lafortune et al. 1997).

The base of each lobe, C_xy (i_x o_x + i_y o_y) + C_z i_z o_z, is the product of the light with a
vector that the view gives: directions about it have the density (n + 1) / (2 pi) cos^n. Those below
the horizon are lost. Which lobe is chosen goes by what it reflects of even light, its peak being
taken for narrow; a Lambertian part is chosen as well (`shares`).
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.rendering.sampling.facets import drawn
from npfm.rendering.sampling.shares import with_cosine
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.shading import Shading

NAME = "lafortune"
NEEDS = ("parameters",)

Array = NDArray[np.float64]
#: Cosine that a lobe is counted with at least, whose axis is near to the horizon or below.
LEAST_HEIGHT = 0.05


class LafortuneSampling:
    """Directions about the axes of lobes.

    Parameters
    ----------
    rho_d : float
        Lambertian part in 1/sr.
    rho_s, n, C_xy, C_z : ndarray, shape (L,)
        Of each lobe.
    """

    def __init__(self, rho_d: float, rho_s: Array, n: Array, C_xy: Array, C_z: Array):
        self.diffuse = np.pi * rho_d
        self.rho_s, self.n, self.C_xy, self.C_z = rho_s, n, C_xy, C_z

    def sample(self, u: Array, at: Shading) -> Array:
        """Light directions (p, m, 3) of points `u` (p, m, 2) of the unit square."""
        axes, weight = self._lobes(at)
        term, part = drawn(np.cumsum(weight, axis=1), u[..., 0])
        azimuth = 2 * np.pi * u[..., 1]
        light = at.directions(np.sqrt(1 - part), azimuth)
        for k, n in enumerate(self.n):
            about = Shading(normal=axes[:, k], view=axes[:, k])
            chosen = (term == k)[..., None]
            light = np.where(chosen, about.directions(part ** (1 / (n + 1)), azimuth), light)
        return light

    def pdf(self, light: Array, at: Shading) -> Array:
        """Density in 1/sr, shape (p, m), of directions `light` (p, m, 3)."""
        axes, weight = self._lobes(at)
        cos_i = at.cosines(light)
        density = weight[:, -1:] * cos_i / np.pi
        for k, n in enumerate(self.n):
            base = np.clip((light @ axes[:, k, :, None])[..., 0], 0, 1)
            density += weight[:, k, None] * (n + 1) / (2 * np.pi) * base**n
        return np.where(cos_i > 0, density, 0)

    def _lobes(self, at: Shading) -> tuple[Array, Array]:
        """Axes (p, L, 3) of the lobes, and probabilities (p, L + 1) with the cosine's last."""
        cos_o = np.clip(at.cos_o, 0, 1)[:, None]
        along, up = self.C_xy * np.sqrt(1 - cos_o**2), self.C_z * cos_o
        length = np.hypot(along, up)
        safe = np.where(length > 0, length, 1)
        along, up = along / safe, np.where(length > 0, up / safe, 1)
        frame = at.view_frame
        axes = along[..., None] * frame[:, None, 0] + up[..., None] * frame[:, None, 2]
        energy = self.rho_s * length**self.n * np.maximum(up, LEAST_HEIGHT) / (self.n + 1)
        return axes, with_cosine(2 * np.pi * energy, self.diffuse)


def lobes(parameters: Mapping[str, NDArray], names: tuple[str, ...], model: str) -> list[Array]:
    """Mean rho_d, and rho_s and the named shapes (L,) of the lobes of a fit.

    Raises
    ------
    NpfmError
        If one of them is missing or has another shape.
    """
    wanted = ("rho_d", "rho_s", *names)
    there = {name: parameters[name] for name in wanted if name in parameters}
    shapes = {np.shape(there[name]) for name in names if name in there}
    if len(there) < len(wanted) or len(shapes) != 1 or len(min(shapes)) != 2:
        raise NpfmError(f"the fit has no lobes of the model {model}; give one of that model")
    return [np.asarray(there[name], dtype=float).mean(axis=0) for name in wanted]


def make(given: Given) -> LafortuneSampling:
    """Follow the lobes of a fit, in the mean over the channels."""
    rho_d, *rest = lobes(given.parameters, ("n", "C_xy", "C_z"), "lafortune")
    return LafortuneSampling(float(rho_d), *rest)
