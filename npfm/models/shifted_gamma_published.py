"""The fits of Bagher et al. 2012 (`npfm.models.shifted_gamma`) that they published."""

import numpy as np

from npfm.datasets.parameter_files import DIFFUSE, Parameters
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric.lobes import Model
from npfm.fitting.solvers.problem import Solver
from npfm.models.shifted_gamma import FORM
from npfm.reflectance.table import Table

NAME = "shifted-gamma-published"
COEFFICIENTS = ("rho_d", "rho_s")
SIGNED = ("f0", "f1", "theta0")
SOLVER = False
OBJECTIVE = False
PUBLISHED = {
    "kind": "fits",
    "name": "bagher_sgd.fit",
    "holds": {
        "model": "Bagher",
        "shapes": {
            "albedo": (3,),
            "alpha": (3,),
            "p": (3,),
            "eta": (2, 3),
            "K": (3,),
            "Lambda": (3,),
            "c": (3,),
            "k": (3,),
            "theta0": (3,),
        },
    },
}
#: Tau where c is 0: no angle comes near it, so G is 1.
NEVER = 1e3

MODEL = Model(NAME, FORM)
tabulate = MODEL.tabulate
parameter_count = MODEL.parameter_count


def fit(
    table: Table, objective: Objective, solve: Solver, seed: int, *, published: Parameters
) -> Fit:
    """Take the published parameters as they are; the table is for the record alone.

    Raises
    ------
    NpfmError
        If a channel of the table has no sample that counts.
    """
    c, k = published["c"], published["k"]
    parameters = {
        "rho_d": published[DIFFUSE] / np.pi,
        "rho_s": published["albedo"] * published["K"] / np.pi**2,
        "alpha": published["alpha"],
        "p": published["p"],
        "f0": published["eta"][0],
        "f1": published["eta"][1],
        "Lambda": published["Lambda"],
        "tau": np.where(c > 0, np.where(c > 0, c, 1.0) ** (-1 / k), NEVER),
        "k": k,
        "theta0": published["theta0"],
    }
    return MODEL.published(table, objective, parameters)
