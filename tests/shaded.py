"""Points to be shaded, and integrals over the light directions of one, for tests of strategies."""

import numpy as np

from npfm.rendering.sampling.low_discrepancy import low_discrepancy
from npfm.rendering.shading import Shading


def unit(vector):
    return np.asarray(vector) / np.linalg.norm(vector)


def point(theta_o, normal=(0.2, 0.9, -0.4)):
    """One point whose view is at `theta_o` degrees from its normal, with a tangent."""
    normal = unit(normal)
    side = unit(np.cross(normal, [0.3, 0.2, 0.9]))
    view = np.cos(np.radians(theta_o)) * normal + np.sin(np.radians(theta_o)) * side
    return Shading(normal=normal[None], view=view[None], tangent=np.cross(normal, side)[None])


def about_mirror(at):
    """The mirror direction of a point's view as a normal, azimuths counted from the point's own."""
    mirror = 2 * at.cos_o[:, None] * at.normal - at.view
    return Shading(normal=mirror, view=at.normal)


def above_horizon(at, count=1 << 19, share=0.6):
    """Directions above the horizon of a point, and the solid angle that each stands for.

    They are `count` evenly spread points of the sphere in polar coordinates about the mirror
    direction, closer together near to it, by `share`.
    """
    s, azimuth = low_discrepancy(count).T
    polar = np.pi * (share * s**4 + (1 - share) * s)
    measure = 2 * np.pi**2 * np.sin(polar) * (4 * share * s**3 + 1 - share) / count
    light = about_mirror(at).directions(np.cos(polar)[None], 2 * np.pi * azimuth[None])[0]
    kept = light @ at.normal[0] > 0
    return light[kept], measure[kept]


def smooth(at, tilt):
    """Functions of the light that vanish at the horizon of a point."""
    return lambda light: np.maximum(light @ at.normal[0], 0) ** 2 * np.exp(light @ np.asarray(tilt))
