"""The model of Ward 1992, fitted as Ngan et al. 2005 fit it: by their cosine-weighted metric.

rho = rho_d + rho_s lobe, the lobe and its search in `npfm.fitting.parametric.ngan`; the roughness
is shared by the channels.
"""

from npfm.fitting.parametric import author_metrics, lobe_fits
from npfm.fitting.parametric.ngan import WARD as FORM

NAME = "ward"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("roughness",)
SOLVER = False
OBJECTIVE = False
OWN_TABLE = 1e-6

MODEL = lobe_fits.Fitted(NAME, FORM, author_metrics.cosine)
fit = MODEL.fit
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count
