"""Passes over all samples of all channels of a fit of shared lobes, compiled.

Samples lie as (channels, theta_h * theta_d, phi_d) arrays. Each reads every lobe's G at theta_i and
theta_o, as sums of `taps` over the nodes from `first` on, which all channels have in common.
They are compiled as those of one channel are (`npfm.fitting.factors.kernels`).
"""

import numpy as np
from numpy.typing import NDArray

from npfm.compilation import compiled

Array = NDArray[np.float64]
Nodes = NDArray[np.int16]

#: Types of what most passes take: first_i, taps_i, first_o and taps_o, then all with the samples.
PLACES = "i2[:,::1], f8[:,:,::1], i2[:,::1], f8[:,:,::1]"
SAMPLES = f"f8[:,:,::1], f8[:,:,::1], {PLACES}, f8[:,::1]"


@compiled(f"({SAMPLES}, f8[:,::1])")
def kernel_sums(
    weight: Array,
    weighted_value: Array,
    first_i: Nodes,
    taps_i: Array,
    first_o: Nodes,
    taps_o: Array,
    inverse_cosines: Array,
    G: Array,
) -> tuple[Array, Array, Array]:
    """Sums over phi_d of wK, wKK' and wrK for the K of every lobe.

    Parameters
    ----------
    G : ndarray, shape (lobes, nodes)

    Returns
    -------
    wk, wkk, wrk : ndarray, shapes (channels, rows, lobes), with (lobes, lobes), (lobes,)
    """
    channels, rows, columns = weight.shape
    lobes, taps = G.shape[0], taps_i.shape[2]
    wk, wrk = np.zeros((channels, rows, lobes)), np.zeros((channels, rows, lobes))
    wkk, k = np.zeros((channels, rows, lobes, lobes)), np.zeros(lobes)
    for row in range(rows):
        for p in range(columns):
            inverse = inverse_cosines[row, p]
            if inverse == 0.0:
                continue
            i, o = first_i[row, p], first_o[row, p]
            for a in range(lobes):
                g_i, g_o = 0.0, 0.0
                for t in range(taps):
                    g_i += taps_i[row, p, t] * G[a, i + t]
                    g_o += taps_o[row, p, t] * G[a, o + t]
                k[a] = g_i * g_o * inverse
            for c in range(channels):
                w, wr = weight[c, row, p], weighted_value[c, row, p]
                if w == 0.0:
                    continue
                for a in range(lobes):
                    wk[c, row, a] += w * k[a]
                    wrk[c, row, a] += wr * k[a]
                    for b in range(a + 1):
                        wkk[c, row, a, b] += w * k[a] * k[b]
    for a in range(lobes):
        for b in range(a):
            wkk[:, :, b, a] = wkk[:, :, a, b]
    return wk, wkk, wrk


@compiled("(f8[:,::1], f8[:,::1], f8[:,:,::1], f8[:,:,:,::1], f8[:,:,::1], f8[::1], f8[::1])")
def coefficient_equations(
    D: Array, F: Array, wk: Array, wkk: Array, wrk: Array, w: Array, wr: Array
) -> tuple[Array, Array]:
    """Equations of rho_d and the rho_s of each channel: sums over its rows.

    Parameters
    ----------
    D, F : ndarray, shapes (rows, lobes), (channels, rows)
        Their values in each row.
    wk, wkk, wrk : ndarray
        See `kernel_sums`.
    w, wr : ndarray, shape (channels,)
        Sums of the weights and of the weighted values.

    Returns
    -------
    matrix, right : ndarray, shapes (channels, lobes + 1, lobes + 1), (channels, lobes + 1)
    """
    channels, rows, lobes = wk.shape
    matrix, right = np.zeros((channels, lobes + 1, lobes + 1)), np.zeros((channels, lobes + 1))
    b = np.zeros(lobes)
    for c in range(channels):
        matrix[c, 0, 0], right[c, 0] = w[c], wr[c]
        for row in range(rows):
            for k in range(lobes):
                b[k] = D[row, k] * F[c, row]
                matrix[c, 0, k + 1] += b[k] * wk[c, row, k]
                right[c, k + 1] += b[k] * wrk[c, row, k]
                for m in range(k + 1):
                    matrix[c, m + 1, k + 1] += b[k] * b[m] * wkk[c, row, k, m]
        for k in range(lobes + 1):
            for m in range(k):
                matrix[c, k, m] = matrix[c, m, k]
    return matrix, right


