"""The extended AWLS of Peng et al. 2017: exact updates of one factor at a time."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.shared_lobes.problem import CLAMP, State, compiled

if TYPE_CHECKING:
    from npfm.fitting.shared_lobes.problem import LobesProblem

Array = NDArray[np.float64]


def updated_D(problem: "LobesProblem", lobe: int, state: State) -> State:
    """Best D of a lobe, all else held, of the samples of all channels."""
    wk, wkk, wrk = state.sums
    x = state.rho_s[:, None, :] * problem.basis(state)
    slope = state.rho_s[:, lobe, None] * problem.F_at(state.F)
    others = np.einsum("crl,crl->cr", x, wkk[..., lobe, :]) - x[..., lobe] * wkk[..., lobe, lobe]
    numerator = slope * (wrk[..., lobe] - state.rho_d[:, None] * wk[..., lobe] - others)
    denominator = slope**2 * wkk[..., lobe, lobe]
    D = problem.solved_D(numerator, denominator, state.D[lobe])
    return replace(state, D=np.stack([D if k == lobe else x for k, x in enumerate(state.D)]))


def updated_F(problem: "LobesProblem", state: State) -> State:
    """Best F of every channel, all else held."""
    wk, wkk, wrk = state.sums
    x = state.rho_s[:, None, :] * problem.D_at(state.D)
    wx = np.einsum("crl,crl->cr", x, wk)
    numerator = np.einsum("crl,crl->cr", x, wrk) - state.rho_d[:, None] * wx
    denominator = np.einsum("crl,crm,crlm->cr", x, x, wkk, optimize=True)
    F = [problem.solved_F(n, d, f) for n, d, f in zip(numerator, denominator, state.F, strict=True)]
    return replace(state, F=np.stack(F))


def updated_G(problem: "LobesProblem", lobe: int, smoothing: float, state: State) -> State:
    """Minimise over the components of a lobe's G one after the other, exactly (section 2.3).

    In one component the objective is a polynomial of degree 4. Of the real roots of its
    derivative, a cubic, the best is taken, if it is better than the component is.

    Parameters
    ----------
    smoothing : float
        Width of the Gaussian that smooths the result, in nodes.
    """
    kernels, at = compiled(), problem.places
    x = np.ascontiguousarray(state.rho_s[:, None, :] * problem.basis(state))
    square, linear = kernels.one_lobe(*problem._arrays, x, state.G, state.rho_d, lobe)
    G, (ends, cells) = state.G[lobe].copy(), at.readers
    least = CLAMP * G.max()
    for node in range(G.size):
        readers = cells[ends[node] : ends[node + 1]]
        quartic = kernels.node_quartic(*at.arrays[:4], readers, square, linear, G, node)
        G[node] = best_component(quartic, G[node], least)
    if smoothing:
        G = problem.smoothed(G, smoothing)
    G = np.maximum(G, CLAMP * G.max())
    return problem._with_G(state, np.stack([G if k == lobe else g for k, g in enumerate(state.G)]))


def best_component(quartic: Array, now: float, least: float) -> float:
    """Least point of a polynomial of degree 4 on [least, infinity).

    Parameters
    ----------
    quartic : ndarray, shape (4,)
        Coefficients of x, x^2, x^3 and x^4.
    now : float
        Taken where nothing is better.
    least : float
        Lower bound.
    """
    scale = np.abs(quartic).max()
    if scale == 0:
        return now
    derivative = np.arange(4, 0, -1) * quartic[::-1] / scale
    roots = np.roots(derivative)
    real = roots.real[np.abs(roots.imag) <= 1e-9 * (1 + np.abs(roots.real))]
    candidates = [now, *np.maximum(real, least)]
    values = [np.polyval([*quartic[::-1], 0.0], x) for x in candidates]
    return float(candidates[int(np.argmin(values))])
