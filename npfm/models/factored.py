"""Sums of products of tabulated factors, made to be sampled (Lawrence et al. 2004).

rho = rho_d + rho_s t sum_jk F_j(o) u_jk(theta_p) v_jk(phi_p) / (cos(theta_i) 4 (i.h)), where p is
the half vector or the light; `npfm.reflectance.factored` tells all of it and the arrays. For
measured materials the paper evaluates this in place of the table (section 3).

What is chosen here: azimuths are counted from the view's, since the materials are isotropic.
Factors are linear between the middles of bins, where sampling has them constant in each: the rings
that the paper sees in its highlights (Figure 5) are gone. Samples that do not count take the value
of the nearest one that does. What is factored is the mean of the channels.
"""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from npfm.errors import NpfmError
from npfm.fitting.channels import CoupledFit, as_table, fit_coupled, with_end
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.angles import directions
from npfm.reflectance.factored import Angles, read, reflectance
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "factored"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("kind", "F_o", "u", "v")
RECIPROCAL = False
SOLVER = False
OBJECTIVE = False  # the divergence of what is sampled
OWN_TABLE = 0.05  # resampled between two grids, and a local minimum
SETTINGS = {
    "outer": "terms J of the first factorisation (default: 3)",
    "inner": "terms K of the second, of each of these (default: 2)",
    "views": "bins of theta_o (default: 16)",
    "angles": "bins of theta_p (default: 128)",
    "azimuths": "bins of phi_p (default: 16)",
    "recipe": {"improved": "bins as samples see them (default)", "paper": "as printed in 2004"},
    "parameterisation": {"half-vector": "of the half vector (default)", "incident": "of the light"},
}
OUTER, INNER, VIEWS, ANGLES, AZIMUTHS = 3, 2, 16, 128, 16

Array = NDArray[np.float64]


def parameter_count(
    grid: HalfDifference,
    outer: int = OUTER,
    inner: int = INNER,
    views: int = VIEWS,
    angles: int = ANGLES,
    azimuths: int = AZIMUTHS,
) -> int:
    """Number of values stored for a material, on whatever grid."""
    terms = outer * views + outer * inner * (angles + azimuths)
    return 2 + terms + 3 * (2 + views + angles + azimuths)


def fit(
    table: Table,
    objective: Objective,
    solve: Solver,
    seed: int,
    *,
    outer: int = OUTER,
    inner: int = INNER,
    views: int = VIEWS,
    angles: int = ANGLES,
    azimuths: int = AZIMUTHS,
    recipe: str = "improved",
    parameterisation: str = "half-vector",
) -> Fit:
    """Factor the mean of the channels, and give each a colour; nothing in it is random.

    `npfm.models` says what every `fit` takes and raises.

    Parameters
    ----------
    outer, inner : int
        Terms J and K of the two factorisations.
    views, angles, azimuths : int
        Bins of theta_o, theta_p and phi_p.
    recipe : str
        One of `npfm.fitting.factorisation.recipes.RECIPES`.
    parameterisation : str
        Whether p is the half vector or the light.
    """
    shape = (views, 1, angles, azimuths)
    half = parameterisation == "half-vector"
    plan = Recipe(Angles(half, recipe == "improved", shape), (outer, inner))

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        began = time.process_time()
        found = factor(_filled(samples).lookup, plan)
        arrays = found.factors.arrays()
        for name in COEFFICIENTS:
            arrays[name] = arrays[name] / [channel.scale for channel in samples]
        status = "converged" if found.converged else "iteration cap"
        seconds = (time.process_time() - began) / len(samples)
        trace = Trace("svd", status, found.updates, 0, (seconds,), (1.0,))
        return CoupledFit(arrays, [[trace]] * len(samples))

    fit = fit_coupled(
        NAME, table, objective, fit_together, tabulate, COEFFICIENTS, RECIPROCAL, False
    )
    return replace(fit, records=tuple(with_end(record) for record in fit.records))


def _filled(samples: Sequence[Samples]) -> Table:
    """Table of the samples that count, and everywhere else of the nearest of these."""
    values = []
    for channel in samples:
        nearest = distance_transform_edt(
            channel.weight <= 0, return_distances=False, return_indices=True
        )
        values.append(channel.value[tuple(nearest)] * channel.scale)
    return Table(np.stack(values), samples[0].grid)


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr.

    Raises
    ------
    NpfmError
        If its factors hang on the azimuth of the view, which such a table does not have.
    """
    factors, grid = read(fit.parameters), fit.grid
    if not factors.angles.relative:
        raise NpfmError(
            "these factors differ with the azimuth of the view, and a table of a "
            f"{grid.kind} grid does not; factor with one such azimuth, as in 16x1x128x16"
        )
    values = np.zeros((3, *grid.shape))
    for k, theta_h in enumerate(grid.theta_h):
        light, view = directions(theta_h, grid.theta_d[:, None], grid.phi_d)
        above = grid.above_horizon[k]
        values[:, k, above] = reflectance(factors, light[above], view[above])
    return as_table(list(values), grid)
