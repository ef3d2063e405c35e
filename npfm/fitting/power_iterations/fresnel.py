"""The Fresnel factor of a microfacet BRDF, from what its mirrors alone would reflect."""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import BLACK, Samples

Array = NDArray[np.float64]


def fresnel(samples: Samples, ideal: NDArray, way: str) -> Array:
    """F of each theta_d bin: what is measured over what mirrors reflect.

    Dupuy et al. 2015, equation 20.

    Parameters
    ----------
    samples : Samples
        Folded measurements of one channel.
    ideal : ndarray, shape (theta_h, theta_d, phi_d / 2)
        Values for F = 1 in 1/sr, as `mirrors` gives them.
    way : str
        The ``mean`` of the ratios, as in the paper, their ``median``, or ``least-squares``: what
        minimises the objective.

    Returns
    -------
    ndarray, shape (theta_d_bins,)
        In units of the samples' scale. Bins in which nothing says what F is follow their
        neighbours; F is 1 where no bin does.
    """
    counts = (samples.weight > 0) & (ideal > BLACK * ideal.max())
    seen = counts.any((0, 2))
    if not seen.any():
        return np.ones(len(seen))
    F = WAYS[way](samples, ideal, counts)
    bins = np.arange(len(seen))
    return np.interp(bins, bins[seen], F[seen])


def _least_squares(samples: Samples, ideal: Array, counts: NDArray[np.bool_]) -> Array:
    weighted = np.where(counts, samples.weight * ideal, 0.0)
    energy = np.einsum("hdp,hdp->d", weighted, ideal)
    return np.einsum("hdp,hdp->d", weighted, samples.value) / np.where(energy > 0, energy, 1.0)


def _mean(samples: Samples, ideal: Array, counts: NDArray[np.bool_]) -> Array:
    ratio = np.where(counts, samples.value / np.where(counts, ideal, 1.0), 0.0)
    return ratio.sum((0, 2)) / np.maximum(counts.sum((0, 2)), 1)


def _median(samples: Samples, ideal: Array, counts: NDArray[np.bool_]) -> Array:
    F = np.ones(counts.shape[1])
    for d in np.flatnonzero(counts.any((0, 2))):
        at = counts[:, d]
        F[d] = np.median(samples.value[:, d][at] / ideal[:, d][at])
    return F


#: Ways to take F from measured and ideal values, by name.
WAYS = {"least-squares": _least_squares, "mean": _mean, "median": _median}
