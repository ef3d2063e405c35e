"""What one-product models share: rho_d + rho_s D(theta_h) F(theta_d) K(theta_h, theta_d, phi_d).

K is made of a modulation: of G in the microfacet models, and H itself in the naive one. For a
fixed K, the objective depends on D, F, rho_d and rho_s only through sums over phi_d of w, wK,
wK^2, wr and wrK. These are arrays over (theta_h, theta_d): everything but a change of K is worked
out on them, exactly.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import Samples
from npfm.fitting.solvers.problem import S

Array = NDArray[np.float64]

#: What stands for 0 where a logarithm is taken.
SMALLEST = 1e-12
#: Least share of rho_s in the mean, where the product falls as the measurement rises: the model
#: is next to constant then, and the factors keep a derivative to turn round by.
LEAST_SHARE = 1e-6
#: Variance of the product as a share of its mean square below which it counts as constant: the
#: difference of two sums has lost its digits.
SINGULAR = 1e-12


@dataclass(frozen=True)
class Factors:
    """Factors and coefficients of one channel (equations 3 and 4 of Bagher et al. 2016).

    Parameters
    ----------
    D, F : ndarray
        Tabulated at the bin centres of theta_h and theta_d.
    modulation : ndarray
        G at its nodes, or H at the bin centres of phi_d.
    rho_d, rho_s : float
        Diffuse and specular coefficients, in the units of the samples.
    """

    D: Array
    F: Array
    modulation: Array
    rho_d: float
    rho_s: float


@dataclass(frozen=True)
class Sums:
    """Sums over phi_d for one K; arrays of shape (theta_h, theta_d), `wrr` over everything."""

    w: Array
    wr: Array
    wk: Array
    wkk: Array
    wrk: Array
    wrr: float

    def objective(self, product: Array, rho_d: float, rho_s: float) -> float:
        """Objective of rho_d + rho_s `product` K, `product` being D F (without the floor)."""
        x = rho_s * product
        return float(
            self.wrr
            + rho_d * (rho_d * self.w.sum() - 2 * self.wr.sum())
            + np.vdot(x, 2 * rho_d * self.wk - 2 * self.wrk + x * self.wkk)
        )

    def scaled(self, scale: float) -> "Sums":
        """Return the sums of `scale` times K."""
        return replace(self, wk=self.wk * scale, wkk=self.wkk * scale**2, wrk=self.wrk * scale)


def coefficients(sums: Sums, product: Array) -> tuple[float, float]:
    """Best rho_d >= 0 and rho_s for a given product D F (equations 15 to 18).

    The determinants of Cramer's rule are taken about the mean of x, which is the same system
    without its cancellation. Where x does not vary, rho_d and rho_s cannot be told apart and
    all goes to rho_s (equation 18).
    """
    w, wy = sums.w.sum(), sums.wr.sum()
    wx, wxx = np.vdot(product, sums.wk), np.vdot(product**2, sums.wkk)
    wxy = np.vdot(product, sums.wrk)
    if w == 0:
        return 0.0, 0.0
    variance, covariance = wxx - wx * wx / w, wxy - wx * wy / w
    if wx == 0:
        return float(wy / w), 0.0
    if variance > SINGULAR * wxx and covariance > 0:
        rho_s = covariance / variance
    elif wy * wy / w > (1 + SINGULAR) * wxy * wxy / wxx:  # a constant does better
        rho_s = LEAST_SHARE * wy / wx
    else:
        return 0.0, float(wxy / wxx)
    rho_d = (wy - rho_s * wx) / w
    return (float(rho_d), float(rho_s)) if rho_d >= 0 else (0.0, float(wxy / wxx))


class Changed(TypedDict, total=False):
    """What of `Factors` can change while K stays."""

    D: Array
    F: Array
    rho_d: float
    rho_s: float


@dataclass(frozen=True)
class State:
    """Factors with the sums that belong to their K."""

    factors: Factors
    sums: Sums

    @property
    def product(self) -> Array:
        """D F, shape (theta_h, theta_d)."""
        return np.outer(self.factors.D, self.factors.F)

    def with_factors(self, **changed: Unpack[Changed]) -> "State":
        """Return the state with D, F or the coefficients replaced; K stays."""
        return replace(self, factors=replace(self.factors, **changed))

    def with_coefficients(self) -> "State":
        """Return the state with its best rho_d and rho_s."""
        rho_d, rho_s = coefficients(self.sums, self.product)
        return self.with_factors(rho_d=rho_d, rho_s=rho_s)


class ChannelProblem(ABC, Generic[S]):
    """The fit of one channel of a model with a K (see `npfm.fitting.solvers.problem.Problem`).

    Parameters
    ----------
    samples : Samples
        Measurements of one channel.
    clamp : float
        Smallest component of a factor whose largest is 1.
    """

    def __init__(self, samples: Samples, clamp: float):
        self.samples = samples
        self.clamp = clamp

    @property
    def energy(self) -> float:
        """Objective of the zero model."""
        return self.samples.energy

    @property
    def lower(self) -> float:
        """Least logarithm of a component of a factor whose largest is 1."""
        return float(np.log(max(self.clamp, SMALLEST)))

    @abstractmethod
    def sums(self, modulation: Array) -> Sums:
        """Sums over phi_d for a modulation."""

    @property
    @abstractmethod
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, F and the modulation any sample depends on."""

    @abstractmethod
    def objective(self, state: S) -> float:
        """Objective of equation 7, the floor included."""

    @abstractmethod
    def between(self, before: S, after: S, t: float) -> S:
        """Return the state a share `t` of the way from one to another."""

    def along(self, before: S, after: S) -> Callable[[float], float]:
        """Objective on the way from one state to another."""
        return lambda t: self.objective(self.between(before, after, t))


