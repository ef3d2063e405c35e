"""The factors of independent-g that Bagher et al. 2016 published (`npfm.models.independent_g`)."""

import numpy as np

from npfm.datasets import published_factors
from npfm.datasets.published_factors import Factors
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.published import with_record
from npfm.fitting.solvers.problem import Solver
from npfm.models import independent_g
from npfm.reflectance.table import Table

NAME = "independent-g-published"
COEFFICIENTS = ("rho_d", "rho_s")
SOLVER = False
OBJECTIVE = False
PUBLISHED = {"kind": "factors", "name": "npf_reference.npz"}

tabulate = independent_g.tabulate
parameter_count = independent_g.parameter_count


def fit(table: Table, objective: Objective, solve: Solver, seed: int, *, published: Factors) -> Fit:
    """Take the published factors; the table is for the record alone.

    Their G is read at the nodes of ours, half a degree further. What no sample has touched, the
    first component of G and of F, has the value of the next one.

    Raises
    ------
    NpfmError
        If a channel of the table has no sample that counts.
    """
    parameters = {name: np.array(values, dtype=float) for name, values in published.items()}
    for name in ("F", "G"):
        parameters[name][:, 0] = parameters[name][:, 1]
    at_nodes = [np.interp(G_THETA, published_factors.G_THETA, G) for G in parameters["G"]]
    parameters["G"] = np.stack(at_nodes)
    stored = {name: values.astype(np.float32) for name, values in parameters.items()}
    fit = Fit(NAME, stored, table.grid)
    return with_record(fit, tabulate(fit), table, objective)
