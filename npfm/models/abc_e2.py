"""The model of Loew et al. 2012, fitted by their logarithmic metric E2.

The form is that of `npfm.fitting.parametric.abc`.
"""

from npfm.fitting.parametric import author_metrics, lobe_fits
from npfm.fitting.parametric.abc import FORM

NAME = "abc-e2"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("b", "c", "eta")
SOLVER = False
OBJECTIVE = False
SCALE_FREE = False  # the logarithm is of 1 + the BRDF in 1/sr

MODEL = lobe_fits.Fitted(NAME, FORM, author_metrics.logarithmic)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
