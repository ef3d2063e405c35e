"""Products of factors at the cells that pixels see, compiled."""

import numpy as np
from numba import types
from numpy.typing import NDArray

from npfm.compilation import compiled

Array = NDArray[np.float64]

_f2, _f3 = (types.Array(types.float64, n, "C") for n in (2, 3))
_n1, _s2 = types.Array(types.int64, 1, "C"), types.Array(types.int16, 2, "C")
#: Of a matrix that is mapped into memory nothing is written.
ROWS = (
    types.Array(types.int64, 1, "C", readonly=True),
    types.Array(types.int32, 1, "C", readonly=True),
    types.Array(types.float32, 2, "C", readonly=True),
)


@compiled(_f2(*ROWS, _n1, _f3, _f3, _f3, _f2, _f2, _s2, _f2, _s2, _f2, _f2))
def radiances(
    indptr: NDArray[np.int64],
    indices: NDArray[np.int32],
    weights: NDArray[np.float32],
    pixels: NDArray[np.int64],
    D: Array,
    F: Array,
    G: Array,
    rho_s: Array,
    rho_d: Array,
    node_i: NDArray[np.int16],
    part_i: Array,
    node_o: NDArray[np.int16],
    part_o: Array,
    inverse_cosines: Array,
) -> Array:
    """Radiance at pixels, shape (n, 3): their rows of a transport matrix times their own products.

    `npfm.rendering.transport.Transport` says what the rows are, `npfm.rendering.products` the rest.
    """
    half = inverse_cosines.shape[1]
    angles = F.shape[2]
    radiance = np.zeros((len(pixels), 3))
    for n in range(len(pixels)):
        for e in range(indptr[pixels[n]], indptr[pixels[n] + 1]):
            row, p = divmod(indices[e], 2 * half)
            # Exchanging light and view takes phi_d to pi - phi_d, and changes nothing.
            p = min(p, 2 * half - 1 - p)
            inverse = inverse_cosines[row, p]
            if inverse == 0.0:
                continue
            h, d = divmod(row, angles)
            i, o, to_i, to_o = node_i[row, p], node_o[row, p], part_i[row, p], part_o[row, p]
            for c in range(3):
                g_i = G[n, c, i] + to_i * (G[n, c, i + 1] - G[n, c, i])
                g_o = G[n, c, o] + to_o * (G[n, c, o + 1] - G[n, c, o])
                product = D[n, c, h] * F[n, c, d] * g_i * g_o * inverse
                radiance[n, c] += weights[c, e] * (rho_d[n, c] + rho_s[n, c] * product)
    return radiance
