"""Matrices without negative entries as sums of a few products (Lawrence et al. 2004, appendix)."""

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Most updates, and the share of the first divergence that ten more have to bring.
UPDATES, TOLERANCE = 5000, 1e-6


@dataclass(frozen=True)
class Product:
    """A matrix of shape (rows, columns) as `left @ right`.

    Parameters
    ----------
    left : ndarray, shape (rows, terms)
    right : ndarray, shape (terms, columns)
        Each row adds up to 1, or to 0 where there is no such term.
    updates : int
        How many it took.
    converged : bool
        Whether that was less than `UPDATES`.
    """

    left: Array
    right: Array
    updates: int
    converged: bool


def factorised(Y: Array, terms: int, seed: int = 0) -> Product:
    """Approximate a matrix by a product of two that have no negative entry.

    Minimises the divergence of Lawrence et al. 2004, equation 17, by the multiplicative updates of
    Lee and Seung 2000 in scikit-learn, from a singular value decomposition. One term is the closed
    form, the product of the sums over rows and columns.

    Parameters
    ----------
    Y : ndarray, shape (rows, columns)
        Not negative.
    terms : int
        At least 1; terms that a smaller matrix cannot have are 0.
    seed : int
        Of the vectors that the decomposition begins with.
    """
    total = Y.sum()
    if terms == 1 or not total > 0:
        right = np.zeros((terms, Y.shape[1]))
        right[0] = Y.sum(axis=0) / (total or 1.0)
        left = np.zeros((Y.shape[0], terms))
        left[:, 0] = Y.sum(axis=1)
        return Product(left, right, 0, True)
    from sklearn.decomposition import NMF  # 1 s, which no other model waits for
    from sklearn.exceptions import ConvergenceWarning

    possible = min(terms, *Y.shape)
    method = NMF(
        possible,
        init="nndsvda",
        solver="mu",
        beta_loss="kullback-leibler",
        tol=TOLERANCE,
        max_iter=UPDATES,
        random_state=seed,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # it is told by `converged`
        left = method.fit_transform(Y / Y.mean()) * Y.mean()
    scale = method.components_.sum(axis=1)
    spare = ((0, 0), (0, terms - possible))
    return Product(
        np.pad(left * scale, spare),
        np.pad(method.components_ / np.where(scale > 0, scale, 1)[:, None], spare[::-1]),
        int(method.n_iter_),
        bool(method.n_iter_ < UPDATES),
    )
