"""Fits of a diffuse part and several lobes of one form, by one of two criteria.

Lobes that are fitted to be sampled: what is compared is the reflected light, cos(theta_i) rho, and
each pair of directions counts as often as it is seen, cos(theta_o) times both solid angles. In
Lawrence et al. 2004 such lobes are "fitted by a standard non-linear optimizer", that is by least
squares, which cares for the brightest samples only; the divergence of their own factorisation
(equation 17) cares for relative differences.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls

from npfm.errors import NpfmError
from npfm.fitting.channels import CoupledFit, as_table, fit_coupled, shared_traces, with_end
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples, solid_angles
from npfm.fitting.parametric.author_metrics import Goal
from npfm.fitting.parametric.lobe_fits import thinned
from npfm.fitting.parametric.lobes import Directions, Form
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, Table

Array = NDArray[np.float64]

COEFFICIENTS = ("rho_d", "rho_s")
#: What is minimised: the sum of squares, or the divergence.
CRITERIA = ("least-squares", "kullback-leibler")
MOST_LOBES = 4
#: Share of its peak that a lobe has to show at a sample, or it does not count.
UNSEEN = 1e-2
#: About so many samples are kept for the comparison of starts.
COARSE, COARSE_EVALUATIONS, FINE_EVALUATIONS = 3_000, 12, 60
TOLERANCE = 1e-6  # smallest share by which an iteration must lower the criterion
#: Rounds that find the coefficients of given lobes by the divergence, and their smallest change.
ROUNDS, SETTLED = 500, 1e-7
#: A model of no more than this share of the mean counts as so much, where a logarithm is taken.
LEAST = 1e-9


@dataclass(frozen=True)
class _Seen:
    """The samples of one channel, or of the mean of all, as flat arrays.

    Parameters
    ----------
    at : Directions
    weight : ndarray
        Of the squared differences, or of the divergence, of `value`.
    value : ndarray
        BRDF in units of their weighted mean.
    unit : float
        That mean in 1/sr.
    divergence : bool
        Whether the criterion is the divergence.
    """

    at: Directions
    weight: Array
    value: Array
    unit: float
    divergence: bool

    @cached_property
    def root(self) -> Array:
        return np.sqrt(self.weight)

    def residuals(self, model: Array) -> Array:
        """Numbers whose squares add up to the criterion (twice the divergence)."""
        if not self.divergence:
            return self.root * (model - self.value)
        model = np.maximum(model, LEAST)
        ratio = np.where(self.value > 0, self.value, 1) / model
        excess = np.where(self.value > 0, self.value * np.log(ratio), 0) - self.value + model
        return np.sign(model - self.value) * self.root * np.sqrt(2 * np.maximum(excess, 0))

    def coefficients(self, lobes: Array) -> Array:
        """Best coefficients (1 + L,) of a diffuse part and lobes (L, samples)."""
        # A lobe too narrow for any sample would have a coefficient beyond all bounds.
        seen = lobes.max(axis=1, keepdims=True, initial=0) > UNSEEN
        columns = np.concatenate([np.ones((1, lobes.shape[1])), np.where(seen, lobes, 0)])
        if not self.divergence:
            return nnls((columns * self.root).T, self.root * self.value)[0]
        return _least_divergence(columns, self.value, self.weight)


def _least_divergence(columns: Array, value: Array, weight: Array) -> Array:
    """Coefficients of columns (n, samples): the updates of equation 15 with the columns given."""
    reached = columns @ weight
    wanted = weight * value
    share = np.where(reached > 0, wanted.sum() / np.maximum(reached, LEAST), 0) / len(columns)
    for _ in range(ROUNDS):
        before = share
        model = share @ columns
        ratio = np.where(wanted > 0, wanted / np.where(model > 0, model, 1), 0)
        share = share * (columns @ ratio) / np.where(reached > 0, reached, 1)
        if np.abs(share - before).max() <= SETTLED * share.max():
            break
    return share


@dataclass(frozen=True)
class _Problem:
    """Some samples, and the form of the lobes that they are fitted by.

    The unknowns are the coefficients of the diffuse part and of each lobe, then the vector of the
    shape of each lobe.
    """

    form: Form
    seen: _Seen

    def lobes(self, shapes: Array) -> Array:
        """Values (L, samples) of lobes with vectors `shapes` (L, s)."""
        return np.stack([self.form.lobe(self.form.shape(x), self.seen.at) for x in shapes])

    def start(self, shapes: Array) -> Array:
        """Unknowns with the coefficients that are best for some shapes."""
        return np.concatenate([self.seen.coefficients(self.lobes(shapes)), shapes.ravel()])

    def split(self, x: Array) -> tuple[Array, Array]:
        """Coefficients (1 + L,) and shapes (L, s) of unknowns."""
        sizes = len(self.form.bounds[0])
        count = (x.size - 1) // (1 + sizes)
        return x[: 1 + count], x[1 + count :].reshape(count, sizes)

    def residuals(self, x: Array) -> Array:
        """Those of the criterion."""
        coefficients, shapes = self.split(x)
        model = coefficients[0] + coefficients[1:] @ self.lobes(shapes)
        return self.seen.residuals(model)

    def cost(self, x: Array) -> float:
        """Half the sum of the squares."""
        return float(np.sum(self.residuals(x) ** 2)) / 2

    def minimised(self, shapes: Array, evaluations: int) -> tuple[Array, int, bool]:
        """Unknowns that are best from some shapes on, what it took, and whether it converged."""
        start, count = self.start(shapes), len(shapes)
        below, above = (np.tile(bound, count) for bound in self.form.bounds)
        bounds = np.r_[np.zeros(1 + count), below], np.r_[np.full(1 + count, np.inf), above]
        if self.cost(start) <= TOLERANCE**2 * self.cost(0 * start):
            return start, 1, True
        found = least_squares(
            self.residuals,
            np.clip(start, *bounds),
            bounds=bounds,
            x_scale="jac",
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=None,
            max_nfev=evaluations,
        )
        # Coefficients at a bound stay within it by a little: the best for the shapes may be on it.
        end = self.start(self.split(found.x)[1])
        best = end if self.cost(end) <= found.cost else found.x
        return best, int(found.nfev), bool(found.status > 0)


def fit(
    name: str, form: Form, lobes: int, criterion: str, table: Table, objective: Objective
) -> Fit:
    """Fit a diffuse part and lobes of one form, whose shapes the channels share.

    Lobes are added one by one, each from the best of the form's starts, and all are searched again
    together. The shapes are those of the mean of the channels, the coefficients of each channel
    then the best for them.

    Parameters
    ----------
    name : str
        Of the model.
    form : Form
        Of each lobe.
    lobes : int
        How many.
    criterion : str
        ``least-squares`` or ``kullback-leibler``.
    table : Table
        Measured BRDF in 1/sr.
    objective : Objective
        Which samples count, and what the record tells.

    Returns
    -------
    Fit
        rho_d of shape (3,), rho_s (3, L) and the parameters of the shape (1, L).

    Raises
    ------
    NpfmError
        If the number of lobes is not from 1 to `MOST_LOBES`, or no sample of a channel counts.
    """
    if not 1 <= lobes <= MOST_LOBES:
        raise NpfmError(f"{name} of {lobes} lobes: give a number from 1 to {MOST_LOBES}")

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        began = time.process_time()
        divergence = criterion == CRITERIA[1]
        scale = np.array([channel.scale for channel in samples])
        value = np.stack([channel.value for channel in samples]) * scale[:, None, None, None]
        counts = np.stack([channel.weight > 0 for channel in samples])
        common = counts.sum(axis=0) == counts.sum(axis=0).max()
        mean = np.where(counts, value, 0).sum(axis=0) / counts.sum(axis=0).max()
        coarse, fine = (
            _Problem(form, _seen(mean, common, samples[0].grid, count, divergence))
            for count in (COARSE, form.samples)
        )
        shapes, started, evaluations = _shapes(coarse, lobes)
        x, more, converged = fine.minimised(shapes, FINE_EVALUATIONS)
        shapes = fine.split(x)[1]
        shapes = shapes[np.argsort(shapes[:, 0], kind="stable")]
        found = []
        for channel, there in zip(value, counts, strict=True):
            seen = _seen(channel, there, samples[0].grid, form.samples, divergence)
            found.append(seen.unit * seen.coefficients(_Problem(form, seen).lobes(shapes)))
        coefficients = np.stack(found) / scale[:, None]
        named = [form.shape(shape) for shape in shapes]
        parameters = {"rho_d": coefficients[:, 0], "rho_s": coefficients[:, 1:]}
        parameters |= {key: np.array([[shape[key] for shape in named]]) for key in named[0]}
        status = "converged" if converged else "iteration cap"
        seconds = (time.process_time() - began,)
        trace = Trace(started, status, evaluations + more, 0, seconds, (1.0,))
        return CoupledFit(parameters, shared_traces([trace]))

    table_of = partial(tabulate, form)
    fit = fit_coupled(name, table, objective, fit_together, table_of, COEFFICIENTS, False)
    return replace(fit, records=tuple(with_end(record) for record in fit.records))


def _seen(
    value: Array, counts: NDArray[np.bool_], grid: HalfDifference, number: int, divergence: bool
) -> _Seen:
    """About so many samples of values (grid.shape), where they count."""
    cos_i, cos_o = grid.cosines
    light = cos_i if divergence else cos_i**2
    weight = np.where(counts, solid_angles(grid) * light * cos_o, 0.0)
    every = Goal(weight[None], value[None], np.ones(1), False, grid)
    cells = thinned(every, number)
    angles = (grid.theta_h[:, None, None], grid.theta_d[:, None], cos_i, cos_o)
    at = Directions(*(np.broadcast_to(angle, grid.shape).flat[cells] for angle in angles))
    weight, value = weight.flat[cells], value.flat[cells]
    unit = float(np.average(value, weights=weight)) or 1.0
    return _Seen(at, weight / weight.sum(), value / unit, unit, divergence)


def _shapes(coarse: _Problem, lobes: int) -> tuple[Array, str, int]:
    """Vectors of the shapes of lobes (L, s), the names of their starts, and evaluations."""
    shapes = np.empty((0, len(coarse.form.bounds[0])))
    names, evaluations = [], 0
    for _ in range(lobes):
        runs = {}
        for name, vector in coarse.form.starts.items():
            x, count, _ = coarse.minimised(np.vstack([shapes, vector]), COARSE_EVALUATIONS)
            runs[name] = x
            evaluations += count
        best = min(runs, key=lambda name: coarse.cost(runs[name]))
        names.append(best)
        shapes = coarse.split(runs[best])[1]
    return shapes, ", ".join(names), evaluations


def reflectance(form: Form, fit: Fit, light: Array, view: Array) -> Array:
    """BRDF (3, q) in 1/sr of a fit at pairs of directions (q, 3) above the horizon, normal z."""
    half = light + view
    length = np.linalg.norm(half, axis=1)
    theta_h, theta_d = (np.arccos(np.clip(x, 0, 1)) for x in (half[:, 2] / length, length / 2))
    return _values(form, fit, Directions(theta_h, theta_d, light[:, 2], view[:, 2]))


def _values(form: Form, fit: Fit, at: Directions) -> Array:
    """BRDF (3,) + the shape of the directions, in 1/sr."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    rho_d, rho_s = p.pop("rho_d"), p.pop("rho_s")
    lobes = np.stack(
        [form.lobe({name: x[0, k] for name, x in p.items()}, at) for k in range(rho_s.shape[1])]
    )
    return np.stack([d + np.tensordot(s, lobes, 1) for d, s in zip(rho_d, rho_s, strict=True)])


