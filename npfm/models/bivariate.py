"""The bivariate model rho = B(theta_h, theta_d) (Romeiro et al. 2008; Bagher et al. 2016, eq. 5).

Each component is the weighted mean over phi_d of its samples (equation 14, section 4.2): the
minimum of the objective in one step.
"""

import time
from collections.abc import Callable

import numpy as np

from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples, evaluate
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "bivariate"
COEFFICIENTS = ("B",)
SOLVER = False


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material."""
    return 3 * grid.theta_h_bins * grid.theta_d_bins


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the bivariate model; `solve` and `seed` are not needed, the minimum is closed form."""
    # It takes a tenth of a second to import: not at the top, for pictures of fits do without it.
    from scipy.ndimage import distance_transform_edt

    parameters, records = fit_channels(
        table,
        objective,
        lambda samples, channel: _fit_channel(samples, distance_transform_edt),
        COEFFICIENTS,
    )
    return Fit(NAME, parameters, table.grid, records)


def _fit_channel(samples: Samples, distances: Callable) -> ChannelFit:
    began = time.process_time()
    weight = samples.weight.sum(-1)
    seen = weight > 0
    B = (samples.weight * samples.value).sum(-1) / np.where(seen, weight, 1.0)
    # Components without a sample (beyond the angular limit) take the nearest one's value.
    nearest = distances(~seen, return_distances=False, return_indices=True)
    B = B[tuple(nearest)]
    energy = samples.energy or 1.0
    reached = evaluate(samples, B[..., None]) / energy
    seconds = time.process_time() - began
    trace = Trace("closed form", "converged", 1, 0, (0.0, seconds), (1.0, reached))
    return ChannelFit({"B": B}, (trace,))


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    B = fit.parameters["B"].astype(float)
    shape = fit.grid.shape
    return as_table([np.broadcast_to(plane[..., None], shape) for plane in B], fit.grid)
