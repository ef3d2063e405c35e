"""The lobe of Ashikhmin and Shirley 2000, "An anisotropic Phong BRDF model", with one exponent.

rho = rho_d + rho_s cos(theta_h)^n F / (cos(theta_d) max(cos(theta_i), cos(theta_o))): their
specular part without its constant (n + 1) / (8 pi), F being Schlick's approximation of Fresnel
reflection, which is F_0 at normal incidence. The diffuse part is Lambertian here.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.parametric.lobes import Directions, Form, Shape


def lobe(shape: Shape, at: Directions) -> NDArray:
    """Values per unit rho_s, in 1/sr."""
    F = shape["F_0"] + (1 - shape["F_0"]) * (1 - at.cos_d) ** 5
    return at.cos_h ** shape["n"] * F / (at.cos_d * np.maximum(at.cos_i, at.cos_o))


def _shape(x: NDArray) -> Shape:
    """Shape of a vector: logarithm of the exponent, and Fresnel reflection at normal incidence."""
    return {"n": np.exp(x[0]), "F_0": x[1]}


FORM = Form(
    lobe,
    _shape,
    bounds=((0.0, 1e-3), (np.log(1e6), 1.0)),
    starts={f"n={n:g} F_0={f:g}": (np.log(n), f) for n in (5, 50, 500, 5000) for f in (0.05, 0.8)},
    shared=True,
    samples=30_000,
)
