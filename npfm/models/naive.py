"""The naive model rho = rho_d + rho_s D(theta_h) F(theta_d) H(phi_d) (Bagher et al. 2016, eq. 4).

H is not symmetric under exchange of light and view, so samples are not folded.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.channels import ChannelFit, as_table, fit_channels
from npfm.fitting.factors.problem import FactorProblem, State, Sums, quotient, updated_D, updated_F
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, Samples
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

NAME = "naive"
COEFFICIENTS = ("rho_d", "rho_s")
RECIPROCAL = False
CLAMP = 1e-6  # smallest component of a factor (section 4.3, "Dynamic range clamping")
FREEDOMS = 2  # scalings of the factors that leave the model as it is


class NaiveProblem(FactorProblem):
    """The fit of one channel, on samples that are not folded; K is H."""

    def __init__(self, samples: Samples):
        super().__init__(samples, CLAMP)
        self.weight = samples.weight.reshape(-1, samples.grid.phi_d_bins)
        self.weighted_value = self.weight * samples.value.reshape(self.weight.shape)
        self._wrr = float(np.vdot(self.weighted_value, samples.value))
        flat = np.ones(samples.grid.phi_d_bins)
        self._fixed = self._plane(self.weight @ flat), self._plane(self.weighted_value @ flat)

    def _plane(self, sums: NDArray) -> NDArray:
        return sums.reshape(self.samples.grid.shape[:2])

    def thinned(self, every: int) -> "NaiveProblem":
        """Return the fit as it is: H needs every bin of phi_d."""
        return self

    @cached_property
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, F and H any sample depends on."""
        weight = self._fixed[0]
        return weight.sum(1) > 0, weight.sum(0) > 0, self.weight.sum(0) > 0

    def sums(self, modulation: NDArray) -> Sums:
        """Sums over phi_d for a factor H, shape (phi_d_bins,)."""
        sums = (
            self.weight @ modulation,
            self.weight @ modulation**2,
            self.weighted_value @ modulation,
        )
        wk, wkk, wrk = (self._plane(x) for x in sums)
        return Sums(*self._fixed, wk, wkk, wrk, self._wrr)

    def normal_equations(self, state: State) -> tuple[NDArray, NDArray]:
        """Gradient and Gauss-Newton matrix in the logarithms of D, F and H, then rho_d.

        With x = rho_s D F H, every entry is a sum of w x^2, w x (model - value) or w x over the
        samples of two bins, and x is a product: so each is a matrix product.
        """
        f, s = state.factors, state.sums
        nh, nd, nphi = self.samples.grid.shape
        x = f.rho_s * state.product
        hd = x**2 * s.wkk
        residual = x**2 * s.wkk + x * (f.rho_d * s.wk - s.wrk)
        cube = self.weight.reshape(nh, nd, nphi)
        hp = (f.rho_s * f.D[:, None] * f.modulation) ** 2 * np.matmul(f.F**2, cube)
        dp = (f.rho_s * f.F[:, None] * f.modulation) ** 2 * (
            f.D**2 @ self.weight.reshape(nh, -1)
        ).reshape(nd, nphi)
        linear = x.ravel() @ self.weight * f.modulation
        pull = x.ravel() @ self.weighted_value * f.modulation
        wx = x * s.wk
        sum_wr = f.rho_d * s.w.sum() + wx.sum() - s.wr.sum()
        gradient = np.concatenate(
            [residual.sum(1), residual.sum(0), hp.sum(0) + f.rho_d * linear - pull, [sum_wr]]
        )
        column = np.concatenate([wx.sum(1), wx.sum(0), linear])[:, None]
        matrix = np.block(
            [
                [np.diag(hd.sum(1)), hd, hp],
                [hd.T, np.diag(hd.sum(0)), dp],
                [hp.T, dp.T, np.diag(hp.sum(0))],
            ]
        )
        matrix = np.block([[matrix, column], [column.T, s.w.sum()]])
        return self.bounded(gradient, matrix, f.rho_d)

    @property
    def stages(self) -> tuple[tuple[Callable[[State], State], ...]]:
        """One stage: D, F, H, each followed by the coefficients."""
        return (
            (
                lambda state: updated_D(state, CLAMP),
                lambda state: updated_F(state, CLAMP),
                State.with_coefficients,
                self._updated_H,
                State.with_coefficients,
            ),
        )

    def _updated_H(self, state: State) -> State:
        f, product = state.factors, state.product.ravel()
        numerator = product @ self.weighted_value - f.rho_d * (product @ self.weight)
        H = quotient(numerator, f.rho_s * (product**2 @ self.weight), f.modulation, CLAMP)
        return State(replace(f, modulation=H), self.sums(H))


def parameter_count(grid: HalfDifference) -> int:
    """Number of values stored for a material: D, F, H, rho_d and rho_s for each channel."""
    return 3 * (sum(grid.shape) + 2)


def fit(table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
    """Fit the naive model from a start of ones, in a single run as in the paper.

    `npfm.models` says what every `fit` takes and raises.
    """

    def fit_channel(samples: Samples, channel: int) -> ChannelFit:
        problem = NaiveProblem(samples)
        ones = problem.state(*(np.ones(bins) for bins in table.grid.shape))
        state, traces = solve(problem, {"ones": ones})
        f = state.factors
        return ChannelFit(
            {"D": f.D, "F": f.F, "H": f.modulation, "rho_d": f.rho_d, "rho_s": f.rho_s},
            tuple(traces),
        )

    parameters, records = fit_channels(table, objective, fit_channel, COEFFICIENTS, RECIPROCAL)
    return Fit(NAME, parameters, table.grid, records)


def linearised(samples: Samples, p: dict[str, NDArray]) -> tuple[NaiveProblem, State]:
    """Return the problem of a channel, its samples not folded yet, and the state of a fit."""
    problem = NaiveProblem(samples)
    return problem, problem.state(p["D"], p["F"], p["H"])


def tabulate(fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    product = np.einsum("ch,cd,cp->chdp", p["D"] * p["rho_s"][:, None], p["F"], p["H"])
    return as_table(list(p["rho_d"][:, None, None, None] + product), fit.grid)
