"""A low-dimensional basis of logarithms of factors.

Bagher et al. 2016 think of "a low-dimensional factor eigen-basis" in their conclusion. Here the
logarithm of a factor is a mean curve plus a few common curves times coefficients, so that the
factor is a product of powers and always positive: the weighted principal components of many
materials' logarithms. The scale of a factor is left out, for rho_s takes it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: Least weight as a share of the largest: where no sample sees anything, curves go on as the other
#: materials do, at next to no say in what they are.
LEAST_WEIGHT = 1e-6
#: Share of the largest logarithm that is rounding: curves that explain no more are none.
NOTHING = 1e-12


@dataclass(frozen=True)
class Basis:
    """Curves that logarithms of factors are made of.

    Parameters
    ----------
    mean : ndarray, shape (n,)
        The curve of coefficients 0.
    curves : ndarray, shape (count, n)
        Orthonormal by `weights`, the one that explains most first: a smaller basis of the same
        factors is the beginning of a larger one.
    weights : ndarray, shape (n,)
        How much each value counts; they sum to 1.
    """

    mean: Array
    curves: Array
    weights: Array

    @property
    def count(self) -> int:
        """Number of curves, the mean not among them."""
        return len(self.curves)

    def first(self, count: int) -> "Basis":
        """Return the basis of the first curves alone."""
        return Basis(self.mean, self.curves[:count], self.weights)


def log_factors(factors: ArrayLike, floor: float) -> Array:
    """Logarithms of factors, each with its largest value at 1 and none below `floor`.

    Parameters
    ----------
    factors : array_like, shape (..., n)
        Not negative. A factor of zeros counts as one of ones.
    floor : float
        Above 0: the least share of its largest value that a factor can have, for the logarithm of
        a zero is none. Fits of independent-g and shared-lobes have no value below their clamp,
        1e-6: that as a floor changes nothing of them.
    """
    given = np.asarray(factors, dtype=float)
    top = given.max(-1, keepdims=True)
    shares = np.divide(given, top, out=np.ones_like(given), where=top > 0)
    return np.log(np.maximum(shares, floor))


def basis_of(logs: ArrayLike, weights: ArrayLike, count: int) -> Basis:
    """Find the curves that approximate logarithms of factors best.

    Parameters
    ----------
    logs : array_like, shape (rows, n)
        Of factors, one a row; their scale does not matter.
    weights : array_like, shape (n,)
        How much each value counts, not negative.
    count : int
        Number of curves; no more are found than explain anything.

    Raises
    ------
    ValueError
        If there is no row, the shapes do not fit, `count` is negative, or no weight is above 0.
    """
    given, weight = np.asarray(logs, dtype=float), np.asarray(weights, dtype=float)
    if given.ndim != 2 or not len(given) or weight.shape != given.shape[1:]:
        raise ValueError(f"logarithms of shape {given.shape} with weights of shape {weight.shape}")
    if count < 0 or not weight.max() > 0:
        raise ValueError(f"{count} curves, and a largest weight of {weight.max():g}")
    weight = np.maximum(weight, LEAST_WEIGHT * weight.max())
    weight = weight / weight.sum()
    level = given - given @ weight[:, None]
    mean, root = level.mean(0), np.sqrt(weight)
    _, values, right = np.linalg.svd((level - mean) * root, full_matrices=False)
    known = np.count_nonzero(values > NOTHING * np.abs(given).max() * np.sqrt(len(given)))
    return Basis(mean, right[: min(count, known)] / root, weight)


def coefficients(basis: Basis, logs: ArrayLike, weights: ArrayLike | None = None) -> Array:
    """Coefficients with which a basis comes nearest to logarithms of factors, their scale free.

    Parameters
    ----------
    basis : Basis
    logs : array_like, shape (rows, n)
        Of factors, one a row.
    weights : array_like, shape (n,) or (rows, n), optional
        How much each value counts, in place of the weights of the basis.

    Returns
    -------
    ndarray, shape (rows, count)
    """
    given = np.asarray(logs, dtype=float)
    weight = np.asarray(basis.weights if weights is None else weights, dtype=float)
    weight = np.broadcast_to(weight, given.shape)
    weight = np.maximum(weight, LEAST_WEIGHT * weight.max(1, keepdims=True))
    curves = np.vstack([basis.curves, np.ones_like(basis.mean)])
    right = (weight * (given - basis.mean)) @ curves.T
    matrices = np.einsum("rn,an,bn->rab", weight, curves, curves, optimize=True)
    return np.linalg.solve(matrices, right[..., None])[:, :-1, 0]


def reconstruct(basis: Basis, coefficients: ArrayLike) -> Array:
    """Factors of coefficients, each with its largest value at 1.

    Parameters
    ----------
    basis : Basis
    coefficients : array_like, shape (..., count)

    Returns
    -------
    ndarray, shape (..., n)
    """
    logs = basis.mean + np.asarray(coefficients, dtype=float) @ basis.curves
    return np.exp(logs - logs.max(-1, keepdims=True))
