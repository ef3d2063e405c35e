"""The generalised Blinn-Phong model of Ashikhmin and Shirley 2000, one lobe or several.

`npfm.fitting.parametric.blinn_phong` has the equation, `npfm.fitting.parametric.mixtures` how it is
fitted: to be sampled, as by Lawrence et al. 2004, by one of two criteria.
"""

from npfm.fitting.parametric import mixtures
from npfm.fitting.parametric.blinn_phong import FORM

NAME = "ashikhmin-shirley"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("n", "F_0")
SOLVER = False
OBJECTIVE = False  # that of the criterion
OWN_TABLE = 1e-4  # a search that stops
SETTINGS = {
    "lobes": "how many (default: 1)",
    "criterion": {
        "kullback-leibler": "divergence of the reflected light (default)",
        "least-squares": "squared differences of the reflected light",
    },
}

MODEL = mixtures.Model(NAME, FORM, lobes=1)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
