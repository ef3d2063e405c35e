"""Several cosine lobes that the channels share (Lafortune et al. 1997).

`npfm.fitting.parametric.lafortune` has the equation, `npfm.fitting.parametric.mixtures` how it is
fitted: to be sampled, as by Lawrence et al. 2004, by one of two criteria.
"""

from npfm.fitting.parametric import mixtures
from npfm.fitting.parametric.lafortune import FORM

NAME = "lafortune"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("n", "C_xy", "C_z")
SIGNED = ("C_xy",)
SOLVER = False
OBJECTIVE = False  # that of the criterion
OWN_TABLE = 1e-4  # a search that stops
SETTINGS = {
    "lobes": "how many (default: 2)",
    "criterion": {
        "kullback-leibler": "divergence of the reflected light (default)",
        "least-squares": "squared differences of the reflected light",
    },
}

MODEL = mixtures.Model(NAME, FORM, lobes=2)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
