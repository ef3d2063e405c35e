"""Several lobes whose D and G the channels share (Peng et al. 2017, equation 3).

rho_c = rho_d_c + F_c(theta_d) sum_l rho_s_cl D_l(theta_h) G_l(theta_i) G_l(theta_o) / (cos cos).
With three lobes it has six numbers more than independent-g. The paper's solver is `awls`; its
Catmull-Rom interpolation of G is the setting `spline`, for either solver.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.channels import CoupledFit, as_table, fit_coupled, shared_traces
from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, Samples, fold
from npfm.fitting.shared_lobes.fit import fit_lobes
from npfm.fitting.shared_lobes.places import places
from npfm.fitting.shared_lobes.problem import CLAMP as CLAMP
from npfm.fitting.shared_lobes.problem import SharedLobesProblem, State, compiled
from npfm.fitting.shared_lobes.starts import STARTS
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "shared-lobes"
COEFFICIENTS = ("rho_d", "rho_s")
SHARED = ("D", "G", "spline")
RANDOM = True
SETTINGS = {
    "lobes": "how many lobes, 1 to 5 (default: 3)",
    "starts": "use only the first N of the three starts (default: 3)",
    "spline": "1 to read G along a Catmull-Rom spline, 0 linearly (default: 0)",
}
FREEDOMS = 7  # scalings of three D, of three G and of the F of a channel, which rho_s takes up
LOBES, MOST_LOBES = 3, 5


def parameter_count(grid: HalfDifference, lobes: int = LOBES, spline: int = 0) -> int:
    """Number of values stored for a material: D, G, F, rho_s, rho_d, and 1 to mark a spline."""
    factors = lobes * (grid.theta_h_bins + G_NODES) + 3 * grid.theta_d_bins
    return factors + 3 * (lobes + 1) + bool(spline)


def fit(
    table: Table,
    objective: Objective,
    solve: Solver,
    seed: int,
    *,
    lobes: int = LOBES,
    starts: int = STARTS,
    spline: int = 0,
) -> Fit:
    """Fit the model from several starts and keep the best.

    `npfm.models` says what every `fit` takes and raises.

    Parameters
    ----------
    lobes : int
        Number of lobes.
    starts : int
        How many starts, and which: the first ones of `start_states`.
    spline : int
        Whether G is read along a spline: 0 or 1.
    """
    for name, value, least, most in (
        ("lobes", lobes, 1, MOST_LOBES),
        ("starts", starts, 1, STARTS),
        ("spline", spline, 0, 1),
    ):
        if not least <= value <= most:
            raise NpfmError(f"{NAME} with {name} {value}: give a number from {least} to {most}")
    compiled()

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        # In an order of their own: permuted channels have permuted fits, to the last bit.
        order = np.lexsort(np.transpose([[s.floor, s.energy, s.scale] for s in samples]))
        state, traces = fit_lobes(
            [samples[k] for k in order], solve, seed, lobes, starts, bool(spline)
        )
        back = np.argsort(order)
        parameters = {
            "D": state.D[None],
            "F": state.F[back],
            "G": state.G[None],
            "rho_s": state.rho_s[back],
            "rho_d": state.rho_d[back],
        }
        if spline:
            parameters["spline"] = np.ones(1)
        return CoupledFit(parameters, shared_traces(traces))

    return fit_coupled(NAME, table, objective, fit_together, tabulate, COEFFICIENTS)


def linearised(
    samples: Samples, p: dict[str, NDArray[np.float64]]
) -> tuple[SharedLobesProblem, State]:
    """Problem of one channel with lobes of its own, at the state of a fit of all channels.

    Parameters
    ----------
    samples : Samples
        Of the channel, not folded.
    p : dict of str to ndarray
        Parameters of the channel.
    """
    problem = SharedLobesProblem([fold(samples)], len(p["D"]), "spline" in p)
    return problem, problem.state(p["D"], p["F"][None], p["G"])


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    at, shape = places(fit.grid, 1, "spline" in p), fit.grid.shape[:2]
    lobes = [
        (D[:, None, None] * at.kernel(G).reshape(*shape, -1))
        for D, G in zip(p["D"][0], p["G"][0], strict=True)
    ]
    channels = []
    for F, rho_s, rho_d in zip(p["F"], p["rho_s"], p["rho_d"], strict=True):
        half = rho_d + F[:, None] * sum(s * lobe for s, lobe in zip(rho_s, lobes, strict=True))
        channels.append(np.concatenate([half, half[..., ::-1]], axis=-1))
    return as_table(channels, fit.grid)
