"""The fit of lobes whose D and G the channels share (Peng et al. 2017, equation 3).

rho_c = rho_d_c + F_c(theta_d) sum_l rho_s_cl D_l(theta_h) K_l, with
K_l = G_l(theta_i) G_l(theta_o) / (cos theta_i cos theta_o). Where the paper sums the channels'
objectives as they are, here each counts as a share of its zero model's: so no bright channel
rules, and a brighter table has the same fit.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from types import ModuleType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.problem import filled
from npfm.fitting.objective import Samples
from npfm.fitting.shared_lobes.coefficients import bounded_least_squares
from npfm.fitting.shared_lobes.places import Places

Array = NDArray[np.float64]

#: Smallest component of a factor whose largest is 1, as of independent-g.
CLAMP = 1e-6
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


def compiled() -> ModuleType:
    """Return the kernels; a fit calls this first, before time is taken."""
    from npfm.fitting.shared_lobes import kernels

    return kernels


class LobesProblem(ABC):
    """The fit of all channels at once (see `npfm.fitting.solvers.problem.Problem`).

    The objective is the mean over the channels of their shares of the zero model's. On which grid
    the samples lie is up to those that inherit from it: where they read D, F and G.

    Parameters
    ----------
    samples : sequence of Samples
        Folded measurements of the channels that share their lobes.
    lobes : int
        How many.
    floor : float
        Least rho_s, as the share of a lobe in the mean of a channel: a lobe of coefficient 0 has
        no derivative to come back by.
    at : Places
        Where samples read G.
    kept : callable
        Picks the samples that are used out of an array of them, shape (rows, columns).
    every : int
        They are one of so many.
    """

    def __init__(
        self,
        samples: Sequence[Samples],
        lobes: int,
        floor: float,
        at: Places,
        kept: Callable[[Array], Array],
        every: int = 1,
    ):
        self.samples, self.lobes, self.floor, self.every = samples, lobes, floor, every
        self.places = at
        shares = [1 / (len(samples) * (s.energy or 1.0)) for s in samples]
        self.weight = np.stack(
            [kept(s.weight) * part for s, part in zip(samples, shares, strict=True)]
        )
        values = np.stack([kept(s.value) for s in samples])
        self.weighted_value = self.weight * values
        self._rest = sum(s.floor * part for s, part in zip(samples, shares, strict=True)) / every
        self._w, self._wr = self.weight.sum((1, 2)), self.weighted_value.sum((1, 2))
        self._wrr = np.einsum("cij,cij->c", self.weighted_value, values)

    @property
    @abstractmethod
    def sizes(self) -> tuple[int, int, int]:
        """Number of components of a D, an F and a G."""

    @property
    @abstractmethod
    def theta_h(self) -> Array:
        """Angle of each component of D, in radians."""

    def over_theta_h(self, D: Array) -> tuple[Array, Array]:
        """A D over increasing angles theta_h, and these."""
        return D, self.theta_h

    @cached_property
    @abstractmethod
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, of the F of each channel, and of G enough samples depend on."""

    @abstractmethod
    def D_at(self, D: Array) -> Array:
        """Values of each lobe's D in each row, shape (rows, lobes)."""

    @abstractmethod
    def F_at(self, F: Array) -> Array:
        """Values of each channel's F in each row, shape (channels, rows)."""

    @abstractmethod
    def sums_over_F(self, values: Array) -> Array:
        """Sums of values of the rows, shape (rows,), over those that read each component of F."""

    @abstractmethod
    def filled(self, lobe: Array, seen: NDArray[np.bool_]) -> Array:
        """A D or a G scaled to maximum 1 and clamped, unseen components from their neighbours."""

    @abstractmethod
    def solved_D(self, numerator: Array, denominator: Array, before: Array) -> Array:
        """Best D of a lobe, where (channels, rows) are those of the quotients of its values."""

    @abstractmethod
    def solved_F(self, numerator: Array, denominator: Array, before: Array) -> Array:
        """Best F of a channel, as of `solved_D`, of shape (rows,)."""

    @abstractmethod
    def smoothed(self, G: Array, width: float) -> Array:
        """Smooth a G by a Gaussian, whose width is in nodes."""

    @abstractmethod
    def derivatives(self, state: State) -> tuple[Array, Array, Array]:
        """Gradient and Gauss-Newton matrix in the logarithms of D, F, G and rho_s, then rho_d.

        And derivatives of each channel's mean, sum w rho, shape (channels, unknowns), in a unit of
        their own.
        """

    @abstractmethod
    def thinned(self, every: int) -> Self:
        """Return the same fit on fewer samples, or itself."""

    def basis(self, state: State) -> Array:
        """D F of each channel and lobe in each row, shape (channels, rows, lobes)."""
        return self.F_at(state.F)[..., None] * self.D_at(state.D)

    @cached_property
    def energy(self) -> float:
        """Objective of the zero model."""
        return self._rest + float(self._wrr.sum())

    @property
    def lower(self) -> float:
        """Least logarithm of a component of a factor whose largest is 1."""
        return float(np.log(CLAMP))

    @property
    def _arrays(self) -> tuple[NDArray, ...]:
        return self.weight, self.weighted_value, *self.places.arrays

    def state(self, D: Array, F: Array, G: Array) -> State:
        """Return the state of given factors with its best coefficients.

        Factors are scaled to maximum 1 and clamped; components that hardly any sample depends on
        are interpolated from their neighbours.
        """
        in_d, in_f, in_g = self.seen
        D = np.stack([self.filled(x, in_d) for x in np.asarray(D, dtype=float)])
        F = np.stack([filled(x, seen, CLAMP) for x, seen in zip(F, in_f, strict=True)])
        G = np.stack([self.filled(x, in_g) for x in np.asarray(G, dtype=float)])
        return self.with_coefficients(State(D, F, G, np.empty(0), np.empty(0), self._sums(G)))

    def _sums(self, G: Array) -> tuple[Array, Array, Array]:
        return compiled().kernel_sums(*self._arrays, G)

    def _with_G(self, state: State, G: Array) -> State:
        return replace(state, G=G, sums=self._sums(G))

    def _equations(self, state: State) -> tuple[Array, Array]:
        """Matrices and right-hand sides of rho_d and the rho_s of every channel."""
        return compiled().coefficient_equations(
            self.D_at(state.D), self.F_at(state.F), *state.sums, self._w, self._wr
        )

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
        nh, nd, nodes = self.sizes
        ends = self.lobes * nh, self.lobes * nh + len(self.samples) * nd
        D, F, G = np.split(packed, ends)
        return D.reshape(-1, nh), F.reshape(-1, nd), G.reshape(-1, nodes)

    def tops(self, packed: Array) -> NDArray[np.intp]:
        """Return, for each packed unknown, where the largest component of its factor is."""
        first, tops = 0, []
        for factor in (row for rows in self._split(packed) for row in rows):
            tops.append(np.full(factor.size, first + np.argmax(factor)))
            first += factor.size
        return np.concatenate(tops)

    def normal_equations(self, state: State) -> tuple[Array, Array]:
        """Gradient and matrix in the logarithms of D, F, G and rho_s, then rho_d.

        Without what is filled in, and without coefficients at their bound that would go beyond it:
        these keep their share while their lobe changes.
        """
        floored = self._at_floor(state)
        gradient, matrix = self._tied(state, floored, *self.derivatives(state))
        in_d, in_f, in_g = self.seen
        filled_in = ~np.concatenate(
            [np.tile(in_d, self.lobes), in_f.ravel(), np.tile(in_g, self.lobes)]
        )
        least = np.concatenate([floored.ravel(), state.rho_d == 0])
        out = np.concatenate([filled_in, least & (gradient[filled_in.size :] > 0)])
        gradient[out], matrix[out], matrix[:, out] = 0.0, 0.0, 0.0
        return gradient, matrix

    def _tied(
        self,
        state: State,
        floored: NDArray[np.bool_],
        gradient: Array,
        matrix: Array,
        of_means: Array,
    ) -> tuple[Array, Array]:
        """Equations in which each coefficient at its floor follows what that floor hangs on.

        The floor of a lobe is a share over its mean, sum w B_l, so that the logarithm of the
        coefficient changes by -s d(log of factors), s being derivatives of the logarithm of that
        mean.
        """
        tied = np.argwhere(floored & (state.rho_s > 0))
        if not tied.size:
            return gradient, matrix
        nh, nd, nodes = self.sizes
        count, lobes = len(self.samples), self.lobes
        first_F, first_G = lobes * nh, lobes * nh + count * nd
        first_s = first_G + lobes * nodes
        D = self.D_at(state.D)
        slopes = np.zeros((len(tied), len(gradient)))
        for slope, (c, lobe) in zip(slopes, tied, strict=True):
            of_mean = of_means[c]
            in_d = slice(lobe * nh, (lobe + 1) * nh)
            in_g = slice(first_G + lobe * nodes, first_G + (lobe + 1) * nodes)
            whole = of_mean[first_s + c * lobes + lobe]
            slope[in_d], slope[in_g] = of_mean[in_d] / whole, of_mean[in_g] / whole
            per_F = state.F[c] * self.sums_over_F(D[:, lobe] * state.sums[0][c, :, lobe])
            slope[first_F + c * nd : first_F + (c + 1) * nd] = per_F / per_F.sum()
        own = first_s + tied[:, 0] * lobes + tied[:, 1]
        crossed = slopes.T @ matrix[own]
        matrix = matrix - crossed - crossed.T + slopes.T @ matrix[np.ix_(own, own)] @ slopes
        return gradient - slopes.T @ gradient[own], matrix

    def _at_floor(self, state: State) -> NDArray[np.bool_]:
        matrix, _ = self._equations(state)
        border = matrix[:, 0, 1:]
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