@compiled("(f8[:,::1],)")
def _mirror(matrix: Array) -> None:
    """Copy the upper triangle of a matrix to the lower one, tile by tile for the cache's sake."""
    size, tile = len(matrix), 32
    for top in range(0, size, tile):
        for left in range(top, size, tile):
            for row in range(top, min(top + tile, size)):
                for column in range(max(left, row + 1), min(left + tile, size)):
                    matrix[column, row] = matrix[row, column]


@compiled(f"({SAMPLES}, {', '.join(['f8[:,::1]'] * 4)}, f8[::1])")
def normal_equations(
    weight: Array,
    weighted_value: Array,
    first_i: Nodes,
    taps_i: Array,
    first_o: Nodes,
    taps_o: Array,
    inverse_cosines: Array,
    D: Array,
    F: Array,
    G: Array,
    rho_s: Array,
    rho_d: Array,
) -> tuple[Array, Array]:
    """Gradient J'Wr and Gauss-Newton matrix J'WJ in (log D, log F, log G, log rho_s, rho_d).

    With x = rho_s D F K for a channel c and a lobe a, the derivative of the model is x in the
    logarithms of rho_s, of D and, summed over the lobes, of F. In log G of a node it is x times
    the node's part of G(theta_i) and of G(theta_o). What a row of phi_d has in common, rho_s D F,
    is multiplied in at its end. Lobes of a node lie beside each other here, so that a sample adds
    to stretches of memory.

    Parameters
    ----------
    D, F, G : ndarray, shapes (lobes, theta_h), (channels, theta_d), (lobes, nodes)
    rho_s, rho_d : ndarray, shapes (channels, lobes), (channels,)

    Returns
    -------
    gradient : ndarray, shape (n,)
    matrix : ndarray, shape (n, n)
        Symmetric.
    """
    channels, rows, columns = weight.shape
    lobes, nodes, taps = G.shape[0], G.shape[1], taps_i.shape[2]
    nh, nd = D.shape[1], F.shape[1]
    at_f = lobes * nh
    at_g = at_f + channels * nd
    at_s = at_g + lobes * nodes
    at_d = at_s + channels * lobes
    gradient, matrix = np.zeros(at_d + channels), np.zeros((at_d + channels, at_d + channels))
    # What multiplies the derivative in G: w of each channel, then w K of each channel and lobe.
    kinds, read, g = channels * (lobes + 1), taps * lobes, np.ascontiguousarray(G.T)
    slopes, factors = np.zeros(kinds), np.zeros((lobes, kinds))
    row = np.zeros((nodes * lobes, kinds))
    by_h, by_d = np.zeros((nodes * lobes, kinds)), np.zeros((nd, nodes * lobes, kinds))
    same, crossed = (
        np.zeros((nodes * lobes, nodes * lobes)),
        np.zeros((nodes * lobes, nodes * lobes)),
    )
    descent = np.zeros(nodes * lobes)
    k, part_i, part_o = np.zeros(lobes), np.zeros(read), np.zeros(read)
    x, xx = np.zeros((channels, lobes)), np.zeros((channels, lobes, lobes))
    wk, wrk = np.zeros(kinds), np.zeros(kinds)
    wkk = np.zeros((channels, lobes, lobes))
    pair, slope = np.zeros((lobes, read)), np.zeros(lobes)
    for cell in range(rows):
        h, d = cell // nd, cell % nd
        for c in range(channels):
            for a in range(lobes):
                x[c, a] = rho_s[c, a] * D[a, h] * F[c, d]
                factors[a, c] = x[c, a]
            for a in range(lobes):
                for b in range(lobes):
                    xx[c, a, b] = x[c, a] * x[c, b]
                    factors[a, channels + c * lobes + b] = xx[c, a, b]
        wk[:] = 0.0
        wrk[:] = 0.0
        wkk[:] = 0.0
        lowest, highest = nodes, -1
        for p in range(columns):
            inverse = inverse_cosines[cell, p]
            if inverse == 0.0:
                continue
            i, o = np.int64(first_i[cell, p]), np.int64(first_o[cell, p])
            lowest, highest = min(lowest, i, o), max(highest, i + taps - 1, o + taps - 1)
            for a in range(lobes):
                g_i, g_o = 0.0, 0.0
                for t in range(taps):
                    part_i[t * lobes + a] = taps_i[cell, p, t] * g[i + t, a]
                    part_o[t * lobes + a] = taps_o[cell, p, t] * g[o + t, a]
                    g_i += part_i[t * lobes + a]
                    g_o += part_o[t * lobes + a]
                k[a] = g_i * g_o * inverse
                for t in range(taps):
                    part_i[t * lobes + a] *= g_o * inverse
                    part_o[t * lobes + a] *= g_i * inverse
                slope[a] = 0.0
                for b in range(lobes):
                    pair[a, b] = 0.0
            for c in range(channels):
                w = weight[c, cell, p]
                model = rho_d[c]
                for a in range(lobes):
                    model += x[c, a] * k[a]
                wr = w * model - weighted_value[c, cell, p]
                slopes[c] = w
                wk[c] += w
                wrk[c] += wr
                for a in range(lobes):
                    at = channels + c * lobes + a
                    slopes[at] = w * k[a]
                    wk[at] += w * k[a]
                    wrk[at] += wr * k[a]
                    slope[a] += wr * x[c, a]
                    for b in range(lobes):
                        wkk[c, a, b] += w * k[a] * k[b]
                        pair[a, b] += w * xx[c, a, b]
            for a in range(lobes):
                for j in range(lobes, read):
                    pair[a, j] = pair[a, j - lobes]
            for t in range(taps):
                for a in range(lobes):
                    share_i, share_o = part_i[t * lobes + a], part_o[t * lobes + a]
                    at_i, at_o = (i + t) * lobes + a, (o + t) * lobes + a
                    descent[at_i] += slope[a] * share_i
                    descent[at_o] += slope[a] * share_o
                    for m in range(kinds):
                        row[at_i, m] += share_i * slopes[m]
                    for m in range(kinds):
                        row[at_o, m] += share_o * slopes[m]
                    for m in range(read):
                        same[at_i, i * lobes + m] += share_i * pair[a, m] * part_i[m]
                    for m in range(read):
                        same[at_o, o * lobes + m] += share_o * pair[a, m] * part_o[m]
                    for m in range(read):
                        crossed[at_i, o * lobes + m] += share_i * pair[a, m] * part_o[m]
        for node in range(lowest, highest + 1):
            for a in range(lobes):
                at = node * lobes + a
                for m in range(kinds):
                    part = row[at, m] * factors[a, m]
                    by_h[at, m] += part
                    by_d[d, at, m] += part
                    row[at, m] = 0.0
        for c in range(channels):
            rho, f = at_d + c, at_f + c * nd + d
            matrix[rho, rho] += wk[c]
            gradient[rho] += wrk[c]
            for a in range(lobes):
                own, share, at_k = a * nh + h, at_s + c * lobes + a, channels + c * lobes + a
                for at in (own, f, share):
                    gradient[at] += x[c, a] * wrk[at_k]
                    matrix[at, rho] += x[c, a] * wk[at_k]
                for b in range(lobes):
                    product = xx[c, a, b] * wkk[c, a, b]
                    if b >= a:
                        matrix[own, b * nh + h] += product
                        matrix[share, at_s + c * lobes + b] += product
                    matrix[f, f] += product
                    matrix[own, f] += product
                    matrix[own, at_s + c * lobes + b] += product
                    matrix[f, share] += product
        if d == nd - 1:
            for a in range(lobes):
                for node in range(nodes):
                    at, to = node * lobes + a, at_g + a * nodes + node
                    for c in range(channels):
                        for b in range(lobes):
                            matrix[b * nh + h, to] += by_h[at, channels + c * lobes + b]
            by_h[:] = 0.0
    for d in range(nd):
        for a in range(lobes):
            for node in range(nodes):
                at, to = node * lobes + a, at_g + a * nodes + node
                for c in range(channels):
                    matrix[to, at_d + c] += by_d[d, at, c]
                    for b in range(lobes):
                        part = by_d[d, at, channels + c * lobes + b]
                        matrix[at_f + c * nd + d, to] += part
                        matrix[to, at_s + c * lobes + b] += part
    for a in range(lobes):
        for node in range(nodes):
            at, to = node * lobes + a, at_g + a * nodes + node
            gradient[to] = descent[at]
            for b in range(lobes):
                for other in range(nodes):
                    m = other * lobes + b
                    part = same[at, m] + crossed[at, m] + crossed[m, at]
                    matrix[to, at_g + b * nodes + other] = part
    _mirror(matrix)
    return gradient, matrix


