"""Factors read off two slices of the samples: starts for the microfacet fits."""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import Samples

#: Bins averaged across a slice; the outermost one alone has next to no weight.
SLICE_BINS = 4


def factors_of_slices(samples: Samples) -> tuple[NDArray, NDArray]:
    """D from the retro-reflective slice and F from the slice of normal half vectors.

    Bagher et al. 2016, section 5: D is the slice theta_d = 0 and F the slice theta_h = 0, both
    of the BRDF times cos(theta_i) cos(theta_o), with the least of each slice taken for diffuse.

    Returns
    -------
    D, F : ndarray, shapes (theta_h,) and (theta_d,)
        In (0, 1], maximum 1.
    """
    half = samples.weight.shape[-1]
    cosines = [cosine[..., :half] for cosine in samples.grid.cosines]
    value = samples.value * np.maximum(cosines[0], 0) * np.maximum(cosines[1], 0)
    D = _profile(samples.weight[:, :SLICE_BINS], value[:, :SLICE_BINS], (1, 2))
    F = _profile(samples.weight[:SLICE_BINS], value[:SLICE_BINS], (0, 2))
    return D, F


def _profile(weight: NDArray, value: NDArray, axes: tuple[int, int]) -> NDArray:
    total = weight.sum(axes)
    seen = total > 0
    if not seen.any():
        return np.ones(total.size)
    mean = (weight * value).sum(axes)[seen] / total[seen]
    bins = np.arange(total.size)
    profile = np.interp(bins, bins[seen], mean)
    return np.maximum(profile / profile.max(), 1e-3) if profile.max() > 0 else np.ones(bins.size)
