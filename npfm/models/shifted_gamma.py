"""The shifted-gamma model of Bagher et al. 2012, fitted by the objective of Bagher et al. 2016.

rho = rho_d + rho_s D(theta_h) F(theta_d) G(theta_i) G(theta_o) / (cos(theta_i) cos(theta_o)), all
of it for each channel by itself, with

    D = exp(-x) / (x^p cos^4(theta_h)),  x = alpha + tan^2(theta_h) / alpha,
    F = f0 - f1 cos(theta_d) + (1 - f0) (1 - cos(theta_d))^5,
    G = 1 + Lambda (1 - exp(((theta - theta0) / tau)^k)) beyond theta0, between 0 and 1.

`tau` is c^(-1/k) of their parameter c, which runs from 0 to 1e109. The authors fit D and F to two
slices and derive G from D; that is not described in the 2016 paper, so all parameters are free here
and the objective is that of the 2016 paper: the model can only gain.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.parametric import author_metrics, lobe_fits
from npfm.fitting.parametric.lobes import Directions, Form, Shape

NAME = "shifted-gamma"
COEFFICIENTS = ("rho_d", "rho_s")
SIGNED = ("f1",)
SOLVER = False
OWN_TABLE = 1e-3  # the parameters of G can make up for each other
#: Where exp is as good as infinite.
LARGEST_EXPONENT = 50.0


def masking_shadowing(shape: Shape, theta: NDArray) -> NDArray:
    """G of the light or view elevation, in [0, 1]."""
    beyond = np.maximum((theta - shape["theta0"]) / shape["tau"], 1e-30)
    power = np.minimum(shape["k"] * np.log(beyond), np.log(LARGEST_EXPONENT))
    return np.clip(1 - shape["Lambda"] * np.expm1(np.exp(power)), 0, 1)


def lobe(shape: Shape, at: Directions) -> NDArray:
    """Values per unit rho_s, in 1/sr; where F falls below 0, they are 0."""
    x = shape["alpha"] + at.tan2_h / shape["alpha"]
    D = np.exp(-x - shape["p"] * np.log(x)) / at.cos_h**4
    f0, cos_d = shape["f0"], at.cos_d
    F = np.maximum(f0 - shape["f1"] * cos_d + (1 - f0) * (1 - cos_d) ** 5, 0)
    G_i, G_o = (masking_shadowing(shape, theta) for theta in at.thetas)
    return D * F * G_i * G_o / (at.cos_i * at.cos_o)


def _shape(x: NDArray) -> Shape:
    """Shape of a vector: F relative to normal incidence has the rise x[3] and ends at exp(x[2])."""
    normal = np.exp(-x[2])
    return {
        "alpha": np.exp(x[0]),
        "p": x[1],
        "f0": normal * (1 + x[3]),
        "f1": normal * x[3],
        "Lambda": np.exp(x[4]),
        "tau": np.exp(x[5]),
        "k": np.exp(x[6]),
        "theta0": x[7],
    }


FORM = Form(
    lobe,
    _shape,
    bounds=(
        (np.log(1e-5), 0.0, -4.0, -1.0, -5.0, -0.7, 1.0, 0.0),
        (np.log(5.0), 4.0, 6.0, 30.0, 5.0, 1.5, 6.0, 1.2),
    ),
    starts={
        f"alpha={alpha:g}": (np.log(alpha), 0.6, 1.0, 0.0, 1.0, 0.4, np.log(20), 0.1)
        for alpha in (1e-3, 1e-2, 0.1, 0.4)
    },
    shared=False,
    samples=40_000,
)

MODEL = lobe_fits.Fitted(NAME, FORM, author_metrics.compressive)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
