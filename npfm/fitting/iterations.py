"""D, G and F of every start of a microfacet fit, iteration by iteration.

What the supplemental video of Bagher et al. 2016 shows of their fits (section 6): how the curves
converge from several starts. A solver tells what it has reached; that changes nothing in a fit.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.factors.microfacet import G_NODES, G_THETA, MicrofacetProblem
from npfm.fitting.factors.problem import Factors
from npfm.fitting.fits import ITERATIONS, Fit, Trace
from npfm.fitting.solvers.problem import Problem, S, Solver
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS
from npfm.storage.archives import read_arrays
from npfm.storage.files import replacing

FORMAT = "npfm-iterations-1"
FACTORS = ("D", "G", "F")
#: What is kept of a state: its start, the iteration, the objective and the factors.
Step = tuple[str, int, float, Factors]
#: No record has so many bytes: a thousand iterations of each of eight starts have 26 million.
MOST_BYTES = 2**28
AGAIN = "make it again with npfm fit --iterations"


@dataclass(frozen=True)
class Iterations:
    """Every state that the runs of a fit went through, in their order.

    Parameters
    ----------
    names : tuple of str
        Of the starts.
    channel, start : ndarray of int, shape (n,)
        Of each state: the colour channel, and which of the names.
    run : ndarray of int, shape (n,)
        0 for the run from the start; 1 for the one that goes on where it ended, for the best of
        the starts, which solvers compare on some of the samples first.
    objective : ndarray, shape (n,)
        As a share of that of the zero model, over the samples of the run.
    D, G, F : ndarray, shapes (n, theta_h), (n, G_NODES) and (n, theta_d)
        Each with its largest component at 1.
    """

    names: tuple[str, ...]
    channel: NDArray[np.integer]
    start: NDArray[np.integer]
    run: NDArray[np.integer]
    objective: NDArray[np.floating]
    D: NDArray[np.floating]
    G: NDArray[np.floating]
    F: NDArray[np.floating]

    def best(self, channel: int) -> int:
        """Which start led to the fit: that which went on, or else ended lowest."""
        ends = {
            int(self.start[k]): (-int(self.run[k]), float(self.objective[k]))
            for k in np.flatnonzero(self.channel == channel)
        }
        return min(ends, key=ends.__getitem__)

    @property
    def angles(self) -> dict[str, NDArray[np.float64]]:
        """Where the components of D, G and F are, in degrees."""
        grid = HalfDifference(self.D.shape[1], self.F.shape[1], 2)
        return {
            name: np.degrees(radians)
            for name, radians in zip(FACTORS, (grid.theta_h, G_THETA, grid.theta_d), strict=True)
        }


class Recorder:
    """A solver that keeps the factors of every state, beside what it returns.

    Parameters
    ----------
    solve : Solver
        What minimises.
    """

    def __init__(self, solve: Solver):
        self.solve = solve
        self.calls: list[tuple[Trace, list[Step]]] = []

    def __call__(
        self, problem: Problem[S], starts: Mapping[str, S], *, ease: float = 1.0
    ) -> tuple[S, list[Trace]]:
        """Minimise, and keep the factors.

        Raises
        ------
        NpfmError
            If the problem is not that of a channel with factors D, G and F.
        """
        if not isinstance(problem, MicrofacetProblem):
            raise NpfmError(
                "this model has no D, G and F of each channel to follow; leave --iterations out"
            )
        steps: list[Step] = []

        def keep(start: str, iteration: int, objective: float, state: Any) -> None:
            # Not the state, which has sums over all samples.
            steps.append((start, iteration, objective, state.factors))

        state, traces = self.solve(problem, starts, ease=ease, follow=keep)
        self.calls.append((traces[0], steps))
        return state, traces

    def save(self, path: str | Path, fit: Fit) -> None:
        """Write what led to a fit."""
        save(path, self.iterations(fit))

    def iterations(self, fit: Fit) -> Iterations:
        """Return what led to a fit: not the fits that were only made for a start of it."""
        # The record of a channel has the very traces that one call returned.
        found = [
            (channel, *step)
            for channel, record in enumerate(fit.records)
            for trace, steps in self.calls
            if trace is record.traces[0]
            for step in steps
        ]
        return _gathered(found)


def _gathered(steps: Sequence[tuple[int, str, int, float, Factors]]) -> Iterations:
    channels, starts, numbers, objectives, factors = zip(*steps, strict=True)
    names = tuple(dict.fromkeys(starts))
    begun = Counter[tuple[int, str]]()
    runs = []
    for run, number in zip(zip(channels, starts, strict=True), numbers, strict=True):
        begun[run] += number == 0
        runs.append(begun[run] - 1)
    return Iterations(
        names,
        np.array(channels),
        np.array([names.index(start) for start in starts]),
        np.array(runs),
        np.array(objectives),
        np.stack([f.D / f.D.max() for f in factors]),
        np.stack([f.modulation / f.modulation.max() for f in factors]),
        np.stack([f.F / f.F.max() for f in factors]),
    )


def save(path: str | Path, iterations: Iterations) -> None:
    """Write a record of iterations (``.npz``, float32)."""
    arrays: dict[str, Any] = {"iterations": np.array(FORMAT), "names": np.array(iterations.names)}
    for name in ("channel", "start", "run"):
        arrays[name] = getattr(iterations, name).astype(np.int16)
    for name in ("objective", *FACTORS):
        arrays[name] = getattr(iterations, name).astype(np.float32)
    with replacing(path, ITERATIONS) as temporary:
        np.savez_compressed(temporary, **arrays)


def load(path: str | Path) -> Iterations:
    """Read what `save` wrote.

    Raises
    ------
    NpfmError
        If the file is absent or damaged, or is no such record.
    """
    arrays = read_arrays(path, "a record of iterations", AGAIN, MOST_BYTES)
    if str(arrays.pop("iterations", "")) != FORMAT:
        raise NpfmError(f"{path}: not a record of format {FORMAT}; {AGAIN}")
    try:
        names = tuple(map(str, arrays.pop("names")))
        found = Iterations(names, **{f.name: arrays[f.name] for f in fields(Iterations)[1:]})
        _check(found)
    except (LookupError, ValueError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise NpfmError(f"{path}: no record of iterations ({reason}); {AGAIN}") from error
    return found


def _check(found: Iterations) -> None:
    """Refuse arrays that do not belong together.

    Raises
    ------
    ValueError
        Saying why.
    """
    states = found.objective.size
    for name, most in (("channel", len(CHANNELS)), ("start", len(found.names)), ("run", 2)):
        numbers = getattr(found, name)
        if numbers.dtype.kind != "i" or numbers.shape != (states,):
            raise ValueError(f"{name} is of shape {numbers.shape} and type {numbers.dtype}")
        if states == 0 or numbers.min() < 0 or numbers.max() >= most:
            raise ValueError(f"{name} is not from 0 to {most - 1}")
    there = len(set(zip(found.channel.tolist(), found.start.tolist(), strict=True)))
    if there < len(CHANNELS) * len(found.names):
        raise ValueError("a start is missing in one of the channels")
    for name in FACTORS:
        values = getattr(found, name)
        if values.dtype.kind != "f" or values.ndim != 2 or len(values) != states:
            raise ValueError(f"{name} is of shape {values.shape} and type {values.dtype}")
        if values.size == 0 or not np.isfinite(values).all() or values.min() < 0:
            raise ValueError(f"{name} has values that no factor has")
    if found.objective.shape != (states,) or not np.isfinite(found.objective).all():
        raise ValueError("the objective is not a finite number for each state")
    if found.G.shape[1] != G_NODES:
        raise ValueError(f"G has {found.G.shape[1]} nodes, not {G_NODES}")
