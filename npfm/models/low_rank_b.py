"""The bivariate-g model with B compressed to a few products of one-dimensional factors.

rho = rho_d + K max(0, sum_r U_r(theta_h) V_r(theta_d)), K = G(theta_i) G(theta_o) / (cos cos).
Bagher et al. 2016 leave open in their conclusion how to compress B, and find that truncating its
singular value decomposition does poorly. With the G of the bivariate-g fit held, the objective is
sum wK^2 (B - B*)^2 over the cells plus a constant, B* being the best free B: a weighted low-rank
approximation (Srebro and Jaakkola 2003), solved by alternating least squares. Factors may be
negative; clamping their sum at 0 can only bring it nearer to B* >= 0, so that this is never
worse than factors that are non-negative themselves.
"""

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.factors.microfacet import G_NODES, compiled, tabulate_product
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples
from npfm.fitting.solvers.problem import Solver
from npfm.models import bivariate_g
from npfm.models.bivariate_g import BivariateGProblem, State
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "low-rank-b"
COEFFICIENTS = ("U", "rho_d")
SIGNED = ("U", "V")  # their products alone mean something
RANDOM = True
SETTINGS = {"rank": "products in B (default: 4)"}
RANK = 4  # products in B
RANDOM_STARTS = 2
#: A run has converged when a sweep lowers the objective by less than this share.
TOLERANCE, MAX_SWEEPS = 1e-6, 1000
#: Cells without a sample are held to the value of the nearest one that has, at this share of its
#: weight: a low rank leaves them no value of their own.
HOLD = 1e-2
#: Share of the energy up to which a cell's best B counts as 0.
DARK = 1e-16

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Compressed:
    """Factors of B, shapes (theta_h, rank) and (theta_d, rank), and the state they make."""

    U: Array
    V: Array
    state: State


@dataclass(frozen=True)
class Equations:
    """Sums over phi_d that the factors and rho_d are solved from, in each cell.

    Parameters
    ----------
    wkk, wrk, wk : ndarray, shape (theta_h, theta_d)
        Sums of wK^2, wrK and wK for a scaled B.
    w, wr : float
        Sums of w and wr over everything.
    """

    wkk: Array
    wrk: Array
    wk: Array
    w: float
    wr: float

    def transposed(self) -> "Equations":
        """Return the equations with theta_h and theta_d exchanged."""
        return replace(self, wkk=self.wkk.T, wrk=self.wrk.T, wk=self.wk.T)

    def solved(self, V: Array) -> Array:
        """Best U for a V, together with the rho_d >= 0 that is best for both."""
        rank = V.shape[1]
        pairs = (V[:, :, None] * V[:, None, :]).reshape(len(V), -1)
        right, border = self.wrk @ V, self.wk @ V
        matrices = (self.wkk @ pairs).reshape(-1, rank, rank)
        sides = np.stack([right, border], axis=-1)
        try:
            solved = np.linalg.solve(matrices, sides)
        except np.linalg.LinAlgError:  # a row whose weights leave a direction open: the shortest
            solved = np.linalg.pinv(matrices, hermitian=True) @ sides
        U, change = solved[..., 0], solved[..., 1]
        slope = self.w - np.vdot(border, change)
        rho_d = (self.wr - np.vdot(border, U)) / slope if slope > 1e-12 * self.w else 0.0
        return U - max(rho_d, 0.0) * change


