"""The model of Loew et al. 2012, fitted by the objective of the 2016 paper.

The form is that of `npfm.fitting.parametric.abc`.
Bagher et al. 2016, section 5: "Loew (our metric)", which they minimise by the Ceres solver.
"""

from npfm.fitting.parametric import author_metrics, lobe_fits
from npfm.fitting.parametric.abc import FORM

NAME = "abc-ours"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("b", "c", "eta")
SOLVER = False
OWN_TABLE = 1e-6

MODEL = lobe_fits.Fitted(NAME, FORM, author_metrics.compressive)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
