"""The data matrix of a BRDF: for each view of many, its values over another direction's angles."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.reflectance.factored import TWO_PI, Angles

Array = NDArray[np.float64]
#: Reflectance (3, q) in 1/sr at pairs of directions (q, 3) above the horizon, light and view.
Brdf = Callable[[Array, Array], Array]


@dataclass(frozen=True)
class Samples:
    """A BRDF at all pairs of the angles; b counts (theta_p, phi_p), o counts (theta_o, phi_o).

    Parameters
    ----------
    value : ndarray, shape (3, b, o)
        In 1/sr, 0 where the light is below the horizon.
    cos_i : ndarray, shape (b, o)
        Cosine of the light, 0 below the horizon.
    jacobian : ndarray, shape (b, o)
        4 (i.h) where p is the half vector, else 1.
    """

    value: Array
    cos_i: Array
    jacobian: Array


def vectors(theta: Array, phi: Array) -> Array:
    """Unit vectors (q, 3) at all pairs of angles, those of `phi` next to each other."""
    theta, phi = (x.ravel() for x in np.meshgrid(theta, phi, indexing="ij"))
    sine = np.sin(theta)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)


def sampled(brdf: Brdf, angles: Angles) -> Samples:
    """Evaluate a BRDF at the middles of the bins; view by view, as they would not fit at once."""
    p = vectors(angles.theta_p, angles.phi_p)
    parts = [_slice(brdf, p, view, angles.half) for view in vectors(angles.theta_o, angles.phi_o)]
    value, cos_i, jacobian = (np.stack(part, axis=-1) for part in zip(*parts, strict=True))
    return Samples(value, cos_i, jacobian)


def _slice(brdf: Brdf, p: Array, view: Array, half: bool) -> tuple[Array, Array, Array]:
    """Values (3, b), cosines (b,) and Jacobian (b,) for one view."""
    cos_d = p @ view if half else np.ones(len(p))
    light = 2 * cos_d[:, None] * p - view if half else p
    above = light[:, 2] > 0
    value = np.zeros((3, len(p)))
    value[:, above] = brdf(light[above], np.broadcast_to(view, light[above].shape))
    jacobian = 4 * np.abs(cos_d) if half else cos_d
    return value, np.where(above, light[:, 2], 0.0), jacobian


def solid_angles(angles: Angles) -> Array:
    """Solid angle in steradian of each bin of p, shape (b,)."""
    return np.repeat(angles.bands, angles.shape[3]) * (TWO_PI / angles.shape[3])
