"""Fits of lobes of a few parameters by `scipy.optimize.least_squares`, from several starts."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares, nnls

from npfm.errors import NpfmError
from npfm.fitting.channels import CoupledFit, fit_coupled, with_end
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples
from npfm.fitting.parametric.author_metrics import Goal, Metric
from npfm.fitting.parametric.lobes import NORMAL, Directions, Form, Model, at_cells, tabulate
from npfm.fitting.solvers.problem import NEGLIGIBLE, Solver
from npfm.reflectance.table import CHANNELS, Table

COEFFICIENTS = ("rho_d", "rho_s")
#: About so many samples are kept for the comparison of starts.
COARSE = 3_000
FINE_EVALUATIONS, COARSE_EVALUATIONS = 300, 20
TOLERANCE = 1e-5  # smallest share by which an iteration must lower the sum, or move the unknowns
GOLDEN_RATIO = (1 + 5**0.5) / 2
STEP = 1e-7  # of the differences that the derivatives of a lobe are taken from


def fit(name: str, form: Form, metric: Metric, table: Table, objective: Objective) -> Fit:
    """Fit a form to a table from each of its starts.

    The starts are compared on some of the samples, the best goes on to more of them, and where the
    metric is a sum of squares the coefficients of its shape are those that are best on all.
    Records tell the objective of the 2016 paper; the traces of the other starts tell that of the
    metric, as a share of the zero model's.

    Parameters
    ----------
    name : str
        Of the model.
    form : Form
        What is fitted.
    metric : Metric
        What is minimised.
    table : Table
        Measured BRDF in 1/sr.
    objective : Objective
        Which samples count, and what the record tells.

    Raises
    ------
    NpfmError
        If a channel has no sample that counts, or none within the angles of the metric.
    """

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        groups = [samples] if form.shared else [[channel] for channel in samples]
        goals = [metric(group) for group in groups]
        _check_samples(name, goals)
        found = [
            _fit_together(form, goal, group) for goal, group in zip(goals, groups, strict=True)
        ]
        parameters = {key: np.concatenate([part[key] for part, _ in found]) for key in found[0][0]}
        return CoupledFit(parameters, [runs for _, runs in found] * (len(CHANNELS) // len(found)))

    # Not folded: the metrics of other authors weight light and view differently.
    fit = fit_coupled(
        name, table, objective, fit_together, partial(tabulate, form), COEFFICIENTS, False
    )
    return replace(fit, records=tuple(with_end(record) for record in fit.records))


@dataclass(frozen=True)
class Fitted(Model):
    """A model of one lobe that is fitted so.

    Parameters
    ----------
    metric : callable
        What is minimised.
    """

    metric: Metric

    def fit(self, table: Table, objective: Objective, solve: Solver, seed: int) -> Fit:
        """Fit the model; `solve` and `seed` are not needed. See `fit` of this module."""
        return fit(self.name, self.form, self.metric, table, objective)


def _check_samples(name: str, goals: Sequence[Goal]) -> None:
    counts = np.concatenate([_any(goal.weight > 0) for goal in goals])
    for channel, there in zip(CHANNELS, counts, strict=True):
        if not there:
            raise NpfmError(
                f"the {channel} channel has no sample within the angles that {name} is fitted to; "
                "fit another model"
            )


def _any(there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether something is there in each channel."""
    return np.asarray(there.reshape(len(there), -1).any(1))


@dataclass(frozen=True)
class _End:
    """Where a run of scipy's solver ended: the unknowns, and half the sum of squares there."""

    x: NDArray
    cost: float
    evaluations: int
    converged: bool


