"""The fit of lobes whose factors are made of a few common curves.

The unknowns are the coefficients of the curves: a handful for each factor, in place of 90. What is
minimised, and how its derivatives in the logarithms of the factors are found, is up to the fit of
free lobes; the chain rule carries them over.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from npfm.fitting.basis.curves import Basis
from npfm.fitting.shared_lobes import problem as free
from npfm.fitting.shared_lobes.problem import LobesProblem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class State:
    """Coefficients of every factor, one after the other, and the lobes that they make."""

    coefficients: Array
    lobes: free.State


class BasisProblem:
    """The fit of lobes in a basis (see `npfm.fitting.solvers.problem.Problem`).

    Parameters
    ----------
    free : LobesProblem
        The fit of free factors to the same samples.
    D, F, G : Basis
        What every D, every F and every G is made of.
    thin : callable, optional
        Gives the fit of free factors on every n-th bin of phi_d, in place of its own `thinned`:
        bases of many sizes can share it.
    """

    lower = -np.inf  # coefficients have no bound
    stages = ()  # and none is solved for alone

    def __init__(
        self,
        free: LobesProblem,
        D: Basis,
        F: Basis,
        G: Basis,
        thin: Callable[[int], LobesProblem] | None = None,
    ):
        self.free, self.bases = free, (D, F, G)
        self._thin = thin or free.thinned

    @property
    def energy(self) -> float:
        """Objective of the zero model."""
        return self.free.energy

    @cached_property
    def counts(self) -> tuple[int, int, int]:
        """How many D, F and G there are."""
        return self.free.lobes, len(self.free.samples), self.free.lobes

    @cached_property
    def _mean(self) -> Array:
        pairs = zip(self.bases, self.counts, strict=True)
        return np.concatenate([np.tile(basis.mean, count) for basis, count in pairs])

    @cached_property
    def _curves(self) -> Array:
        """Derivatives of all logarithms in all coefficients."""
        pairs = zip(self.bases, self.counts, strict=True)
        return block_diag(*(basis.curves.T for basis, count in pairs for _ in range(count)))

    def thinned(self, every: int) -> "BasisProblem":
        """Return the same fit on fewer samples."""
        return BasisProblem(self._thin(every), *self.bases)

    def objective(self, state: State) -> float:
        """Objective of equation 7 as of the free lobes."""
        return self.free.objective(state.lobes)

    def faintest(self, state: State, least: float) -> State:
        """Return the state with its best rho_d and rho_s, no lobe below `least` of the mean."""
        return State(state.coefficients, self.free.with_coefficients(state.lobes, least))

    def pack(self, state: State) -> Array:
        """Coefficients of D, F and G, one after the other."""
        return state.coefficients

    def unpack(self, packed: Array) -> State:
        """Return the state of coefficients, with the best rho_d and rho_s for it."""
        return State(packed, self.free.unpack(self._mean + self._curves @ packed))

    def tops(self, packed: Array) -> NDArray[np.intp]:
        """Return each unknown itself: none is held at a share of another."""
        return np.arange(packed.size)

    def normal_equations(self, state: State) -> tuple[Array, Array]:
        """Gradient and matrix in the coefficients, then in those of the lobes."""
        gradient, matrix = self.free.normal_equations(state.lobes)
        packed = self.free.pack(state.lobes)
        # What the clamp holds is a fixed share of the largest value of its factor.
        held = packed <= self.free.lower + 1e-9
        moved = np.where(held, self.free.tops(packed), np.arange(packed.size))
        chain = block_diag(self._curves[moved], np.eye(gradient.size - packed.size))
        return chain.T @ gradient, chain.T @ matrix @ chain

    def between(self, before: State, after: State, t: float) -> State:
        """Interpolate the coefficients."""
        return self.unpack((1 - t) * before.coefficients + t * after.coefficients)

    def along(self, before: State, after: State) -> Callable[[float], float]:
        """Objective on the way from one state to another."""
        return lambda t: self.objective(self.between(before, after, t))

    def normalised(self, state: State) -> State:
        """Return the state as it is: its lobes have maximum 1."""
        return state
