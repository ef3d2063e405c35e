"""The fit of shared lobes of isotropic materials: D hangs on theta_h, G on the angle to the normal.

A row of samples has one theta_h and one theta_d, and all phi_d.
"""

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.factors.problem import LEAST_SHARE, filled, quotient
from npfm.fitting.objective import Samples
from npfm.fitting.shared_lobes.places import places
from npfm.fitting.shared_lobes.problem import CLAMP, LobesProblem, State, compiled

Array = NDArray[np.float64]

#: Bins that fewer samples see than this share of those that see the best-seen one are filled in:
#: the largest component of a factor, which the others are relative to, lies in none of them.
OBSERVED = 0.01
#: The Gauss-Newton matrix, which needs most of the time, is made of about so many bins of phi_d,
#: on which factors depend smoothly; gradient, objective and diagonal are those of all.
MATRIX_BINS = 10


def with_diagonal(matrix: Array, diagonal: Array) -> Array:
    """Scale rows and columns of a positive semidefinite matrix so that it has a diagonal.

    Where the matrix knows nothing of an unknown, only the diagonal does.
    """
    own = np.diag(matrix)
    root = np.sqrt(np.divide(diagonal, own, out=np.zeros_like(own), where=own > 0))
    scaled = matrix * root * root[:, None]
    np.fill_diagonal(scaled, diagonal)
    return scaled


class SharedLobesProblem(LobesProblem):
    """The fit of lobes of theta_h, to samples on a half-difference grid.

    Parameters
    ----------
    samples, lobes, floor
        As of `LobesProblem`.
    spline : bool
        Whether G is read along a Catmull-Rom spline, and not linearly between its nodes.
    every : int
        Use every n-th bin of phi_d only.
    """

    def __init__(
        self,
        samples: Sequence[Samples],
        lobes: int,
        spline: bool = False,
        floor: float = LEAST_SHARE,
        every: int = 1,
    ):
        self.grid, self.spline = samples[0].grid, spline
        at = places(self.grid, every, spline)
        bins, shape = slice(every // 2, None, every), at.inverse_cosines.shape
        super().__init__(samples, lobes, floor, at, lambda a: a[..., bins].reshape(shape), every)

    def thinned(self, every: int) -> "SharedLobesProblem":
        """Return the same fit on every n-th bin of phi_d; of a thinned one, itself."""
        if self.every > 1:
            return self
        return SharedLobesProblem(self.samples, self.lobes, self.spline, self.floor, every)

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Number of components of a D, an F and a G."""
        return self.grid.theta_h_bins, self.grid.theta_d_bins, G_NODES

    @property
    def theta_h(self) -> Array:
        """Angle of each component of D, in radians."""
        return self.grid.theta_h

    @cached_property
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, of the F of each channel, and of G enough samples depend on."""
        counts = self.weight > 0
        number = counts.sum(2).reshape(-1, *self.grid.shape[:2])
        seen_by = number.sum((0, 2)), number.sum(1), self.places.reads(np.any(counts, axis=0))
        return tuple(n > OBSERVED * n.max(-1, keepdims=True) for n in seen_by)

    def D_at(self, D: Array) -> Array:
        """Values of each lobe's D in each row, shape (rows, lobes)."""
        return np.repeat(D.T, self.grid.theta_d_bins, axis=0)

    def F_at(self, F: Array) -> Array:
        """Values of each channel's F in each row, shape (channels, rows)."""
        return np.tile(F, (1, self.grid.theta_h_bins))

    def sums_over_F(self, values: Array) -> Array:
        """Sums of values of the rows over each bin of theta_d."""
        return values.reshape(self.grid.shape[:2]).sum(0)

    def filled(self, lobe: Array, seen: NDArray[np.bool_]) -> Array:
        """A D or a G scaled to maximum 1 and clamped, unseen components interpolated."""
        return filled(lobe, seen, CLAMP)

    def solved_D(self, numerator: Array, denominator: Array, before: Array) -> Array:
        """Best D of a lobe: each component is a quotient of sums of all channels."""
        return self._per_bin(numerator, denominator, before, (0, 2))

    def solved_F(self, numerator: Array, denominator: Array, before: Array) -> Array:
        """Best F of a channel."""
        return self._per_bin(numerator[None], denominator[None], before, (0, 1))

    def _per_bin(
        self, numerator: Array, denominator: Array, before: Array, axes: tuple[int, int]
    ) -> Array:
        """Equation 14 of Bagher et al. 2016 for each bin of one angle, clamped."""
        plane = self.grid.shape[:2]
        numerator, denominator = (x.reshape(-1, *plane).sum(axes) for x in (numerator, denominator))
        return quotient(numerator, denominator, before, CLAMP)

    def smoothed(self, G: Array, width: float) -> Array:
        """Smooth a G by a Gaussian, whose width is in nodes."""
        from scipy.ndimage import gaussian_filter1d

        return gaussian_filter1d(G, width, mode="nearest")

    def derivatives(self, state: State) -> tuple[Array, Array, Array]:
        """Gradient, Gauss-Newton matrix, and derivatives of the means, as of `LobesProblem`."""
        at = state.D, state.F, state.G, state.rho_s, state.rho_d
        if self._matrix_problem is self:
            gradient, matrix = compiled().normal_equations(*self._arrays, *at)
            return gradient, matrix, matrix[-len(self.samples) :]
        gradient, diagonal = compiled().gradient_and_diagonal(*self._arrays, *at)
        _, matrix = compiled().normal_equations(*self._matrix_problem._arrays, *at)
        return gradient, with_diagonal(matrix, diagonal), matrix[-len(self.samples) :]

    @cached_property
    def _matrix_problem(self) -> "SharedLobesProblem":
        """The problem whose samples the Gauss-Newton matrix is made of."""
        every = self.weight.shape[2] // MATRIX_BINS
        return self.thinned(every) if every > 1 else self