class Compressor:
    """Alternating weighted least squares for the B of one channel.

    Rows and columns are scaled so that the weights of the cells are about equal; the spread of
    wK^2, many decades, would else be that of the equations to solve.

    Parameters
    ----------
    problem : BivariateGProblem
        The fit of the channel.
    free : State
        Its result, whose G is held.
    """

    def __init__(self, problem: BivariateGProblem, free: State):
        self.problem, self.free = problem, free
        sums, seen = free.sums, free.sums.wkk > 0
        weight = np.where(seen, sums.wkk, HOLD * sums.wkk[problem.nearest])
        self.rows, self.columns = np.sqrt(weight.sum(1))[:, None], np.sqrt(weight.sum(0))[:, None]
        self.scale = self.rows * self.columns.T
        self.dark = seen & (sums.wkk * free.B**2 <= DARK * problem.energy)
        fitted = seen & ~self.dark
        self.equations = Equations(
            weight / self.scale**2,
            np.where(fitted, sums.wrk, np.where(seen, 0.0, weight * free.B)) / self.scale,
            np.where(fitted, sums.wk, 0.0) / self.scale,
            sums.w.sum(),
            sums.wr.sum(),
        )

    def starts(self, rank: int, seed: int) -> dict[str, Array]:
        """Return what V is begun with: two singular value decompositions, and random ones."""
        rng = np.random.default_rng(seed)
        named = {
            "weighted-svd": np.linalg.svd(self.free.B * self.scale)[2][:rank].T,
            "svd": np.linalg.svd(self.free.B)[2][:rank].T * self.columns,
        }
        shape = len(self.columns), rank
        random = {f"random-{k + 1}": rng.standard_normal(shape) for k in range(RANDOM_STARTS)}
        return named | random

    def minimise(self, name: str, V: Array, began: float) -> tuple[Compressed, Trace]:
        """Alternate from a start for V, the best constant first; `began` is when time began.

        Where the best B is 0, any negative value is as good. Such cells are drawn to 0 first, and
        those that are negative then released.
        """
        found = self._made(np.zeros((len(self.rows), V.shape[1])), V)
        objectives = [self.problem.objective(found.state)]
        seconds, status = [time.process_time() - began], "converged"
        for released in (False, True):
            decrease = np.inf
            while decrease > TOLERANCE * objectives[-1]:
                if len(objectives) > MAX_SWEEPS:
                    status = "iteration cap"
                    break
                candidate = self._swept(found, released)
                reached = self.problem.objective(candidate.state)
                decrease = objectives[-1] - reached
                if decrease > 0:
                    found = candidate
                    objectives.append(reached)
                    seconds.append(time.process_time() - began)
        energy = self.problem.energy or 1.0
        relative = tuple(objective / energy for objective in objectives)
        return found, Trace(name, status, len(objectives) - 1, 0, tuple(seconds), relative)

    def _swept(self, before: Compressed, released: bool) -> Compressed:
        """Solver for U, then for V."""
        equations = self.equations
        if released:
            negative = equations.wkk * np.minimum(before.U @ before.V.T, 0.0)
            equations = replace(equations, wrk=np.where(self.dark, negative, equations.wrk))
        # Only the span of one factor matters for the other, and an orthonormal basis of it keeps
        # the equations well posed.
        U = np.linalg.qr(equations.solved(np.linalg.qr(before.V)[0]))[0]
        return self._made(U, equations.transposed().solved(U))

    def _made(self, U: Array, V: Array) -> Compressed:
        """Return factors with the state they make, its rho_d the best for it."""
        sums, B = self.free.sums, np.maximum(U @ V.T / self.scale, 0.0)
        rho_d = (sums.wr.sum() - np.vdot(B, sums.wk)) / sums.w.sum()
        return Compressed(U, V, replace(self.free, B=B, rho_d=max(float(rho_d), 0.0)))

    def parameters(self, found: Compressed) -> dict[str, NDArray]:
        """Return what is stored, V scaled to largest magnitude 1."""
        V = found.V / self.columns
        top = np.abs(V).max()
        state = found.state
        return {"U": found.U / self.rows * top, "V": V / top, "G": state.G, "rho_d": state.rho_d}


def parameter_count(grid: HalfDifference, rank: int = RANK) -> int:
    """Number of values stored for a material: U, V, G and rho_d for each channel."""
    return 3 * (rank * (grid.theta_h_bins + grid.theta_d_bins) + G_NODES + 1)


def fit(table: Table, objective: Objective, solve: Solver, seed: int, *, rank: int = RANK) -> Fit:
    """Fit bivariate-g, then compress its B from several starts and keep the best.

    `npfm.models` says what every `fit` takes and raises.

    Parameters
    ----------
    rank : int
        Number of products in B.
    """
    most = min(table.grid.shape[:2])
    if not 1 <= rank <= most:
        raise NpfmError(f"{NAME} of rank {rank}: give a rank from 1 to {most}")

    compiled()

    def fit_channel(samples: Samples, channel: int) -> ChannelFit:
        began = time.process_time()
        problem, free, traces = bivariate_g.fit_samples(samples, solve)
        compressor = Compressor(problem, free)
        runs = [
            compressor.minimise(name, V, began) for name, V in compressor.starts(rank, seed).items()
        ]
        runs.sort(key=lambda run: run[1].objective[-1])
        status = traces[0].status
        return ChannelFit(
            compressor.parameters(runs[0][0]), tuple(_after(trace, status) for _, trace in runs)
        )

    parameters, records = fit_channels(table, objective, fit_channel, COEFFICIENTS)
    return Fit(NAME, parameters, table.grid, records)


def _after(trace: Trace, status: str) -> Trace:
    """Return a trace that says if the fit it started from, of a status, had not converged."""
    return trace if status == "converged" else replace(trace, status=status)


def systems(samples: Samples, p: dict[str, Array]) -> Iterator[Array]:
    """Matrices of the equations for each row of U, then of V, at a fit of one channel."""
    problem, state = bivariate_g.linearised(samples, p)
    compressor = Compressor(problem, state)
    wkk = compressor.equations.wkk
    scaled = (wkk, p["V"] * compressor.columns), (wkk.T, p["U"] * compressor.rows)
    for weight, factor in scaled:
        basis = np.linalg.qr(factor)[0]
        yield from ((basis.T * row) @ basis for row in weight if row.any())


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    channels = [
        tabulate_product(fit.grid, np.maximum(U @ V.T, 0.0), G, rho_d, 1.0)
        for U, V, G, rho_d in zip(p["U"], p["V"], p["G"], p["rho_d"], strict=True)
    ]
    return as_table(channels, fit.grid)
