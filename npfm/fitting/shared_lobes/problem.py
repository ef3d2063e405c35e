"""The fit of lobes whose D and G the channels share (Peng et al. 2017, equation 3).

rho_c = rho_d_c + F_c(theta_d) sum_l rho_s_cl D_l(theta_h) K_l, with
K_l = G_l(theta_i) G_l(theta_o) / (cos theta_i cos theta_o). Where the paper sums the channels'
objectives as they are, here each counts as a share of its zero model's: so no bright channel
rules, and a brighter table has the same fit.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.factors.problem import LEAST_SHARE, filled
from npfm.fitting.objective import Samples
from npfm.fitting.shared_lobes.coefficients import bounded_least_squares
from npfm.fitting.shared_lobes.places import places

Array = NDArray[np.float64]

#: Smallest component of a factor whose largest is 1, as of independent-g.
CLAMP = 1e-6
#: Bins that fewer samples see than this share of those that see the best-seen one are filled in:
#: the largest component of a factor, which the others are relative to, lies in none of them.
OBSERVED = 0.01
#: The Gauss-Newton matrix, which needs most of the time, is made of about so many bins of phi_d,
#: on which factors depend smoothly; gradient, objective and diagonal are those of all.
MATRIX_BINS = 10
#: A material is specular if its largest sample is more than so many weighted medians: of the MERL
#: database, what has a highlight to be seen (fabrics 10, polyurethane-foam 50, nylon 8000).
SPECULAR = 1000.0
#: Width of the Gaussian that smooths G of specular materials, in nodes (the paper gives none).
SMOOTHING = 1.0
#: Updates of D, F and the coefficients for one of G, which alone needs passes over the samples.
INNER_SWEEPS = 5


@dataclass(frozen=True)
class State:
    """Factors, coefficients, and the sums over phi_d that belong to G.

    Parameters
    ----------
    D, F, G : ndarray, shapes (lobes, theta_h), (channels, theta_d), (lobes, nodes)
    rho_s, rho_d : ndarray, shapes (channels, lobes), (channels,)
        In units of the channel's samples.
    sums : tuple of ndarray
        wK, wKK' and wrK (see `kernels.kernel_sums`).
    """

    D: Array
    F: Array
    G: Array
    rho_s: Array
    rho_d: Array
    sums: tuple[Array, Array, Array]

    @property
    def basis(self) -> Array:
        """D F of each channel and lobe in each cell, shape (channels, rows, lobes)."""
        products = np.einsum("lh,cd->chdl", self.D, self.F)
        return products.reshape(len(self.F), -1, len(self.D))


def compiled() -> ModuleType:
    """Return the kernels; a fit calls this first, before time is taken."""
    from npfm.fitting.shared_lobes import kernels

    return kernels


def with_diagonal(matrix: Array, diagonal: Array) -> Array:
    """Scale rows and columns of a positive semidefinite matrix so that it has a diagonal.

    Where the matrix knows nothing of an unknown, only the diagonal does.
    """
    own = np.diag(matrix)
    root = np.sqrt(np.divide(diagonal, own, out=np.zeros_like(own), where=own > 0))
    scaled = matrix * root * root[:, None]
    np.fill_diagonal(scaled, diagonal)
    return scaled


class SharedLobesProblem:
    """The fit of all channels at once (see `npfm.fitting.solvers.problem.Problem`).

    The objective is the mean over the channels of their shares of the zero model's.

    Parameters
    ----------
    samples : sequence of Samples
        Folded measurements of the channels that share their lobes.
    lobes : int
        How many.
    spline : bool
        Whether G is read along a Catmull-Rom spline, and not linearly between its nodes.
    floor : float
        Least rho_s, as the share of a lobe in the mean of a channel: a lobe of coefficient 0 has
        no derivative to come back by.
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
        self.samples, self.lobes, self.spline = samples, lobes, spline
        self.floor, self.every = floor, every
        self.grid = samples[0].grid
        self.places = places(self.grid, every, spline)
        kept, shape = slice(every // 2, None, every), self.places.inverse_cosines.shape
        shares = [1 / (len(samples) * (s.energy or 1.0)) for s in samples]
        self.weight = np.stack(
            [
                s.weight[..., kept].reshape(shape) * part
                for s, part in zip(samples, shares, strict=True)
            ]
        )
        values = np.stack([s.value[..., kept].reshape(shape) for s in samples])
        self.weighted_value = self.weight * values
        self._rest = sum(s.floor * part for s, part in zip(samples, shares, strict=True)) / every
        self._w, self._wr = self.weight.sum((1, 2)), self.weighted_value.sum((1, 2))
        self._wrr = np.einsum("cij,cij->c", self.weighted_value, values)

    def thinned(self, every: int) -> "SharedLobesProblem":
        """Return the same fit on every n-th bin of phi_d; of a thinned one, itself."""
        if self.every > 1:
            return self
        return SharedLobesProblem(self.samples, self.lobes, self.spline, self.floor, every)

    @cached_property
    def energy(self) -> float:
        """Objective of the zero model."""
        return self._rest + float(self._wrr.sum())

    @property
    def lower(self) -> float:
        """Least logarithm of a component of a factor whose largest is 1."""
        return float(np.log(CLAMP))

    @cached_property
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, of the F of each channel, and of G enough samples depend on."""
        counts = self.weight > 0
        number = counts.sum(2).reshape(-1, *self.grid.shape[:2])
        seen_by = number.sum((0, 2)), number.sum(1), self.places.reads(np.any(counts, axis=0))
        return tuple(n > OBSERVED * n.max(-1, keepdims=True) for n in seen_by)

    @property
    def _arrays(self) -> tuple[NDArray, ...]:
        return self.weight, self.weighted_value, *self.places.arrays

    def state(self, D: Array, F: Array, G: Array) -> State:
        """Return the state of given factors with its best coefficients.

        Factors are scaled to maximum 1 and clamped; components that hardly any sample depends on
        are interpolated from their neighbours.
        """
        in_d, in_f, in_g = self.seen
        D = np.stack([filled(x, in_d, CLAMP) for x in np.asarray(D, dtype=float)])
        F = np.stack([filled(x, seen, CLAMP) for x, seen in zip(F, in_f, strict=True)])
        G = np.stack([filled(x, in_g, CLAMP) for x in np.asarray(G, dtype=float)])
        return self.with_coefficients(State(D, F, G, np.empty(0), np.empty(0), self._sums(G)))

    def _sums(self, G: Array) -> tuple[Array, Array, Array]:
        return compiled().kernel_sums(*self._arrays, G)

    def _with_G(self, state: State, G: Array) -> State:
        return replace(state, G=G, sums=self._sums(G))

    def _equations(self, state: State) -> tuple[Array, Array]:
        """Matrices and right-hand sides of rho_d and the rho_s of every channel."""
        return compiled().coefficient_equations(state.D, state.F, *state.sums, self._w, self._wr)

    def with_coefficients(self, state: State, floor: float | None = None) -> State:
        """Return the state with its best rho_d >= 0 and rho_s, no lobe being quite without.

        `floor` stands in for that of the problem, if it is given.
        """
        floor = self.floor if floor is None else floor
        found = []
        for matrix, right in zip(*self._equations(state), strict=True):
            lower = np.zeros(right.size)
            reached = matrix[0] > 0
            reached[0] = False
            lower[reached] = floor * right[0] / matrix[0, reached]
            found.append(bounded_least_squares(matrix, right, lower))
        rho_d, *rho_s = np.array(found).T.copy()
        return replace(state, rho_d=rho_d, rho_s=np.stack(rho_s, axis=1))

    def objective(self, state: State) -> float:
        """Mean over the channels of the objective of equation 7 as a share, the floor included."""
        total = 0.0
        for channel, (matrix, right) in enumerate(zip(*self._equations(state), strict=True)):
            x = np.append(state.rho_d[channel], state.rho_s[channel])
            # A sum of squares, below 0 by rounding only.
            total += max(float(self._wrr[channel] + x @ (matrix @ x - 2 * right)), 0.0)
        return self._rest + total

    def pack(self, state: State) -> Array:
        """Logarithms of D, F and G, one after the other."""
        return np.log(np.concatenate([state.D.ravel(), state.F.ravel(), state.G.ravel()]))

    def unpack(self, packed: Array) -> State:
        """Return the state of packed factors (see `state`)."""
        return self.state(*self._split(np.exp(packed)))

    def _split(self, packed: Array) -> tuple[Array, Array, Array]:
        nh, nd, _ = self.grid.shape
        ends = self.lobes * nh, self.lobes * nh + len(self.samples) * nd
        D, F, G = np.split(packed, ends)
        return D.reshape(-1, nh), F.reshape(-1, nd), G.reshape(-1, G_NODES)

    def tops(self, packed: Array) -> NDArray[np.intp]:
        """Return, for each packed unknown, where the largest component of its factor is."""
        first, tops = 0, []
        for factor in (row for rows in self._split(packed) for row in rows):
            tops.append(np.full(factor.size, first + np.argmax(factor)))
            first += factor.size
        return np.concatenate(tops)

    def normal_equations(self, state: State) -> tuple[Array, Array]:
        """Gradient and matrix in the logarithms of D, F, G and rho_s, then rho_d.

        Without what is filled in, and without coefficients at their bound that would go beyond it.
        """
        at = state.D, state.F, state.G, state.rho_s, state.rho_d
        if self._matrix_problem is self:
            gradient, matrix = compiled().normal_equations(*self._arrays, *at)
        else:
            gradient, diagonal = compiled().gradient_and_diagonal(*self._arrays, *at)
            _, matrix = compiled().normal_equations(*self._matrix_problem._arrays, *at)
            matrix = with_diagonal(matrix, diagonal)
        in_d, in_f, in_g = self.seen
        filled_in = ~np.concatenate(
            [np.tile(in_d, self.lobes), in_f.ravel(), np.tile(in_g, self.lobes)]
        )
        least = np.concatenate([self._at_floor(state).ravel(), state.rho_d == 0])
        out = np.concatenate([filled_in, least & (gradient[filled_in.size :] > 0)])
        gradient[out], matrix[out], matrix[:, out] = 0.0, 0.0, 0.0
        return gradient, matrix

    @cached_property
    def _matrix_problem(self) -> "SharedLobesProblem":
        """The problem whose samples the Gauss-Newton matrix is made of."""
        every = self.weight.shape[2] // MATRIX_BINS
        return self.thinned(every) if every > 1 else self

    def _at_floor(self, state: State) -> NDArray[np.bool_]:
        border = np.einsum("crl,crl->cl", state.basis, state.sums[0])
        floor = np.divide(
            self.floor * self._wr[:, None], border, out=np.zeros_like(border), where=border > 0
        )
        return state.rho_s <= floor * (1 + 1e-9)

    def between(self, before: State, after: State, t: float) -> State:
        """Interpolate what differs between two states."""
        mixed = {
            name: (1 - t) * getattr(before, name) + t * getattr(after, name)
            for name in ("D", "F", "rho_s", "rho_d")
        }
        if before.G is after.G:
            return replace(before, **mixed)
        return self._with_G(replace(before, **mixed), (1 - t) * before.G + t * after.G)

    def along(self, before: State, after: State) -> Callable[[float], float]:
        """Objective on the way from one state to another."""
        return lambda t: self.objective(self.between(before, after, t))

    def normalised(self, state: State) -> State:
        """Return the same model with each factor scaled to maximum 1, rho_s taking the scale."""
        d, f, g = (x.max(1) for x in (state.D, state.F, state.G))
        wk, wkk, wrk = state.sums
        squares = g**2
        return State(
            state.D / d[:, None],
            state.F / f[:, None],
            state.G / g[:, None],
            state.rho_s * (f[:, None] * d * squares),
            state.rho_d,
            (wk / squares, wkk / (squares[:, None] * squares), wrk / squares),
        )

    @property
    def specular(self) -> bool:
        """Whether the material counts as one with a highlight."""
        return max(s.value.max() for s in self.samples) > SPECULAR

    @property
    def stages(self) -> tuple[tuple[Callable[[State], State], ...], ...]:
        """The paper's updates; G is smoothed only for specular materials, and not in the end."""
        from npfm.fitting.shared_lobes import alternating

        def exact(update: Callable[[State], State]) -> Callable[[State], State]:
            """Leave a state as it is where only rounding makes its best component worse."""

            def guarded(state: State) -> State:
                candidate = update(state)
                return candidate if self.objective(candidate) <= self.objective(state) else state

            return guarded

        def sweep(smoothing: float) -> tuple[Callable[[State], State], ...]:
            every = range(self.lobes)
            inner: list[Callable[[State], State]] = [
                *(partial(alternating.updated_D, self, lobe) for lobe in every),
                partial(alternating.updated_F, self),
                self.with_coefficients,
            ]
            outer = [partial(alternating.updated_G, self, lobe, smoothing) for lobe in every]
            inner = [exact(update) for update in inner]
            return (*inner * INNER_SWEEPS, *(outer if smoothing else map(exact, outer)))

        return (sweep(SMOOTHING), sweep(0.0)) if self.specular else (sweep(0.0),)