@compiled(f"({SAMPLES}, f8[:,::1], f8[:,::1], f8[:,::1], f8[:,::1], f8[::1])")
def gradient_and_diagonal(
    weight: Array,
    weighted_value: Array,
    first_i: Nodes,
    taps_i: Array,
    first_o: Nodes,
    taps_o: Array,
    inverse_cosines: Array,
    D: Array,
    F: Array,
    G: Array,
    rho_s: Array,
    rho_d: Array,
) -> tuple[Array, Array]:
    """Gradient and diagonal of `normal_equations`, at a fifth of its time.

    Returns
    -------
    gradient, diagonal : ndarray, shape (n,)
    """
    channels, rows, columns = weight.shape
    lobes, nodes, taps = G.shape[0], G.shape[1], taps_i.shape[2]
    nh, nd = D.shape[1], F.shape[1]
    at_f = lobes * nh
    at_g = at_f + channels * nd
    at_s = at_g + lobes * nodes
    at_d = at_s + channels * lobes
    gradient, diagonal = np.zeros(at_d + channels), np.zeros(at_d + channels)
    k, g = np.zeros(lobes), np.zeros((2, lobes))
    x = np.zeros((channels, lobes))
    wrk, wkk = np.zeros((channels, lobes)), np.zeros((channels, lobes, lobes))
    slope, square = np.zeros(lobes), np.zeros(lobes)
    for row in range(rows):
        h, d = row // nd, row % nd
        for c in range(channels):
            for a in range(lobes):
                x[c, a] = rho_s[c, a] * D[a, h] * F[c, d]
        wrk[:] = 0.0
        wkk[:] = 0.0
        for p in range(columns):
            inverse = inverse_cosines[row, p]
            if inverse == 0.0:
                continue
            i, o = first_i[row, p], first_o[row, p]
            for a in range(lobes):
                g[0, a], g[1, a] = 0.0, 0.0
                for t in range(taps):
                    g[0, a] += taps_i[row, p, t] * G[a, i + t]
                    g[1, a] += taps_o[row, p, t] * G[a, o + t]
                k[a] = g[0, a] * g[1, a] * inverse
                slope[a], square[a] = 0.0, 0.0
            for c in range(channels):
                w = weight[c, row, p]
                if w == 0.0:
                    continue
                model = rho_d[c]
                for a in range(lobes):
                    model += x[c, a] * k[a]
                wr = w * model - weighted_value[c, row, p]
                diagonal[at_d + c] += w
                gradient[at_d + c] += wr
                for a in range(lobes):
                    wrk[c, a] += wr * k[a]
                    slope[a] += wr * x[c, a]
                    square[a] += w * x[c, a] * x[c, a]
                    for b in range(a + 1):
                        wkk[c, a, b] += w * k[a] * k[b]
            for a in range(lobes):
                first = at_g + a * nodes
                for t in range(taps):
                    low = taps_i[row, p, t] * G[a, i + t] * g[1, a] * inverse
                    high = taps_o[row, p, t] * G[a, o + t] * g[0, a] * inverse
                    gradient[first + i + t] += slope[a] * low
                    gradient[first + o + t] += slope[a] * high
                    diagonal[first + i + t] += square[a] * low * low
                    diagonal[first + o + t] += square[a] * high * high
                    # A node that is read at both places has the sum of its parts.
                    other = i + t - o
                    if 0 <= other < taps:
                        both = taps_o[row, p, other] * G[a, i + t] * g[0, a] * inverse
                        diagonal[first + i + t] += 2 * square[a] * low * both
        for c in range(channels):
            f = at_f + c * nd + d
            for a in range(lobes):
                own, share = a * nh + h, at_s + c * lobes + a
                for at in (own, f, share):
                    gradient[at] += x[c, a] * wrk[c, a]
                one = x[c, a] * x[c, a] * wkk[c, a, a]
                diagonal[own] += one
                diagonal[share] += one
                diagonal[f] += one
                for b in range(a):
                    diagonal[f] += 2 * x[c, a] * x[c, b] * wkk[c, a, b]
    return gradient, diagonal


