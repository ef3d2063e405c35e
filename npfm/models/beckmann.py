"""The Beckmann distribution that is nearest to that of `power_iteration`, with the F of that fit.

Dupuy et al. 2015, section 5.4 and appendix C: alpha is read off the variance of the slopes, and F
stays as it is. rho = rho_s D(theta_h; alpha) F(theta_d) G / (4 cos(theta_i) cos(theta_o)) with
Smith's correlated G.
"""

from npfm.fitting.power_iterations import directional
from npfm.fitting.power_iterations.fits import Microfacets, formula
from npfm.reflectance.anisotropic_slopes import beckmann_scale
from npfm.reflectance.microsurfaces import (
    anisotropic_beckmann,
    anisotropic_beckmann_area,
    beckmann,
    beckmann_area,
)
from npfm.reflectance.slopes import beckmann_roughness
from npfm.reflectance.tabulated_slopes import as_beckmann

NAME = "beckmann"
COEFFICIENTS = ("rho_s",)
SHARED = ("alpha", "alpha_x", "alpha_y", "rho")
SIGNED = ("rho",)
GRIDS = ("half-difference", "directional")
SOLVER = False
OBJECTIVE = False
CONVERTED = True
OWN_TABLE = 1e-5  # alpha comes from sums over the bins
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

MODEL = Microfacets(
    NAME,
    formula(beckmann_roughness, beckmann, beckmann_area),
    directional.formula(
        as_beckmann, beckmann_scale, anisotropic_beckmann, anisotropic_beckmann_area
    ),
)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
rougher = MODEL.rougher
