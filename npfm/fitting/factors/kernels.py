"""Passes over all samples of a microfacet fit, compiled.

These loops are where a fit spends its time; written with array operations they take several
times as long (docs/performance.md). Samples lie as (theta_h * theta_d, phi_d) arrays; each reads
G at theta_i and theta_o, linearly between the nodes `node` and `node + 1` at `part` of the way.

They are compiled, or taken from numba's cache, when this module is imported: before any clock runs.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.compilation import compiled

Array = NDArray[np.float64]

#: Types of what every pass takes: weight, weighted_value, node_i, part_i, node_o, part_o and
#: inverse_cosines.
SAMPLES = "f8[:,::1], f8[:,::1], i2[:,::1], f8[:,::1], i2[:,::1], f8[:,::1], f8[:,::1]"


@compiled(f"({SAMPLES}, f8[::1])")
def kernel_sums(
    weight: Array,
    weighted_value: Array,
    node_i: NDArray[np.int16],
    part_i: Array,
    node_o: NDArray[np.int16],
    part_o: Array,
    inverse_cosines: Array,
    G: Array,
) -> tuple[Array, Array, Array]:
    """Sums over phi_d of wK, wK^2 and wrK, each of shape (theta_h * theta_d,)."""
    rows, columns = weight.shape
    wk, wkk, wrk = np.zeros(rows), np.zeros(rows), np.zeros(rows)
    for row in range(rows):
        for p in range(columns):
            w = weight[row, p]
            if w == 0.0:
                continue
            i, o = node_i[row, p], node_o[row, p]
            g_i = G[i] + part_i[row, p] * (G[i + 1] - G[i])
            g_o = G[o] + part_o[row, p] * (G[o + 1] - G[o])
            k = g_i * g_o * inverse_cosines[row, p]
            wk[row] += w * k
            wkk[row] += w * k * k
            wrk[row] += weighted_value[row, p] * k
    return wk, wkk, wrk


@compiled(f"({SAMPLES}, f8[::1], f8, f8[::1])")
def masking_shadowing_equations(
    weight: Array,
    weighted_value: Array,
    node_i: NDArray[np.int16],
    part_i: Array,
    node_o: NDArray[np.int16],
    part_o: Array,
    inverse_cosines: Array,
    slope: Array,
    rho_d: float,
    other: Array,
) -> tuple[Array, Array, Array]:
    """Tridiagonal normal equations of G at one of its two places, `other` being G at the other.

    Folded samples count once with their light and once with their view at the place sought.
    `slope` is rho_s D F, shape (theta_h * theta_d,).

    Returns
    -------
    diagonal, beside, right : ndarray, shape of other
        `beside[k]` couples nodes k - 1 and k; `right` is the right-hand side.
    """
    diagonal, beside, right = np.zeros_like(other), np.zeros_like(other), np.zeros_like(other)
    rows, columns = weight.shape
    for row in range(rows):
        for p in range(columns):
            w = weight[row, p]
            if w == 0.0:
                continue
            residual = weighted_value[row, p] - rho_d * w
            scale = slope[row] * inverse_cosines[row, p]
            for place in range(2):
                if place == 0:
                    node, part = node_i[row, p], part_i[row, p]
                    far, far_part = node_o[row, p], part_o[row, p]
                else:
                    node, part = node_o[row, p], part_o[row, p]
                    far, far_part = node_i[row, p], part_i[row, p]
                y = scale * (other[far] + far_part * (other[far + 1] - other[far]))
                low, high = y * (1 - part), y * part
                diagonal[node] += w * low * low
                diagonal[node + 1] += w * high * high
                beside[node + 1] += w * low * high
                right[node] += residual * low
                right[node + 1] += residual * high
    return diagonal, beside, right


@compiled("(f8[::1], f8[:,::1], f8[::1], i8, i8, f8, f8, f8)")
def _eliminate(
    gradient: Array,
    matrix: Array,
    row_g: Array,
    lowest: int,
    highest: int,
    sum_wx: float,
    sum_wxx: float,
    sum_wxr: float,
) -> None:
    """Subtract what eliminating log B of a cell takes from the equations (Schur complement)."""
    last = gradient.size - 1
    gradient[last] -= sum_wx * sum_wxr / sum_wxx
    matrix[last, last] -= sum_wx * sum_wx / sum_wxx
    for k in range(lowest, highest + 1):
        share = row_g[k] / sum_wxx
        gradient[k] -= share * sum_wxr
        matrix[k, last] -= share * sum_wx
        for other in range(k, highest + 1):
            matrix[k, other] -= share * row_g[other]


@compiled(f"({SAMPLES}, f8[:,::1], f8[::1], f8, b1)")
def normal_equations(
    weight: Array,
    weighted_value: Array,
    node_i: NDArray[np.int16],
    part_i: Array,
    node_o: NDArray[np.int16],
    part_o: Array,
    inverse_cosines: Array,
    product: Array,
    G: Array,
    rho_d: float,
    projected: bool,
) -> tuple[Array, Array]:
    """Gradient J'Wr and Gauss-Newton matrix J'WJ in (log D, log F, log G, rho_d).

    With x = product K, the derivative of the model is x in log D and log F of the sample's
    bins, 1 in rho_d, and x times its share of the interpolated G in log G of each node read.

    Parameters
    ----------
    product : ndarray, shape (theta_h, theta_d)
        rho_s D F, or a B that is free in each cell.
    projected : bool
        Take the product for such a B and eliminate it: the unknowns are (log G, rho_d) then.

    Returns
    -------
    gradient : ndarray, shape (n,)
    matrix : ndarray, shape (n, n)
        Only the upper triangle is filled.
    """
    nh, nd = product.shape
    first_g = 0 if projected else nh + nd
    last = first_g + G.size
    gradient, matrix = np.zeros(last + 1), np.zeros((last + 1, last + 1))
    row_g, nodes, shares = np.zeros(G.size), np.zeros(4, np.int64), np.zeros(4)
    for row in range(nh * nd):
        h, d = row // nd, row % nd
        cell = product[h, d]
        sum_w, sum_wx, sum_wxx, sum_wxr, sum_wr = 0.0, 0.0, 0.0, 0.0, 0.0
        lowest, highest = G.size, -1
        for p in range(weight.shape[1]):
            w = weight[row, p]
            if w == 0.0:
                continue
            i, o = node_i[row, p], node_o[row, p]
            low_i, high_i = (1 - part_i[row, p]) * G[i], part_i[row, p] * G[i + 1]
            low_o, high_o = (1 - part_o[row, p]) * G[o], part_o[row, p] * G[o + 1]
            g_i, g_o = low_i + high_i, low_o + high_o
            x = cell * g_i * g_o * inverse_cosines[row, p]
            wr = w * (rho_d + x) - weighted_value[row, p]
            wx, wxr, wxx = w * x, wr * x, w * x * x
            sum_w += w
            sum_wr += wr
            sum_wx += wx
            sum_wxr += wxr
            sum_wxx += wxx
            lowest, highest = min(lowest, i, o), max(highest, i + 1, o + 1)
            nodes[0], nodes[1], nodes[2], nodes[3] = i, i + 1, o, o + 1
            shares[0], shares[1] = low_i / g_i, high_i / g_i
            shares[2], shares[3] = low_o / g_o, high_o / g_o
            for a in range(4):
                at, share = nodes[a], shares[a]
                row_g[at] += wxx * share
                gradient[first_g + at] += wxr * share
                matrix[first_g + at, last] += wx * share
                for b in range(4):
                    if nodes[b] >= at:
                        matrix[first_g + at, first_g + nodes[b]] += wxx * share * shares[b]
        gradient[last] += sum_wr
        matrix[last, last] += sum_w
        if projected:
            if sum_wxx > 0.0:
                _eliminate(gradient, matrix, row_g, lowest, highest, sum_wx, sum_wxx, sum_wxr)
        else:
            for at in (h, nh + d):
                gradient[at] += sum_wxr
                matrix[at, at] += sum_wxx
                matrix[at, last] += sum_wx
                for k in range(lowest, highest + 1):
                    matrix[at, first_g + k] += row_g[k]
            matrix[h, nh + d] += sum_wxx
        row_g[lowest : highest + 1] = 0.0
    return gradient, matrix