@compiled(f"({SAMPLES}, f8[:,:,::1], f8[:,::1], f8[::1], i8)")
def one_lobe(
    weight: Array,
    weighted_value: Array,
    first_i: Nodes,
    taps_i: Array,
    first_o: Nodes,
    taps_o: Array,
    inverse_cosines: Array,
    x: Array,
    G: Array,
    rho_d: Array,
    lobe: int,
) -> tuple[Array, Array]:
    """Objective of every sample as a function of G(theta_i) G(theta_o) of one lobe alone.

    It is a t^2 - 2 b t plus a constant, all channels together.

    Parameters
    ----------
    x : ndarray, shape (channels, rows, lobes)
        What stands before K: rho_s D F.

    Returns
    -------
    a, b : ndarray, shape (rows, phi_d)
    """
    channels, rows, columns = weight.shape
    lobes, taps = G.shape[0], taps_i.shape[2]
    square, linear = np.zeros((rows, columns)), np.zeros((rows, columns))
    k = np.zeros(lobes)
    for row in range(rows):
        for p in range(columns):
            inverse = inverse_cosines[row, p]
            if inverse == 0.0:
                continue
            i, o = first_i[row, p], first_o[row, p]
            for a in range(lobes):
                g_i, g_o = 0.0, 0.0
                for t in range(taps):
                    g_i += taps_i[row, p, t] * G[a, i + t]
                    g_o += taps_o[row, p, t] * G[a, o + t]
                k[a] = g_i * g_o * inverse
            k[lobe] = 0.0
            for c in range(channels):
                w = weight[c, row, p]
                if w == 0.0:
                    continue
                others = rho_d[c]
                for a in range(lobes):
                    others += x[c, row, a] * k[a]
                y = x[c, row, lobe] * inverse
                square[row, p] += w * y * y
                linear[row, p] += (weighted_value[c, row, p] - w * others) * y
    return square, linear


