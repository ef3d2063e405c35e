"""The Gauss-Newton step of a problem within its bounds, and what it promises."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from npfm.fitting.solvers.problem import NEGLIGIBLE, Problem, S, SolverSettings

#: Longest step of a logarithm: a factor changes by at most e^3, about 20, at a time.
LONGEST_STEP = 3.0
#: Damping that a run begins with.
FIRST_DAMPING = 1e-3


@dataclass(frozen=True)
class System:
    """Normal equations at a state: half the gradient, and the Gauss-Newton matrix.

    Parameters
    ----------
    gradient, matrix : ndarray, shapes (n,) and (n, n)
        In the packed unknowns, followed by the coefficients; what is held at the clamp is added to
        the component it moves with.
    free, held, tops : ndarray of int
        Unknowns that are solved for, those at the clamp, and for each unknown the largest
        component of its factor.
    """

    gradient: NDArray
    matrix: NDArray
    free: NDArray[np.intp]
    held: NDArray[np.intp]
    tops: NDArray[np.intp]

    @property
    def reduced(self) -> tuple[NDArray, NDArray]:
        """Gradient and matrix of the free unknowns."""
        return self.gradient[self.free], self.matrix[np.ix_(self.free, self.free)]

    def step(self, damping: float) -> NDArray:
        """Change of all unknowns, shape (n,), for a damping of the scaled equations."""
        gradient, matrix = self.reduced
        step = np.zeros(self.gradient.size)
        step[self.free] = _solved(matrix, gradient, damping)
        step[self.held] = step[self.tops[self.held]]
        return step


def system(problem: Problem[S], state: S) -> System:
    """Return the normal equations of a problem at a state, its bounds taken into account."""
    packed = problem.pack(state)
    gradient, matrix = problem.normal_equations(state)
    at_bound = np.zeros(gradient.size, dtype=bool)
    at_bound[: packed.size] = (packed <= problem.lower + 1e-9) & (gradient[: packed.size] > 0)
    held = np.flatnonzero(at_bound)
    tops = np.append(problem.tops(packed), np.arange(packed.size, gradient.size))
    # A component at the clamp is a fixed share of the largest one of its factor and moves with it.
    for top in np.unique(tops[held]):
        tied = held[tops[held] == top]
        gradient[top] += gradient[tied].sum()
        matrix[:, top] += matrix[:, tied].sum(1)
        matrix[top] += matrix[tied].sum(0)
    free = np.flatnonzero((np.diag(matrix) > 1e-300) & ~at_bound)
    return System(gradient, matrix, free, held, tops)


def _solved(matrix: NDArray, gradient: NDArray, damping: float) -> NDArray:
    scale = np.diag(matrix)
    # Scaling to a unit diagonal makes the damping the same for strong and for weak unknowns.
    root = np.sqrt(scale)
    scaled = matrix / root / root[:, None]
    scaled[np.diag_indices_from(scaled)] = 1 + damping + 1e-12
    try:
        step = cho_solve(cho_factor(scaled, lower=True), -gradient / root) / root
    except LinAlgError:
        step = -gradient / scale
    return np.clip(step, -LONGEST_STEP, LONGEST_STEP)


def status_at_rest(problem: Problem[S], state: S, current: float, settings: SolverSettings) -> str:
    """Status of a run that finds nothing lower than a state.

    ``stalled`` if the quadratic model of the objective promises a decrease that would have kept
    the run going, else ``converged``.
    """
    equations = system(problem, state)
    gradient, matrix = equations.reduced
    step = equations.step(FIRST_DAMPING)[equations.free]
    promised = -(2 * gradient @ step + step @ matrix @ step)
    enough = settings.tolerance * current + NEGLIGIBLE * problem.energy
    return "stalled" if promised > enough else "converged"
