"""A distribution of microfacets from backscattered light, by power iterations (Dupuy et al. 2015).

In the BRDF F D / (4 A) of `mirrors`, A is linear in D: where F is one number F0, F0 D = 4 f A is
an eigenproblem for D. Its matrix has no negative entry, so power iterations lead to the one
eigenvector that has none either, and cannot fail. A row of it is made from the samples of one bin
of theta_h in the first bin of theta_d.
"""

from collections.abc import Callable, Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import Samples
from npfm.fitting.power_iterations.mirrors import cells
from npfm.reflectance.slopes import ELEVATIONS, area_matrix, bands, facing

Array = NDArray[np.float64]

#: The iterations end when no component of D, of which the largest is 1, moves by more.
TOLERANCE = 1e-10
MAX_ITERATIONS = 1000


def consistent_kernel(samples: Samples) -> tuple[Array, NDArray[np.bool_]]:
    """Rows of the eigenproblem with the shadowing that the model is rendered with.

    A is taken at the very angles of the samples. For theta_d = 0 it is cos(theta_o) times the
    integral of |o.h| D(h), where the paper has max(0, o.h): G1 in place of G of its equation 2.

    Parameters
    ----------
    samples : Samples
        Folded measurements of one channel.

    Returns
    -------
    matrix : ndarray, shape (theta_h_bins, theta_h_bins)
        In units of the samples' scale; what it makes of D is F0 D.
    seen : ndarray of bool, shape (theta_h_bins,)
        Rows that there are samples for.
    """
    grid, at = samples.grid, cells(samples.grid)
    value, seen, rows = _backscattered(samples)
    cos_i, cos_o = (array[rows] for array in at.cosines)
    node_i, node_o = (array[rows] for array in at.nodes)
    part_i, part_o = (array[rows] for array in at.parts)
    shares = _scattered(value * cos_i, node_o, part_o) + _scattered(value * cos_o, node_i, part_i)
    projected = 2 * np.pi * np.cos(grid.theta_h) * bands(grid)
    once_too_often = np.sum(value * cos_i * cos_o, axis=1)[:, None] * projected
    return 4 * (shares @ area_matrix(grid) - once_too_often), seen


def papers_kernel(samples: Samples) -> tuple[Array, NDArray[np.bool_]]:
    """Rows of equation 22 of the paper, in D, with the shadowing of its equation 11."""
    grid = samples.grid
    value, seen, _ = _backscattered(samples)
    theta_o = grid.theta_h[:, None]
    scale = 4 * np.cos(theta_o) * value.sum(1, keepdims=True)
    return scale * facing(theta_o, grid.theta_h) * bands(grid), seen


def _backscattered(
    samples: Samples,
) -> tuple[Array, NDArray[np.bool_], tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Samples of each theta_h in the first bin of theta_d that has any, over their number.

    Returns
    -------
    value : ndarray, shape (theta_h, phi_d / 2)
        Their sum over phi_d is the mean of the samples.
    seen : ndarray of bool, shape (theta_h,)
        Where there are samples.
    rows : tuple of two ndarray of int, shape (theta_h,)
        Where they are: the bins of theta_h and of theta_d.
    """
    depth = np.zeros(len(samples.weight), dtype=int)
    empty = ~(samples.weight[:, 0] > 0).any(-1)
    depth[empty] = (samples.weight[empty] > 0).any(-1).argmax(1)
    rows = np.arange(len(depth)), depth
    counts = samples.weight[rows] > 0
    number = counts.sum(1, keepdims=True)
    value = np.where(counts, samples.value[rows], 0.0) / np.maximum(number, 1)
    return value, number[:, 0] > 0, rows


def _scattered(value: Array, node: NDArray, part: Array) -> Array:
    """Sums of values over phi_d, shared out to the elevations on both sides of them."""
    size = len(value) * len(ELEVATIONS)
    place = np.arange(len(value))[:, None] * len(ELEVATIONS) + node
    below = np.bincount(place.ravel(), (value * (1 - part)).ravel(), size)
    above = np.bincount(place.ravel() + 1, (value * part).ravel(), size)
    return np.asarray(below + above, dtype=float).reshape(len(value), -1)


#: Ways to set the eigenproblem up, by name.
KERNELS = {"consistent": consistent_kernel, "paper": papers_kernel}


def distribution(samples: Sequence[Samples], kernel: str) -> tuple[Array, str, int]:
    """D of a material, that of all its channels together.

    Where no light comes back that could be measured, D is interpolated between its neighbours, and
    beyond the last of them it is held.

    Parameters
    ----------
    samples : sequence of Samples
        Folded measurements of each channel.
    kernel : str
        A key of `KERNELS`.

    Returns
    -------
    D : ndarray, shape (theta_h_bins,)
        In no particular scale, not negative and not all zero.
    status : str
        ``converged``, ``iteration cap``, or what makes D arbitrary.
    iterations : int
    """
    unit = max(channel.scale for channel in samples)
    matrices = [(channel.scale / unit) * filled(*KERNELS[kernel](channel)) for channel in samples]
    # In an order of their own, so that that of the channels does not even matter for rounding.
    return power_iterations(reduce(np.add, sorted(matrices, key=np.sum)))


def filled(matrix: Array, seen: NDArray[np.bool_]) -> Array:
    """Rows that there is nothing to make from, interpolated between the others."""
    rows = np.flatnonzero(seen)
    place = np.interp(np.arange(len(matrix)), rows, np.arange(len(rows)))
    below = place.astype(int)
    above = np.minimum(below + 1, len(rows) - 1)
    part = (place - below)[:, None]
    return (1 - part) * matrix[rows[below]] + part * matrix[rows[above]]


def power_iterations(matrix: Array) -> tuple[Array, str, int]:
    """Eigenvector of the largest eigenvalue of a matrix without negative entries.

    Returns
    -------
    vector : ndarray
        Largest component 1; ones if the matrix leads nowhere.
    status : str
    iterations : int
    """
    return iterated(lambda vector: matrix @ vector, (len(matrix),))


def iterated(apply: Callable[[Array], Array], shape: tuple[int, ...]) -> tuple[Array, str, int]:
    """`power_iterations` with a function in place of the matrix, of arrays of that shape."""
    vector = np.ones(shape)
    for iteration in range(1, MAX_ITERATIONS + 1):
        image = apply(vector)
        largest = image.max()
        if not largest > 0:
            return np.ones(shape), "degenerate: no light comes back", iteration
        image /= largest
        if np.abs(image - vector).max() <= TOLERANCE:
            return image, "converged", iteration
        vector = image
    return vector, "iteration cap", MAX_ITERATIONS
