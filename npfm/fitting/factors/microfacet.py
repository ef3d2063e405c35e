"""Equation 3 of Bagher et al. 2016 on a grid: what the microfacet models share.

rho = rho_d + rho_s D(theta_h) F(theta_d) K with
K = G(theta_i) G(theta_o) / (cos theta_i cos theta_o).

Numba and parts of SciPy take half a second to import. Only functions that fit import them, so that
a job that renders a fit does not wait for them.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from types import ModuleType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.factors.problem import (
    ChannelProblem,
    FactorProblem,
    State,
    Sums,
    updated_D,
    updated_F,
)
from npfm.fitting.objective import Samples
from npfm.fitting.solvers.problem import S
from npfm.reflectance.half_difference import HalfDifference

Array = NDArray[np.float64]

#: Nodes of G: 90, at the centres of one-degree bins of theta_i and theta_o (section 4.3).
G_NODES = 90
G_THETA = (np.arange(G_NODES) + 0.5) / G_NODES * np.pi / 2
#: Updates of D, F and the coefficients with which a start is fitted to its G.
WARM_UP_SWEEPS = 20
#: How strongly components of G that hardly any sample sees are held where they are.
PROXIMAL = 1e-9


@dataclass(frozen=True)
class Elevations:
    """theta_i and theta_o of cells with phi_d in its first half, ready for interpolating G.

    Parameters
    ----------
    node_i, node_o : ndarray of int16, shape (theta_h * theta_d, phi_d)
        The node of G at or below the angle.
    part_i, part_o : ndarray
        How far the angle is on the way to the next node, in [0, 1].
    inverse_cosines : ndarray
        1 / (cos theta_i cos theta_o), 0 below the horizon. Angles beyond the last node of G (89.5
        degrees) are taken at the node, in G and in the cosine, so that nothing grows without
        bound at grazing.
    """

    node_i: NDArray[np.int16]
    part_i: Array
    node_o: NDArray[np.int16]
    part_o: Array
    inverse_cosines: Array

    @property
    def arrays(self) -> tuple[NDArray, ...]:
        """All of it, in the order of the arguments of `npfm.fitting.factors.kernels`."""
        return self.node_i, self.part_i, self.node_o, self.part_o, self.inverse_cosines


def compiled() -> ModuleType:
    """Return `npfm.fitting.factors.kernels`; a fit calls this first, before time is taken."""
    from npfm.fitting.factors import kernels

    return kernels


@lru_cache(maxsize=4)
def elevations(grid: HalfDifference, every: int = 1) -> Elevations:
    """Elevations of the folded half of a grid, of every n-th bin of phi_d from the middle on."""
    half = grid.phi_d_bins // 2
    kept = slice(every // 2, half, every)
    nodes, parts, cosines = [], [], []
    for cosine in grid.cosines:
        theta = np.clip(np.arccos(np.clip(cosine[..., kept], -1, 1)), G_THETA[0], G_THETA[-1])
        place = (theta - G_THETA[0]) / (G_THETA[1] - G_THETA[0])
        place = place.reshape(-1, place.shape[-1])
        node = np.minimum(place, G_NODES - 2).astype(np.int16)
        nodes.append(node)
        parts.append(place - node)
        cosines.append(np.cos(theta))
    inverse = np.where(grid.above_horizon[..., kept], 1 / (cosines[0] * cosines[1]), 0.0)
    return Elevations(nodes[0], parts[0], nodes[1], parts[1], inverse.reshape(nodes[0].shape))


def kernel(at: Elevations, G: Array) -> Array:
    """K at each cell for a masking-shadowing factor G, shape (G_NODES,)."""
    slopes = np.append(np.diff(G), 0.0)
    at_i = G[at.node_i] + at.part_i * slopes[at.node_i]
    at_o = G[at.node_o] + at.part_o * slopes[at.node_o]
    return at_i * at_o * at.inverse_cosines


class MaskedProblem(ChannelProblem[S]):
    """The fit of one channel of a model with a G, on folded samples.

    Parameters
    ----------
    samples : Samples
        Folded measurements of one channel.
    clamp : float
        Smallest component of a factor whose largest is 1.
    every : int
        Use every n-th bin of phi_d only.
    """

    def __init__(self, samples: Samples, clamp: float, every: int = 1):
        kept = slice(every // 2, None, every)
        thinned = replace(
            samples,
            weight=samples.weight[..., kept],
            value=samples.value[..., kept],
            floor=samples.floor / every,
        )
        super().__init__(thinned if every > 1 else samples, clamp)
        self._unthinned = samples
        self.elevations = elevations(samples.grid, every)
        shape = self.elevations.part_i.shape
        self.weight = np.ascontiguousarray(self.samples.weight.reshape(shape))
        self.weighted_value = self.weight * self.samples.value.reshape(shape)
        plane = samples.grid.shape[:2]
        self._fixed = self.weight.sum(1).reshape(plane), self.weighted_value.sum(1).reshape(plane)
        self._wrr = float(np.vdot(self.weighted_value, self.samples.value))

    def thinned(self, every: int) -> Self:
        """Return the same fit on every n-th bin of phi_d."""
        return type(self)(self._unthinned, self.clamp, every)

    @property
    def _arrays(self) -> tuple[NDArray, ...]:
        return self.weight, self.weighted_value, *self.elevations.arrays

    @cached_property
    def seen(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
        """Which components of D, F and G any sample depends on."""
        at, counts = self.elevations, self.weight > 0
        reads = np.zeros(G_NODES)
        for node, part in ((at.node_i, at.part_i), (at.node_o, at.part_o)):
            reads += np.bincount(node[counts], 1 - part[counts], minlength=G_NODES)
            reads += np.bincount(node[counts] + 1, part[counts], minlength=G_NODES)
        weight = self._fixed[0]
        return weight.sum(1) > 0, weight.sum(0) > 0, reads > 0

    def sums(self, modulation: Array) -> Sums:
        """Sums over phi_d for a masking-shadowing factor, shape (G_NODES,)."""
        plane = self.samples.grid.shape[:2]
        sums = compiled().kernel_sums(*self._arrays, modulation)
        wk, wkk, wrk = (x.reshape(plane) for x in sums)
        return Sums(*self._fixed, wk, wkk, wrk, self._wrr)

    def updated_G(self, slope: Array, rho_d: float, G: Array, smoothing: float) -> Array:
        """AWLS update of G: solve for G_i, then for G_o, and average the two (section 4.3).

        Parameters
        ----------
        slope : ndarray, shape (theta_h, theta_d)
            What stands before K: rho_s D F.
        smoothing : float
            Width of the Gaussian that smooths the result, in nodes.
        """
        from scipy.ndimage import gaussian_filter1d

        first = self._solved_G(slope, rho_d, G, G)
        G = (first + self._solved_G(slope, rho_d, G, first)) / 2
        if smoothing:
            G = gaussian_filter1d(G, smoothing, mode="nearest")
        return np.maximum(G, self.clamp * G.max())

    def _solved_G(self, slope: Array, rho_d: float, G: Array, other: Array) -> Array:
        """Least-squares G at one of its places, `other` at the other (tridiagonal: G is linear)."""
        from scipy.linalg import solveh_banded

        diagonal, beside, right = compiled().masking_shadowing_equations(
            *self._arrays, slope.ravel(), rho_d, other
        )
        hold = PROXIMAL * diagonal.max() or 1.0
        solved = solveh_banded(np.stack([beside, diagonal + hold]), right + hold * G)
        return np.maximum(solved, self.clamp * solved.max()) if solved.max() > 0 else G


class MicrofacetProblem(MaskedProblem[State], FactorProblem):
    """The fit of one channel of equation 3; see `MaskedProblem` for its parameters.

    A model supplies `stages`.
    """

    degree = 2

    @property
    def inner(self) -> tuple[Callable[[State], State], ...]:
        """AWLS updates of all but G, which cost next to nothing."""
        return (
            lambda state: updated_D(state, self.clamp),
            lambda state: updated_F(state, self.clamp),
            State.with_coefficients,
        )

    def warmed_up(self, state: State) -> State:
        """Return the state after updates of all but G, as long as they help."""
        for update in self.inner * WARM_UP_SWEEPS:
            candidate = update(state)
            if self.objective(candidate) > self.objective(state):
                break
            state = candidate
        return self.normalised(state)

    def normal_equations(self, state: State) -> tuple[Array, Array]:
        """Gradient and Gauss-Newton matrix in the logarithms of D, F and G, then rho_d."""
        f = state.factors
        product = np.outer(f.rho_s * f.D, f.F)
        gradient, upper = compiled().normal_equations(
            *self._arrays, product, f.modulation, f.rho_d, False
        )
        return self.bounded(gradient, upper + np.triu(upper, 1).T, f.rho_d)


def tabulate_channel(
    grid: HalfDifference, D: NDArray, F: NDArray, G: NDArray, rho_d: float, rho_s: float
) -> Array:
    """Equation 3 at every cell of a grid for one channel; below the horizon it is rho_d.

    Returns
    -------
    ndarray, shape grid.shape
        BRDF in the units of rho_d and rho_s.
    """
    product = np.outer(np.asarray(D, dtype=float), np.asarray(F, dtype=float))
    return tabulate_product(grid, product, G, rho_d, rho_s)


def tabulate_product(
    grid: HalfDifference, B: NDArray, G: NDArray, rho_d: float, rho_s: float
) -> Array:
    """Equation 3 with B(theta_h, theta_d) in place of D F (see `tabulate_channel`)."""
    half = kernel(elevations(grid), np.asarray(G, dtype=float))
    whole = np.concatenate([half, half[:, ::-1]], axis=1).reshape(grid.shape)
    return float(rho_d) + float(rho_s) * B[..., None] * whole
