"""Microfacets from backscattered light alone: the model of Dupuy et al. 2015, by power iterations.

rho = rho_s D(theta_h) F(theta_d) G / (4 cos(theta_i) cos(theta_o)) with Smith's correlated G of D
(equations 1 to 3 there), which is not stored. D is shared by the channels; F and rho_s, its largest
value for a D that is normalised, are of each. There is no diffuse part.
"""

from npfm.fitting.power_iterations import directional
from npfm.fitting.power_iterations.fits import TABULATED, Microfacets

NAME = "power-iteration"
COEFFICIENTS = ("rho_s",)
SHARED = ("D",)
GRIDS = ("half-difference", "directional")
SOLVER = False
OBJECTIVE = False  # only F follows it
SETTINGS = {
    "kernel": {
        "consistent": "D for the shadowing that it is rendered with (default)",
        "paper": "D for the paper's equation 11, which it is not rendered with",
    },
    "fresnel": {
        "least-squares": "F that minimises the objective (default)",
        "mean": "F as the mean of ratios, the paper's equation 20",
        "median": "F as their median",
    },
}

MODEL = Microfacets(NAME, TABULATED, directional.TABULATED)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
rougher = MODEL.rougher