def parameter_count(form: Form, lobes: int) -> int:
    """Number of values stored for a material."""
    return len(CHANNELS) * (1 + lobes) + lobes * len(form.shape(np.array(form.bounds[0])))


def tabulate(form: Form, fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    grid = fit.grid
    half = grid.phi_d_bins // 2
    cosines = (np.where(grid.above_horizon, c, 1.0)[..., :half] for c in grid.cosines)
    at = Directions(grid.theta_h[:, None, None], grid.theta_d[:, None], *cosines)
    values = _values(form, fit, at)
    # Computed once for both halves of phi_d: exactly reciprocal.
    return as_table([np.concatenate([v, v[..., ::-1]], axis=-1) for v in values], grid)


@dataclass(frozen=True)
class Model:
    """A model of several lobes of one form, as its file has it.

    Parameters
    ----------
    name : str
        Of the model.
    form : Form
        Of each lobe.
    lobes : int
        How many, if nothing is said.
    """

    name: str
    form: Form
    lobes: int

    def parameter_count(self, grid: HalfDifference, lobes: int | None = None) -> int:
        """Number of values stored for a material, on whatever grid."""
        return parameter_count(self.form, self.lobes if lobes is None else lobes)

    def fit(
        self,
        table: Table,
        objective: Objective,
        solve: Solver,
        seed: int,
        *,
        lobes: int | None = None,
        criterion: str = "kullback-leibler",
    ) -> Fit:
        """Fit the lobes; `solve` and `seed` are not needed, the starts are the same each time.

        `npfm.models` says what every `fit` takes and raises.

        Parameters
        ----------
        lobes : int
            How many.
        criterion : str
            What is minimised: ``kullback-leibler`` or ``least-squares``.
        """
        count = self.lobes if lobes is None else lobes
        return fit(self.name, self.form, count, criterion, table, objective)

    def tabulate(self, fit: Fit) -> Table:
        """Values of a fit at every cell of its grid, in 1/sr."""
        return tabulate(self.form, fit)
