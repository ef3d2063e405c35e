"""Passes over pairs of directions of a fit of shared lobes on a directional grid, compiled.

They are beside those of `npfm.fitting.shared_lobes.kernels`, and compiled as these are.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.compilation import compiled

Array = NDArray[np.float64]
Nodes = NDArray[np.int16]


@compiled("(i2[:,::1], f8[:,::1], f8[::1], f8[::1], f8[::1], f8)")
def relaxed(
    nodes: Nodes, taps: Array, square: Array, linear: Array, before: Array, clamp: float
) -> Array:
    """Minimise sum_r a_r y_r^2 - 2 b_r y_r over one node of y after the other, exactly.

    y_r is a weighted sum of the nodes that row r reads. Section 2.4 of Peng et al. 2017: each
    component is the least point of a parabola, at least `clamp` times the largest one before.

    Parameters
    ----------
    nodes, taps : ndarray, shape (rows, n)
    square, linear : ndarray, shape (rows,)
        a and b.
    before : ndarray, shape (nodes,)

    Returns
    -------
    ndarray, shape (nodes,)
    """
    rows, width = nodes.shape
    x, y, least = before.copy(), np.zeros(rows), clamp * before.max()
    count = np.zeros(x.size + 1, np.int64)
    for row in range(rows):
        for t in range(width):
            y[row] += taps[row, t] * x[nodes[row, t]]
            count[nodes[row, t] + 1] += 1
    ends = np.cumsum(count)
    place, readers = ends[:-1].copy(), np.zeros(rows * width, np.int64)
    for row in range(rows):
        for t in range(width):
            readers[place[nodes[row, t]]] = row * width + t
            place[nodes[row, t]] += 1
    for node in range(x.size):
        above, below = 0.0, 0.0
        previous, share = -1, 0.0
        for reader in readers[ends[node] : ends[node + 1]]:
            row, t = reader // width, reader % width
            # A row that reads the node twice, at the normal, has the sum of its weights.
            if row == previous:
                above -= share * (linear[row] - square[row] * (y[row] - share * x[node]))
                below -= share * share * square[row]
                share += taps[row, t]
            else:
                share = taps[row, t]
            above += share * (linear[row] - square[row] * (y[row] - share * x[node]))
            below += share * share * square[row]
            previous = row
        if below <= 1e-300:
            continue
        change = max(above / below, least) - x[node]
        for reader in readers[ends[node] : ends[node + 1]]:
            y[reader // width] += change * taps[reader // width, reader % width]
        x[node] += change
    return np.maximum(x, clamp * x.max())


@compiled(
    "(f8[:,:], f8[:,:], i2[:,::1], f8[:,::1], i2[:,::1], f8[:,::1], i2[:], i2[:], f8[:],"
    " f8[:,::1], f8[:,::1], f8[:,::1], f8[:,::1], f8[::1])"
)
def equations_of_pairs(
    weight: Array,
    weighted_value: Array,
    d_nodes: Nodes,
    d_taps: Array,
    f_nodes: Nodes,
    f_taps: Array,
    g_i: Nodes,
    g_o: Nodes,
    inverse_cosines: Array,
    D: Array,
    F: Array,
    G: Array,
    rho_s: Array,
    rho_d: Array,
) -> tuple[Array, Array]:
    """As `kernels.normal_equations`, for samples that share nothing but nodes: pairs of directions.

    What D and G share between the channels is added up over these first.

    Parameters
    ----------
    weight, weighted_value : ndarray, shape (channels, n)
    d_nodes, d_taps, f_nodes, f_taps : ndarray, shapes (n, 4) and (n, 2)
    g_i, g_o, inverse_cosines : ndarray, shape (n,)
        Nodes of G, and 1 / (cos theta_i cos theta_o).

    Returns
    -------
    gradient : ndarray, shape (n,)
    matrix : ndarray, shape (n, n)
        Symmetric.
    """
    channels, samples = weight.shape
    lobes, nodes, nd, taps = D.shape[0], D.shape[1], F.shape[1], d_nodes.shape[1]
    at_f = lobes * nodes
    at_g = at_f + channels * nd
    at_s = at_g + lobes * G.shape[1]
    at_d = at_s + channels * lobes
    size = at_d + channels
    gradient, diagonal, matrix = np.zeros(size), np.zeros(size), np.zeros((size, size))
    of_d, of_k, y = np.zeros(lobes), np.zeros(lobes), np.zeros((channels, lobes))
    pair, slope = np.zeros((lobes, lobes)), np.zeros(lobes)
    # The unknowns of D and G that a sample depends on: for each lobe its taps of D, then two of G.
    each = taps + 2
    at, part = np.zeros(lobes * each, np.int64), np.zeros(lobes * each)
    own, mine = np.zeros(2 + lobes + 1, np.int64), np.zeros(2 + lobes + 1)
    for n in range(samples):
        for a in range(lobes):
            of_d[a] = 0.0
            of_k[a] = G[a, g_i[n]] * G[a, g_o[n]] * inverse_cosines[n]
            for t in range(taps):
                k = a * each + t
                at[k], part[k] = a * nodes + d_nodes[n, t], d_taps[n, t] * D[a, d_nodes[n, t]]
                of_d[a] += part[k]
            k = a * each + taps
            at[k], part[k] = at_g + a * G.shape[1] + g_i[n], of_d[a]
            at[k + 1], part[k + 1] = at_g + a * G.shape[1] + g_o[n], of_d[a]
            slope[a] = 0.0
            for b in range(lobes):
                pair[a, b] = 0.0
        for c in range(channels):
            w = weight[c, n]
            if w == 0.0:
                continue
            f = f_taps[n, 0] * F[c, f_nodes[n, 0]] + f_taps[n, 1] * F[c, f_nodes[n, 1]]
            specular = 0.0
            for a in range(lobes):
                y[c, a] = rho_s[c, a] * f * of_k[a]
                specular += y[c, a] * of_d[a]
            wr = w * (rho_d[c] + specular) - weighted_value[c, n]
            for t in range(2):
                own[t] = at_f + c * nd + f_nodes[n, t]
                mine[t] = f_taps[n, t] * F[c, f_nodes[n, t]] * specular / f
            for a in range(lobes):
                own[2 + a], mine[2 + a] = at_s + c * lobes + a, y[c, a] * of_d[a]
                slope[a] += wr * y[c, a]
                for b in range(lobes):
                    pair[a, b] += w * y[c, a] * y[c, b]
            own[2 + lobes], mine[2 + lobes] = at_d + c, 1.0
            for k in range(own.size):
                gradient[own[k]] += wr * mine[k]
                diagonal[own[k]] += w * mine[k] * mine[k]
                for m in range(k + 1, own.size):
                    matrix[own[k], own[m]] += w * mine[k] * mine[m]
                for a in range(lobes):
                    product = w * mine[k] * y[c, a]
                    for m in range(a * each, (a + 1) * each):
                        matrix[own[k], at[m]] += product * part[m]
        for a in range(lobes):
            for k in range(a * each, (a + 1) * each):
                gradient[at[k]] += slope[a] * part[k]
                diagonal[at[k]] += pair[a, a] * part[k] * part[k]
                for m in range(k + 1, (a + 1) * each):
                    matrix[at[k], at[m]] += pair[a, a] * part[k] * part[m]
                for b in range(a + 1, lobes):
                    product = pair[a, b] * part[k]
                    for m in range(b * each, (b + 1) * each):
                        matrix[at[k], at[m]] += product * part[m]
    matrix += matrix.T.copy()
    for k in range(size):
        matrix[k, k] += diagonal[k]
    return gradient, matrix
