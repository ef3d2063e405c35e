"""The microfacet model of Loew et al. 2012, "BRDF models for accurate and efficient rendering".

rho = rho_d + rho_s (1 + b (1 - cos(theta_h)))^-c F(theta_d; eta) V / (cos(theta_i) cos(theta_o)),
with F of an unpolarised dielectric (Cook and Torrance 1982) and V the V-groove shadowing. `b`, `c`
and `eta` are shared by the channels, as in the published fits; rho_s is their A over pi (the pi
is part of the published fits, though not of the paper's equation).
"""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.parametric.lobes import Directions, Form, Shape


def fresnel(cos_d: NDArray, eta: NDArray | float) -> NDArray:
    """Unpolarised reflectance of a dielectric of index `eta` (Cook and Torrance 1982)."""
    g = np.sqrt(eta**2 + cos_d**2 - 1)
    parallel = (cos_d * (g + cos_d) - 1) / (cos_d * (g - cos_d) + 1)
    return 0.5 * ((g - cos_d) / (g + cos_d)) ** 2 * (1 + parallel**2)


def lobe(shape: Shape, at: Directions) -> NDArray:
    """Values per unit rho_s, in 1/sr."""
    peak = np.exp(-shape["c"] * np.log1p(shape["b"] * (1 - at.cos_h)))
    return peak * fresnel(at.cos_d, shape["eta"]) * at.grooves


def _shape(x: NDArray) -> Shape:
    """Shape of a vector: width of the lobe at its peak, how it falls further, and Fresnel.

    The last is the amplitude reflected at normal incidence, (eta - 1) / (eta + 1).
    """
    return {"b": np.exp(x[0] - x[1]), "c": np.exp(x[1]), "eta": (1 + x[2]) / (1 - x[2])}


FORM = Form(
    lobe,
    _shape,
    bounds=((-2.0, -5.0, 0.01), (20.0, np.log(10), 0.98)),
    starts={
        f"b={b:g} c={c:g}": (np.log(b * c), np.log(c), 0.2)
        for b, c in ((1e2, 1.5), (1e4, 1.0), (1e6, 0.5))
    },
    shared=True,
    samples=80_000,
)