@dataclass(frozen=True)
class _Problem:
    """The samples that a group of channels is fitted to, as flat arrays, first axis the channel.

    The unknowns are rho_d and rho_s of each channel, rho_s times the lobe at normal incidence,
    and then the vector of the shape.
    """

    form: Form
    goal: Goal
    cells: NDArray[np.int64]

    @cached_property
    def directions(self) -> Directions:
        return at_cells(self.goal.grid, self.cells)

    @cached_property
    def root_weight(self) -> NDArray:
        return np.sqrt(self.goal.weight.reshape(len(self.goal.scale), -1)[:, self.cells])

    @cached_property
    def value(self) -> NDArray:
        return self.goal.value.reshape(len(self.goal.scale), -1)[:, self.cells]

    @cached_property
    def zero_cost(self) -> float:
        """Cost of the zero model."""
        return float(np.sum((self.root_weight * self._transformed(self.value)) ** 2)) or 1.0

    def _transformed(self, x: NDArray) -> NDArray:
        return np.log1p(self.directions.cos_i * x) if self.goal.logarithmic else x

    def _slope(self, x: NDArray) -> NDArray:
        cosine = self.directions.cos_i
        return cosine / (1 + cosine * x) if self.goal.logarithmic else np.ones_like(x)

    def _lobe(self, vector: NDArray) -> NDArray:
        shape = self.form.shape(vector)
        return self.form.lobe(shape, self.directions) / self.form.lobe(shape, NORMAL)

    def _parts(self, x: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Rho_d and rho_s as columns, the vector of the shape, and the lobe."""
        coefficients = 2 * len(self.goal.scale)
        rho_d, rho_s = x[:coefficients].reshape(2, -1, 1)
        return rho_d, rho_s, x[coefficients:], self._lobe(x[coefficients:])

    def _residuals(self, x: NDArray) -> NDArray:
        rho_d, rho_s, _, lobe = self._parts(x)
        difference = self._transformed(rho_d + rho_s * lobe) - self._transformed(self.value)
        return (self.root_weight * difference).ravel()

    def _jacobian(self, x: NDArray) -> NDArray:
        """Derivatives: exact ones times differences of the lobe alone."""
        rho_d, rho_s, vector, lobe = self._parts(x)
        slope = self.root_weight * self._slope(rho_d + rho_s * lobe)
        channels = len(slope)
        jacobian = np.zeros((x.size, *slope.shape))
        for channel in range(channels):
            jacobian[channel, channel] = slope[channel]
            jacobian[channels + channel, channel] = slope[channel] * lobe
        for k, value in enumerate(vector):
            moved = vector.copy()
            moved[k] = value + STEP * max(1.0, abs(value))
            change = (self._lobe(moved) - lobe) / (moved[k] - value)
            jacobian[2 * channels + k] = slope * rho_s * change
        return jacobian.reshape(x.size, -1).T

    def start(self, vector: ArrayLike) -> NDArray:
        """Return the unknowns with the coefficients that are best for a shape.

        To first order in the difference if the goal is logarithmic.
        """
        lobe = self._lobe(np.array(vector))
        weight = self.root_weight * self._slope(self.value)
        best = [
            nnls(np.stack([w, w * lobe], axis=-1), w * value)[0]
            for w, value in zip(weight, self.value, strict=True)
        ]
        return np.concatenate([*np.transpose(best), vector])

    def minimise(self, start: NDArray, evaluations: int) -> _End:
        """Run scipy's solver from a start, unless nothing is left to gain."""
        below, above = self.form.bounds
        free = 2 * len(self.goal.scale)
        bounds = np.r_[np.zeros(free), below], np.r_[np.full(free, np.inf), above]
        cost = float(np.sum(self._residuals(start) ** 2)) / 2
        if cost < NEGLIGIBLE * self.zero_cost:
            return _End(start, cost, 1, True)
        # Where a lobe is black its shape has no effect, and scipy divides 0 by 0.
        with np.errstate(divide="ignore", invalid="ignore"):
            found = least_squares(
                self._residuals,
                start,
                self._jacobian,
                bounds,
                x_scale="jac",
                ftol=TOLERANCE,
                xtol=TOLERANCE,
                gtol=None,
                max_nfev=evaluations,
            )
        return _End(found.x, float(found.cost), int(found.nfev), bool(found.status > 0))


def _fit_together(
    form: Form, goal: Goal, samples: Sequence[Samples]
) -> tuple[dict[str, NDArray], list[Trace]]:
    """Fit channels that share a shape; the traces' seconds are those of one channel."""
    coarse, fine = (_Problem(form, goal, thinned(goal, count)) for count in (COARSE, form.samples))
    results, traces = {}, {}
    for name, vector in form.starts.items():
        began = time.process_time()
        results[name] = coarse.minimise(coarse.start(vector), COARSE_EVALUATIONS)
        traces[name] = _trace(name, coarse, [results[name]], began)
    best = min(results, key=lambda name: results[name].cost)
    began = time.process_time() - traces[best].seconds[-1] * len(goal.scale)
    shape = results[best].x[2 * len(goal.scale) :]
    final = fine.minimise(fine.start(shape), FINE_EVALUATIONS)
    runs = [_trace(best, fine, [results[best], final], began)]
    runs += [trace for name, trace in traces.items() if name != best]
    whole = _Problem(form, goal, thinned(goal, goal.grid.size))
    # Of a logarithm they are not the solution of a linear problem, and stay what the search found.
    x = final.x if goal.logarithmic else whole.start(final.x[2 * len(goal.scale) :])
    return _parameters(whole, x, samples), runs


def _trace(name: str, problem: _Problem, results: Sequence[_End], began: float) -> Trace:
    status = "converged" if results[-1].converged else "iteration cap"
    seconds = (time.process_time() - began) / len(problem.goal.scale)
    share = 2 * results[-1].cost / problem.zero_cost
    iterations = sum(result.evaluations for result in results)
    return Trace(name, status, iterations, 0, (seconds,), (share,))


def thinned(goal: Goal, count: int) -> NDArray[np.int64]:
    """Flat indices of about so many samples; of all, if some channel would be left with none.

    Every n-th bin of the last angle in each row of the others, n being any number, and from row to
    row later by the golden ratio of n. So every bin of every angle has its share.
    """
    counts = (goal.weight > 0).reshape(len(goal.scale), -1)
    every = np.flatnonzero(counts.any(0))
    share = min(1.0, count / max(1, every.size))
    row, last = np.divmod(every, goal.grid.shape[-1])
    kept = every[(last * share + row * GOLDEN_RATIO) % 1 < share]
    return kept if counts[:, kept].any(1).all() else every


def _parameters(problem: _Problem, x: NDArray, samples: Sequence[Samples]) -> dict[str, NDArray]:
    """Parameters in units of the samples; coefficients that only rounding keeps from 0 are 0."""
    rho_d, rho_s, vector, _ = problem._parts(x)
    shape = problem.form.shape(vector)
    scale = problem.goal.scale / [channel.scale for channel in samples]
    peak = problem.form.lobe(shape, NORMAL)
    coefficients = {"rho_d": rho_d[:, 0] * scale, "rho_s": rho_s[:, 0] * scale / peak}
    black = ~_any(problem.goal.value > 0)
    coefficients = {name: np.where(black, 0.0, value) for name, value in coefficients.items()}
    return coefficients | {name: np.array([value]) for name, value in shape.items()}
