"""The coefficients of a few products: least squares with lower bounds."""

from itertools import product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Added to the diagonal of the scaled equations, where products are all but the same.
RIDGE = 1e-13


def bounded_least_squares(matrix: Array, right: Array, lower: Array) -> Array:
    """Minimise x' M x - 2 r' x over x >= lower, exactly.

    Every choice of unknowns that are at their bound is tried: for the few of a fit that is quicker
    than an active set, and has no case in which it does not end.

    Parameters
    ----------
    matrix : ndarray, shape (n, n)
        Symmetric, positive semidefinite.
    right, lower : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n,)
    """
    root = np.sqrt(np.diag(matrix))
    known = root > 0
    x = lower.copy()
    if known.any():
        root = root[known]
        scaled = matrix[np.ix_(known, known)] / root / root[:, None]
        x[known] = _scaled(scaled, right[known] / root, lower[known] * root) / root
        x = np.maximum(x, lower)
    return x


def _scaled(matrix: Array, right: Array, lower: Array) -> Array:
    best, least = lower, np.inf
    for free in product((True, False), repeat=len(right)):
        open_, shut = np.flatnonzero(free), np.flatnonzero(~np.array(free))
        x = lower.copy()
        if open_.size:
            inner = matrix[np.ix_(open_, open_)] + RIDGE * np.eye(open_.size)
            x[open_] = np.linalg.solve(inner, right[open_] - matrix[np.ix_(open_, shut)] @ x[shut])
            if (x < lower).any():
                continue
        if not shut.size:
            return x  # the least of all, and within the bounds
        value = float(x @ matrix @ x - 2 * right @ x)
        if value < least:
            best, least = x, value
    return best
