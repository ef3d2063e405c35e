"""Lobes of Lafortune et al. 1997, "Non-linear approximation of reflectance functions".

rho = rho_d + sum rho_s max(0, C_xy (i_x o_x + i_y o_y) + C_z i_z o_z)^n, theirs for isotropic
reflection, with coefficients C of largest magnitude 1: (-1, 1) has its peak in the mirror
direction, (-1, 0.8) nearer to the horizon, and (1, 1) where the light comes from.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.parametric.lobes import Directions, Form, Shape


def lobe(shape: Shape, at: Directions) -> NDArray:
    """Values per unit rho_s, in 1/sr."""
    vertical = at.cos_i * at.cos_o
    across = 2 * at.cos_d**2 - 1 - vertical
    base = shape["C_xy"] * across + shape["C_z"] * vertical
    # At most 1 above the horizon; of what lies below it a power would overflow.
    return np.clip(base, 0, 1) ** shape["n"]


def _shape(x: NDArray) -> Shape:
    """Shape of a vector: logarithm of the exponent, and angle of the coefficients."""
    C = np.array([-np.sin(x[1]), np.cos(x[1])])
    C_xy, C_z = C / np.abs(C).max()
    return {"n": np.exp(x[0]), "C_xy": C_xy, "C_z": C_z}


_QUARTER = np.pi / 4
FORM = Form(
    lobe,
    _shape,
    bounds=((0.0, -1.4), (np.log(1e5), 1.4)),
    starts={f"n={n:g}": (np.log(n), _QUARTER) for n in (3, 30, 300, 3000)}
    | {"back": (np.log(10), -_QUARTER), "leaning": (np.log(10), 1.0)},
    shared=True,
    samples=30_000,
)
