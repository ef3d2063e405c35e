"""How often each of several distributions is chosen, a Lambertian surface's among them."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Smallest share of directions in proportion to the cosine: it keeps a density wherever light may
#: be reflected that the other distributions have not.
LEAST_COSINE = 0.05


def with_cosine(energy: Array, diffuse: float) -> Array:
    """Probabilities (p, L + 1) of L distributions and, as the last, of the cosine's.

    Parameters
    ----------
    energy : ndarray, shape (p, L)
        What each reflects of even light.
    diffuse : float
        What a Lambertian part reflects.
    """
    rest = energy.sum(axis=1, keepdims=True)
    some = rest > 0
    shares = energy / np.where(some, rest, 1)
    cosine = np.where(some, diffuse / np.where(some, rest + diffuse, 1), 1)
    cosine = np.maximum(cosine, LEAST_COSINE)
    return np.concatenate([shares * (1 - cosine), cosine], axis=1)
