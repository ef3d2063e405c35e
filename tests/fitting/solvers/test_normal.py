"""What a run is called that finds nothing lower."""

from dataclasses import dataclass

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting.solvers import awls, gauss_newton
from npfm.fitting.solvers.normal import system
from npfm.fitting.solvers.problem import SolverSettings


@dataclass
class Flat:
    """A problem whose objective never changes, with the gradient that it claims to have."""

    slope: float
    energy = 1.0
    lower = -10.0
    stages = ((lambda state: state + 1,),)

    def objective(self, state):
        return 0.5

    def between(self, before, after, t):
        return (1 - t) * before + t * after

    def along(self, before, after):
        return lambda t: 0.5

    def normalised(self, state):
        return state

    def thinned(self, every):
        return self

    def pack(self, state):
        return state

    def unpack(self, packed):
        return packed

    def tops(self, packed):
        return np.zeros(packed.size, dtype=int)

    def normal_equations(self, state):
        return np.array([self.slope, 0.0, 0.0]), np.eye(3)


@pytest.mark.parametrize("solver", [awls, gauss_newton])
@pytest.mark.parametrize(("slope", "status"), [(0.1, "stalled"), (1e-3, "converged")])
def test_a_run_has_stalled_if_its_derivative_promises_more(solver, slope, status):
    """The step promises a decrease of slope^2, the tolerance asks for 5e-6."""
    _, (trace,) = solver.solve(Flat(slope), {"start": np.zeros(2)}, SolverSettings())
    assert trace.status == status


@pytest.mark.parametrize(("slope", "status"), [(0.1, "stalled"), (1e-3, "converged")])
def test_rounding_is_no_progress(slope, status):
    """Machines round differently: where one finds nothing lower another gains a last digit."""
    problem = Flat(slope)
    problem.objective = lambda state: 0.5 - 1e-16 * state[0]
    _, (trace,) = awls.solve(problem, {"start": np.zeros(2)}, SolverSettings())
    assert trace.objective[-1] < 0.5
    assert trace.status == status


def test_what_is_at_the_clamp_moves_with_the_largest_of_its_factor():
    problem = Flat(0.0)
    problem.normal_equations = lambda state: (np.array([1.0, 3.0, 0.0]), np.eye(3))
    found = system(problem, np.array([0.0, -10.0]))
    assert list(found.held) == [1]
    assert found.gradient[0] == 4
    assert found.matrix[0, 0] == 2
    step = found.step(0.0)
    assert step[0] == step[1] == pytest.approx(-2, rel=1e-9)


@pytest.mark.parametrize("tolerance", [0.0, -1e-5, float("nan"), float("inf")])
def test_a_tolerance_that_stops_no_run_is_refused(tolerance):
    with pytest.raises(NpfmError, match="tolerance"):
        SolverSettings(tolerance=tolerance)


def test_no_iterations_are_refused():
    with pytest.raises(NpfmError, match="0 iterations"):
        SolverSettings(max_iterations=0)
