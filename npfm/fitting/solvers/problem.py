"""What a solver is given: the contract between models and solvers."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.fits import Trace

S = TypeVar("S")
Update = Callable[[S], S]
#: Is told what a run has reached, at its start and after each iteration: the name of the start, the
#: number of the iteration from 0, the objective as a share of the energy, and the state.
Follower = Callable[[str, int, float, S], object]

#: Share of the energy by which an iteration gains nothing, however small the objective: where a
#: table is met all but exactly, the tolerance would ask for ever more digits of nearly nothing.
NEGLIGIBLE = 1e-12


class Problem(Protocol[S]):
    """The fit of a model to one channel, or to all that share factors; `S` is its own state."""

    @property
    def energy(self) -> float:
        """Objective of the zero model: relative objectives are shares of it."""

    @property
    def stages(self) -> Sequence[Sequence[Update[S]]]:
        """Alternating updates; the stages are run to convergence one after the other.

        An update returns a candidate with one factor changed, which need not be better.
        """

    def objective(self, state: S) -> float:
        """Objective of equation 7, the floor included."""

    def between(self, before: S, after: S, t: float) -> S:
        """Return the state a share `t` of the way from `before` to `after`."""

    def along(self, before: S, after: S) -> Callable[[float], float]:
        """Objective of `between(before, after, t)` as a function of t."""

    def normalised(self, state: S) -> S:
        """Return the same model with factors scaled to maximum 1."""

    def thinned(self, every: int) -> "Problem[S]":
        """Return about the same problem on fewer samples."""

    def pack(self, state: S) -> NDArray:
        """Unknowns of a state as a vector: logarithms of factors."""

    def unpack(self, packed: NDArray) -> S:
        """Return the state of a vector, with the coefficients that are best for it."""

    def tops(self, packed: NDArray) -> NDArray:
        """Return, for each unknown, the index of the largest one of its factor."""

    @property
    def lower(self) -> float:
        """Least value of an unknown of a packed state."""

    def normal_equations(self, state: S) -> tuple[NDArray, NDArray]:
        """Half the gradient of the objective, and its Gauss-Newton matrix.

        In the packed unknowns, followed by the coefficients that `unpack` solves for, however
        many they are: rho_d, or those of every channel.
        """


def unfollowed(start: str, iteration: int, objective: float, state: object) -> None:
    """Follow no run."""


@dataclass(frozen=True)
class SolverSettings:
    """How to minimise.

    Parameters
    ----------
    method : str
        ``awls`` or ``gauss-newton``.
    tolerance : float
        A run has converged when an iteration lowers the objective by less than this share.
    max_iterations : int
        Cap on the iterations of a run; a run that meets it says so in its status.

    Raises
    ------
    NpfmError
        If the tolerance is not a number above 0, or the cap is below 1.
    """

    method: str = "gauss-newton"
    tolerance: float = 1e-5
    max_iterations: int = 1000

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < float("inf"):
            raise NpfmError(
                f"a tolerance of {self.tolerance:g} stops no run; give a number above 0"
            )
        if self.max_iterations < 1:
            raise NpfmError(f"{self.max_iterations} iterations fit nothing; give 1 or more")


class Solver(Protocol):
    """Runs every start and returns the best state, its settings applied."""

    def __call__(
        self,
        problem: Problem[S],
        starts: Mapping[str, S],
        *,
        ease: float = 1.0,
        follow: Follower[S] = unfollowed,
    ) -> tuple[S, list[Trace]]:
        """Minimise `problem` from each of the named `starts`, to `ease` times the tolerance."""
