"""Half and difference angles (Rusinkiewicz coordinates) of isotropic reflection.

Conventions are those of the MERL reader: the normal is z, ``theta_h`` the angle between the
normal and the half vector, ``theta_d`` the angle between the light and the half vector, and
``phi_d`` the rotation of the light around the half vector, 0 when the light leans away from
the normal in their common plane. All angles are in radians, all directions unit vectors
pointing away from the surface.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def directions(theta_h: ArrayLike, theta_d: ArrayLike, phi_d: ArrayLike) -> tuple[Array, Array]:
    """Light and view directions of half and difference angles, the half vector at azimuth 0.

    Bagher et al. 2016, appendix "Volume Form Derivation".

    Parameters
    ----------
    theta_h, theta_d, phi_d : array_like
        Angles in radians, of shapes that broadcast to S.

    Returns
    -------
    light, view : ndarray, shape S + (3,)
        Unit vectors; either may lie below the horizon (z < 0).
    """
    theta_h, theta_d, phi_d = np.broadcast_arrays(theta_h, theta_d, phi_d)
    zero = np.zeros(theta_h.shape)
    half_vector = np.stack([np.sin(theta_h), zero, np.cos(theta_h)], axis=-1)
    tangent = np.stack([np.cos(theta_h), zero, -np.sin(theta_h)], axis=-1)
    bitangent = np.array([0.0, 1.0, 0.0])
    across = np.sin(theta_d)[..., None] * (
        np.cos(phi_d)[..., None] * tangent + np.sin(phi_d)[..., None] * bitangent
    )
    along = np.cos(theta_d)[..., None] * half_vector
    return along + across, along - across


def half_difference(
    light: ArrayLike, view: ArrayLike, normal: ArrayLike = (0.0, 0.0, 1.0)
) -> tuple[Array, Array, Array]:
    """Half and difference angles of light and view directions.

    Reciprocity is built in, as in MERL: exchanging `light` and `view` turns ``phi_d`` by pi,
    and ``phi_d`` is returned modulo pi.

    Parameters
    ----------
    light, view, normal : array_like, shape (..., 3)
        Unit vectors of shapes that broadcast.

    Returns
    -------
    theta_h, theta_d, phi_d : ndarray
        Radians, in [0, pi/2], [0, pi/2] and [0, pi) for directions above the horizon. Where the
        half vector is the normal, or light and view coincide, ``phi_d`` is not defined by
        geometry and what rounding leaves of it has no meaning.
    """
    light, view, normal = (np.asarray(v, dtype=float) for v in (light, view, normal))
    half_vector = light + view
    length = np.sqrt(np.einsum("...i,...i", half_vector, half_vector))
    cos_h = np.einsum("...i,...i", half_vector, normal) / length
    # All through dot products, so that no local frame is built for a sample. Half the sum and
    # half the difference of two unit vectors are cos(theta_d) and sin(theta_d) long.
    difference = light - view
    theta_d = np.arctan2(np.sqrt(np.einsum("...i,...i", difference, difference)), length)
    tilt = np.cross(normal, half_vector) / length[..., None]
    sin_h = np.sqrt(np.einsum("...i,...i", tilt, tilt))
    theta_h = np.arctan2(sin_h, cos_h)
    sine = np.einsum("...i,...i", light, tilt)
    cosine = cos_h * length / 2 - np.einsum("...i,...i", light, normal)
    phi_d = np.mod(np.arctan2(sine, cosine), np.pi)
    # A tiny negative angle is rounded up to pi itself by the modulus.
    return theta_h, theta_d, np.where(phi_d >= np.pi, 0.0, phi_d)
