"""The model of Cook and Torrance as Ngan et al. 2005 fit it, by their cosine-weighted metric.

rho = rho_d + rho_s D(theta_h) F(theta_d) V / (cos(theta_i) cos(theta_o)): D of Beckmann, F of
Schlick with F(0) = `f0`, V the V-groove shadowing. `roughness` and `f0` are shared by the channels.
What is minimised is `author_metrics.cosine`; Ngan et al. restart by hand where a fit fails, here
there are several starts.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.parametric import author_metrics, lobe_fits
from npfm.fitting.parametric.lobes import Directions, Form, Shape

NAME = "cook-torrance"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness", "f0")
SOLVER = False
OBJECTIVE = False
OWN_TABLE = 1e-6


def lobe(shape: Shape, at: Directions) -> NDArray:
    """Values per unit rho_s, in 1/sr."""
    m2 = shape["roughness"] ** 2
    D = np.exp(-at.tan2_h / m2) / (np.pi * m2 * at.cos_h**4)
    F = shape["f0"] + (1 - shape["f0"]) * (1 - at.cos_d) ** 5
    return D * F * at.grooves


FORM = Form(
    lobe,
    lambda x: {"roughness": np.exp(x[0]), "f0": np.exp(x[1])},
    bounds=((np.log(2e-3), np.log(1e-3)), (np.log(3.0), 0.0)),
    starts={
        f"roughness={m:g} f0={f0:g}": (np.log(m), np.log(f0))
        for m, f0 in ((0.01, 0.3), (0.04, 0.3), (0.15, 0.1), (0.4, 0.1))
    },
    shared=True,
    samples=80_000,
)

MODEL = lobe_fits.Fitted(NAME, FORM, author_metrics.cosine)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
