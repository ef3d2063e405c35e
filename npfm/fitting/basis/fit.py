"""Fit a material in a basis of the factors of others, or lay its own fit into the basis."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.basis.curves import Basis, coefficients, log_factors
from npfm.fitting.basis.library import Library
from npfm.fitting.basis.lobes import FACTORS, Lobes, cells, parameters_of, seen_by
from npfm.fitting.basis.problem import BasisProblem, State
from npfm.fitting.channels import CoupledFit, fit_coupled, shared_traces
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples
from npfm.fitting.shared_lobes.fit import FAINTEST
from npfm.fitting.shared_lobes.isotropic import SharedLobesProblem
from npfm.fitting.shared_lobes.problem import CLAMP, compiled
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance.table import Table

Array = NDArray[np.float64]

#: Parameters that carry the unit of the BRDF.
COEFFICIENTS = ("rho_d", "rho_s")
#: Tolerance, in the solver's: the basis sets an end to what is gained by going on.
EASE = 10.0
#: How many starts: the other materials that come nearest as they are.
NEAREST = 2
#: These are found on about so many bins of phi_d.
COMPARED_BINS = 5
#: Share that what all materials see has in the weights that a fit is laid into a basis by: where a
#: material sees nothing itself, coefficients would go anywhere.
HOLD = 0.01


@dataclass(frozen=True)
class Found:
    """A material in a basis.

    Parameters
    ----------
    lobes : list of Lobes
        Of its channels, coefficients in units of the samples' scale.
    objectives : list of float
        Of each of them: the mean over its channels of the share of the zero model's objective.
    traces : list of list of Trace
        The runs of each, the one that led to it first; none where nothing was fitted.
    """

    lobes: list[Lobes]
    objectives: list[float]
    traces: list[list[Trace]]

    @property
    def objective(self) -> float:
        """Mean over the channels."""
        return float(np.mean(self.objectives))


@dataclass(frozen=True)
class Group:
    """Channels of a material that share their lobes, ready to be fitted in any basis.

    Parameters
    ----------
    free : SharedLobesProblem
        Their fit with free factors.
    thinned : callable
        Gives the same on every n-th bin of phi_d, and keeps it.
    nearest : tuple of int
        Groups of a library that come nearest as they are.
    """

    free: SharedLobesProblem
    thinned: Callable[[int], SharedLobesProblem]
    nearest: tuple[int, ...]


def prepare(samples: Sequence[Samples], library: Library) -> list[Group]:
    """Get a material ready.

    Parameters
    ----------
    samples : sequence of Samples
        Folded measurements of the three channels.
    library : Library
        Of other materials.
    """
    rows = np.hstack([library.logs[name].reshape(len(library.materials), -1) for name in FACTORS])
    groups = []
    for k in range(0, len(samples), library.channels):
        free = SharedLobesProblem(samples[k : k + library.channels], library.lobes, library.spline)
        thinned = cache(free.thinned)
        few = thinned(max(free.weight.shape[2] // COMPARED_BINS, 1))
        reached = [few.objective(few.unpack(row)) for row in rows]
        nearest = np.argsort(reached, kind="stable")[:NEAREST]
        groups.append(Group(free, thinned, tuple(nearest.tolist())))
    return groups


def fit(
    groups: Sequence[Group], library: Library, bases: Mapping[str, Basis], solve: Solver
) -> Found:
    """Fit a material in a basis: the coefficients are the unknowns, and rho_d and rho_s.

    Parameters
    ----------
    groups : sequence of Group
        The material, as `prepare` gives it.
    library : Library
        Of other materials: the starts.
    bases : mapping of str to Basis
        Of D, F and G.
    solve : Solver
        A solver with its settings, which takes `BasisProblem`: Gauss-Newton.
    """
    rows = np.hstack([_packed(bases[name], library.logs[name]) for name in FACTORS])
    found, traces = [], []
    for group in groups:
        problem = _problem(group, bases)
        starts = {f"{library.materials[k]}-{k}": problem.unpack(rows[k]) for k in group.nearest}
        state, runs = solve(problem, starts, ease=EASE)
        found.append(_ended(problem, state))
        traces.append(runs)
    return _found(found, traces)


def fit_table(
    table: Table,
    library: Library,
    count: int,
    objective: Objective,
    solve: Solver,
    tabulate: Callable[[Fit], Table],
) -> Fit:
    """Fit a table in a basis of so many curves of the factors of other materials.

    Parameters
    ----------
    table : Table
        Measured BRDF in 1/sr.
    library : Library
        The factors.
    count : int
        Curves of each of D, F and G.
    objective, solve
        What is minimised, and how (see `fit`).
    tabulate : callable
        That of the library's model.

    Returns
    -------
    Fit
        Of that model, with its record.

    Raises
    ------
    NpfmError
        As `npfm.fitting.channels.fit_coupled`.
    """
    compiled()
    bases = library.bases(count)
    mark = {"spline": np.ones(1)} if library.spline else {}

    def fit_together(samples: Sequence[Samples]) -> CoupledFit:
        found = fit(prepare(samples, library), library, bases, solve)
        shared = len(found.traces) == 1
        traces = shared_traces(found.traces[0]) if shared else found.traces
        return CoupledFit(parameters_of(found.lobes, library.single) | mark, traces)

    return fit_coupled(library.model, table, objective, fit_together, tabulate, COEFFICIENTS)


def project(
    groups: Sequence[Group],
    lobes: Sequence[Lobes],
    library: Library,
    bases: Mapping[str, Basis],
    objective: Objective,
) -> Found:
    """Lay the factors of a fit into a basis, by what samples see of them; rho_d and rho_s are best.

    Parameters
    ----------
    groups, library, bases
        As of `fit`; of the library the form alone.
    lobes : sequence of Lobes
        The fit.
    objective : Objective
        What it was made by.
    """
    at, found = cells(library.grid, objective, library.spline), []
    for group, own in zip(groups, lobes, strict=True):
        problem, seen = _problem(group, bases), seen_by(own, at)
        packed = [
            _laid(bases[name], log_factors(getattr(own, name), CLAMP), getattr(seen, name))
            for name in FACTORS
        ]
        found.append(_ended(problem, problem.unpack(np.concatenate(packed))))
    return _found(found, [[] for _ in found])


def _problem(group: Group, bases: Mapping[str, Basis]) -> BasisProblem:
    D, F, G = (bases[name] for name in FACTORS)
    return BasisProblem(group.free, D, F, G, group.thinned)


def _laid(basis: Basis, logs: Array, seen: Array) -> Array:
    """Coefficients by what samples see, one row after the other; what they do not, counts a bit."""
    total = seen.sum(1, keepdims=True)
    shares = np.divide(seen, total, out=np.zeros_like(seen), where=total > 0)
    return coefficients(basis, logs, shares + HOLD * basis.weights).ravel()


def _packed(basis: Basis, logs: Array) -> Array:
    """Coefficients of the factors of each group, shape (groups, unknowns)."""
    return coefficients(basis, logs.reshape(-1, logs.shape[2])).reshape(len(logs), -1)


def _ended(problem: BasisProblem, state: State) -> tuple[Lobes, float]:
    """Lobes of a state and its objective; a lobe may be all but gone, as in a free fit."""
    state = problem.faintest(state, FAINTEST)
    s = state.lobes
    return Lobes(s.D, s.F, s.G, s.rho_s, s.rho_d), problem.objective(state)


def _found(ends: Sequence[tuple[Lobes, float]], traces: list[list[Trace]]) -> Found:
    return Found([lobes for lobes, _ in ends], [reached for _, reached in ends], traces)