class FactorProblem(ChannelProblem[State]):
    """The fit of one channel of a one-product model; see `ChannelProblem` for its parameters."""

    #: Power of the modulation in K.
    degree = 1

    def state(self, D: Array, F: Array, modulation: Array) -> State:
        """Return the state of given factors with its best coefficients.

        Factors are scaled to maximum 1 and clamped; components that no sample depends on are
        interpolated from their neighbours, or take the nearest value at an end.
        """
        D, F, modulation = (
            filled(np.asarray(x, dtype=float), seen, self.clamp)
            for x, seen in zip((D, F, modulation), self.seen, strict=True)
        )
        return State(Factors(D, F, modulation, 0.0, 0.0), self.sums(modulation)).with_coefficients()

    def pack(self, state: State) -> Array:
        """Logarithms of the factors, one after the other."""
        f = state.factors
        return np.log(np.maximum(np.concatenate([f.D, f.F, f.modulation]), SMALLEST))

    def unpack(self, packed: Array) -> State:
        """Return the state of packed factors (see `state`)."""
        nh, nd, _ = self.samples.grid.shape
        return self.state(*np.split(np.exp(packed), [nh, nh + nd]))

    @staticmethod
    def bounded(gradient: Array, matrix: Array, rho_d: float) -> tuple[Array, Array]:
        """Drop rho_d, the last unknown, where it is 0 and would fall further."""
        if rho_d == 0 and gradient[-1] > 0:
            gradient[-1], matrix[-1], matrix[:, -1] = 0.0, 0.0, 0.0
        return gradient, matrix

    def tops(self, packed: Array) -> NDArray[np.intp]:
        """Return, for each packed unknown, where the largest component of its factor is."""
        nh, nd, _ = self.samples.grid.shape
        first, tops = 0, []
        for factor in np.split(packed, [nh, nh + nd]):
            tops.append(np.full(factor.size, first + np.argmax(factor) if factor.size else 0))
            first += factor.size
        return np.concatenate(tops)

    def objective(self, state: State) -> float:
        """Objective of equation 7, the floor included."""
        f = state.factors
        reached = state.sums.objective(state.product, f.rho_d, f.rho_s)
        return self.samples.floor + max(reached, 0.0)  # below 0 by rounding only

    def between(self, before: State, after: State, t: float) -> State:
        """Interpolate what differs between two states."""
        a, b = before.factors, after.factors
        modulation = (
            a.modulation
            if a.modulation is b.modulation
            else (1 - t) * a.modulation + t * b.modulation
        )
        mixed = Factors(
            (1 - t) * a.D + t * b.D,
            (1 - t) * a.F + t * b.F,
            modulation,
            (1 - t) * a.rho_d + t * b.rho_d,
            (1 - t) * a.rho_s + t * b.rho_s,
        )
        return State(mixed, before.sums if a.modulation is b.modulation else self.sums(modulation))

    def normalised(self, state: State) -> State:
        """Return the same model with each factor scaled to maximum 1, rho_s taking the scale."""
        f = state.factors
        tops = f.D.max(), f.F.max(), f.modulation.max() ** self.degree
        factors = Factors(
            f.D / tops[0],
            f.F / tops[1],
            f.modulation / f.modulation.max(),
            f.rho_d,
            f.rho_s * tops[0] * tops[1] * tops[2],
        )
        return State(factors, state.sums.scaled(1 / tops[2]))


def updated_D(state: State, clamp: float) -> State:
    """AWLS update of D (equation 14 with the substitution of section 4.2), clamped."""
    f, sums = state.factors, state.sums
    numerator = (sums.wrk - f.rho_d * sums.wk) @ f.F
    denominator = f.rho_s * (sums.wkk @ f.F**2)
    return state.with_factors(D=quotient(numerator, denominator, f.D, clamp))


def updated_F(state: State, clamp: float) -> State:
    """AWLS update of F (equation 14), clamped."""
    f, sums = state.factors, state.sums
    numerator = f.D @ (sums.wrk - f.rho_d * sums.wk)
    denominator = f.rho_s * (f.D**2 @ sums.wkk)
    return state.with_factors(F=quotient(numerator, denominator, f.F, clamp))


def filled(factor: Array, seen: NDArray[np.bool_], clamp: float) -> Array:
    """Return a factor scaled to maximum 1 and clamped, unseen components interpolated."""
    if not seen.any():
        return np.ones_like(factor)
    bins = np.arange(factor.size)
    factor = np.interp(bins, bins[seen], factor[seen])
    return np.maximum(factor / factor.max(), clamp)


def quotient(numerator: Array, denominator: Array, before: Array, clamp: float) -> Array:
    """Equation 14 for each component of a factor, at least `clamp` times the largest one.

    Components that no sample touches (denominator 0) are interpolated from their neighbours,
    or take the value of the nearest one at an end. Where nothing positive comes out, the
    factor stays as it was.
    """
    seen = denominator > 1e-300
    if not seen.any():
        return before
    solved = numerator[seen] / denominator[seen]
    if not (np.isfinite(solved).all() and solved.max() > 0):
        return before
    bins = np.arange(before.size)
    return np.maximum(np.interp(bins, bins[seen], solved), clamp * solved.max())
