"""Several lobes whose D and G the channels share (Peng et al. 2017, equation 3).

rho_c = rho_d_c + F_c(theta_d) sum_l rho_s_cl D_l(theta_h) G_l(theta_i) G_l(theta_o) / (cos cos).
With three lobes it has six numbers more than independent-g. The paper's solver is `awls`; its
Catmull-Rom interpolation of G is the setting `spline`, for either solver.

On a directional grid D hangs on theta_h and phi_h, G on both angles of a direction (equation 4):
2010 numbers on the grid of the UTIA database.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.channels import CoupledFit, as_table, fit_coupled, shared_traces
from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples, fold
from npfm.fitting.shared_lobes import directional, sphere
from npfm.fitting.shared_lobes.fit import fit_lobes
from npfm.fitting.shared_lobes.isotropic import SharedLobesProblem
from npfm.fitting.shared_lobes.places import places
from npfm.fitting.shared_lobes.problem import CLAMP as CLAMP
from npfm.fitting.shared_lobes.problem import State, compiled
from npfm.fitting.shared_lobes.starts import STARTS
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.directional import Directional
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
    "shared": "1 if the channels share D and G, 0 if each has its own (default: 1)",
}
GRIDS = ("half-difference", "directional")
FREEDOMS = 7  # scalings of three D, of three G and of the F of a channel, which rho_s takes up
LOBES, MOST_LOBES = 3, 5
#: Directions of a table beyond which the normal equations would need gigabytes.
MOST_NODES = 500


def parameter_count(
    grid: HalfDifference | Directional, lobes: int = LOBES, spline: int = 0, shared: int = 1
) -> int:
    """Number of values stored for a material: D, G, F, rho_s, rho_d, and 1 to mark a spline."""
    if isinstance(grid, Directional):
        directions = grid.theta_i_count * grid.phi_i_count
        of_D, of_F, of_G = directions, sphere.F_NODES, directions
    else:
        of_D, of_F, of_G = grid.theta_h_bins, grid.theta_d_bins, G_NODES
    factors = lobes * (of_D + of_G) * (1 if shared else 3) + 3 * of_F
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
    shared: int = 1,
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
    shared : int
        Whether the channels share D and G: 0 or 1.
    """
    for name, value, least, most in (
        ("lobes", lobes, 1, MOST_LOBES),
        ("starts", starts, 1, STARTS),
        ("spline", spline, 0, 1),
        ("shared", shared, 0, 1),
    ):
        if not least <= value <= most:
            raise NpfmError(f"{NAME} with {name} {value}: give a number from {least} to {most}")
    fitted = partial(
        fit_lobes, solve=solve, seed=seed, lobes=lobes, starts=starts, spline=bool(spline)
    )
    together = partial(_together if shared else _each, fitted=fitted)
    compiled()
    if isinstance(table.grid, Directional):
        _check_directional(table.grid, bool(spline))
        return _fit_directional(table, objective, together)
    mark = {"spline": np.ones(1)} if spline else {}

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        found = together(samples)
        return replace(found, parameters=found.parameters | mark)

    return fit_coupled(NAME, table, objective, fit_together, tabulate, COEFFICIENTS)


def _fit_directional(
    table: Table[Directional],
    objective: Objective,
    together: Callable[[Sequence[Samples]], CoupledFit],
) -> Fit:
    """Fit from an azimuth of the table's own: a turned one has a turned fit, to the last bit."""
    turn = sphere.first_azimuth(table)
    directional.compiled()

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        found = together(samples)
        lobes = {key: sphere.spread(found.parameters[key], table.grid) for key in ("D", "G")}
        return replace(found, parameters=found.parameters | lobes)

    turned = sphere.turned(table, -turn)
    made = fit_coupled(NAME, turned, objective, fit_together, tabulate, COEFFICIENTS)
    back = {key: np.roll(made.parameters[key], turn, axis=-1) for key in ("D", "G")}
    return replace(made, parameters=made.parameters | back)


def _together(
    samples: Sequence[Samples],
    fitted: Callable[[Sequence[Samples]], tuple[State, list[Trace]]],
) -> CoupledFit:
    """Lobes that all channels share."""
    # In an order of their own: permuted channels have permuted fits, to the last bit.
    order = np.lexsort(np.transpose([[s.floor, s.energy, s.scale] for s in samples]))
    state, traces = fitted([samples[k] for k in order])
    back = np.argsort(order)
    parameters = {
        "D": state.D[None],
        "F": state.F[back],
        "G": state.G[None],
        "rho_s": state.rho_s[back],
        "rho_d": state.rho_d[back],
    }
    return CoupledFit(parameters, shared_traces(traces))


def _each(
    samples: Sequence[Samples],
    fitted: Callable[[Sequence[Samples]], tuple[State, list[Trace]]],
) -> CoupledFit:
    """Lobes of its own for each channel."""
    states, traces = zip(*(fitted([channel]) for channel in samples), strict=True)
    parameters = {
        "D": np.stack([state.D for state in states]),
        "F": np.concatenate([state.F for state in states]),
        "G": np.stack([state.G for state in states]),
        "rho_s": np.concatenate([state.rho_s for state in states]),
        "rho_d": np.concatenate([state.rho_d for state in states]),
    }
    return CoupledFit(parameters, traces)


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


def _check_directional(grid: Directional, spline: bool) -> None:
    if grid.shape[:2] != grid.shape[2:]:
        raise NpfmError(
            f"{NAME} needs light and view in the same directions, not a table of {grid.name}"
        )
    if sphere.node_count(grid) > MOST_NODES:
        raise NpfmError(
            f"{NAME} has a number for each of at most {MOST_NODES} directions, "
            f"not for the {sphere.node_count(grid)} of a table of {grid.name}; give a coarser one"
        )
    if spline:
        raise NpfmError(f"{NAME} with spline 1: a table of {grid.name} reads G at its own nodes")


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    if isinstance(fit.grid, Directional):
        return _tabulate_directional(fit)
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    at, shape = places(fit.grid, 1, "spline" in p), fit.grid.shape[:2]
    lobes = [
        [
            (D[:, None, None] * at.kernel(G).reshape(*shape, -1))
            for D, G in zip(of_D, of_G, strict=True)
        ]
        for of_D, of_G in zip(p["D"], p["G"], strict=True)
    ]
    channels = []
    for k, (F, rho_s, rho_d) in enumerate(zip(p["F"], p["rho_s"], p["rho_d"], strict=True)):
        own = lobes[k % len(lobes)]
        half = rho_d + F[:, None] * sum(s * lobe for s, lobe in zip(rho_s, own, strict=True))
        channels.append(np.concatenate([half, half[..., ::-1]], axis=-1))
    return as_table(channels, fit.grid)


def _tabulate_directional(fit: Fit[Directional]) -> Table:
    p, grid = {name: array.astype(float) for name, array in fit.parameters.items()}, fit.grid
    at = sphere.reading_of_all(grid)
    lobes = [
        at.D_at(D) * np.stack([at.G.kernel(of_lobe)[:, 0] for of_lobe in G], axis=-1)
        for D, G in zip(sphere.gathered(p["D"]), sphere.gathered(p["G"]), strict=True)
    ]
    specular = at.F_at(p["F"])
    channels = [
        (rho_d + F * (lobes[k % len(lobes)] @ rho_s)).reshape(grid.shape)
        for k, (F, rho_s, rho_d) in enumerate(zip(specular, p["rho_s"], p["rho_d"], strict=True))
    ]
    return as_table(channels, grid)