@compiled(f"({PLACES}, i4[::1], f8[:,::1], f8[:,::1], f8[::1], i8)")
def node_quartic(
    first_i: Nodes,
    taps_i: Array,
    first_o: Nodes,
    taps_o: Array,
    readers: NDArray[np.int32],
    square: Array,
    linear: Array,
    G: Array,
    node: int,
) -> Array:
    """Coefficients of the objective as a polynomial in one node of G, the constant left out.

    Equations 5 to 7 of Peng et al. 2017: a sample that reads the node at one of its places adds a
    parabola, one that reads it at both a quartic.

    Parameters
    ----------
    readers : ndarray, shape (n,)
        Flat indices of the samples that read the node.
    square, linear : ndarray, shape (rows, phi_d)
        See `one_lobe`.
    G : ndarray, shape (nodes,)

    Returns
    -------
    ndarray, shape (4,)
        Of x, x^2, x^3 and x^4.
    """
    columns, taps, found = first_i.shape[1], taps_i.shape[2], np.zeros(4)
    for sample in readers:
        row, p = sample // columns, sample % columns
        a, b = square[row, p], linear[row, p]
        if a == 0.0:
            continue
        rest_i, rest_o, share_i, share_o = 0.0, 0.0, 0.0, 0.0
        for t in range(taps):
            at_i, at_o = first_i[row, p] + t, first_o[row, p] + t
            if at_i == node:
                share_i = taps_i[row, p, t]
            else:
                rest_i += taps_i[row, p, t] * G[at_i]
            if at_o == node:
                share_o = taps_o[row, p, t]
            else:
                rest_o += taps_o[row, p, t] * G[at_o]
        # G(theta_i) G(theta_o) = zero + one x + two x^2
        zero, one, two = rest_i * rest_o, rest_i * share_o + rest_o * share_i, share_i * share_o
        found[0] += 2 * one * (a * zero - b)
        found[1] += a * one * one + 2 * two * (a * zero - b)
        found[2] += 2 * a * one * two
        found[3] += a * two * two
    return found
