"""Factors of a BRDF by the recipe of Lawrence et al. 2004, and by one of less variance.

``paper`` is section 4 as printed: the matrix holds rho cos(theta_i) at even angles, each as
important as any other. ``improved`` differs in four points:

- The density of the light is that of the half vector over 4 (i.h), so that an exact fit of the
  paper's matrix does not sample without variance: the matrix is multiplied by 4 (i.h).
- Rows stand for the solid angle of their bin, as samples do, and bins of theta_h are uniform in
  sqrt(theta_h), as MERL's: where highlights are.
- Directions below the horizon are not sampled, whatever the factors are there
  (`npfm.rendering.sampling.factored`).
- A Lambertian part is split off, which another distribution samples.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.factorisation.matrix import Brdf, Samples, sampled, solid_angles
from npfm.fitting.factorisation.nmf import factorised
from npfm.reflectance.factored import TWO_PI, Angles, Factors

Array = NDArray[np.float64]

#: Share of the samples, weighted by both cosines, that are darker than the Lambertian part.
DARKER = 0.2
#: So many terms of either factorisation are more than any paper has.
MOST_TERMS = 64
#: A matrix of more entries is refused: with all that it is made of, it would take 2 GB.
MOST_ENTRIES = 2**24


@dataclass(frozen=True)
class Recipe:
    """How a BRDF is factored.

    Parameters
    ----------
    angles : Angles
        Where it is tabulated, and by which recipe.
    terms : tuple of two int
        J of the first factorisation, and K of the second.

    Raises
    ------
    NpfmError
        If a number is below 1, or the matrix would be too large.
    """

    angles: Angles
    terms: tuple[int, int] = (3, 2)

    def __post_init__(self) -> None:
        numbers = (*self.terms, *self.angles.shape)
        if min(numbers) < 1:
            raise NpfmError(f"terms and bins cannot be {min(numbers)}; give numbers from 1")
        if max(self.terms) > MOST_TERMS:
            raise NpfmError(f"{max(self.terms)} terms are more than {MOST_TERMS}; give fewer")
        if (entries := int(np.prod(self.angles.shape, dtype=float))) > MOST_ENTRIES:
            shape = "x".join(map(str, self.angles.shape))
            raise NpfmError(
                f"a resolution of {shape} has {entries:.1e} values, more than "
                f"{MOST_ENTRIES}; give fewer bins"
            )


@dataclass(frozen=True)
class Factored:
    """Factors, and what it took.

    Parameters
    ----------
    factors : Factors
    updates : int
        Of all factorisations.
    converged : bool
        Whether all of them ended before their last update.
    """

    factors: Factors
    updates: int
    converged: bool


def factor(brdf: Brdf, recipe: Recipe, seed: int = 0) -> Factored:
    """Factor a BRDF.

    Parameters
    ----------
    brdf : callable
        Reflectance (3, q) in 1/sr at pairs of directions (q, 3) above the horizon.
    recipe : Recipe
    seed : int
        Of the starts.
    """
    angles = recipe.angles
    samples = sampled(brdf, angles)
    rho_d = _lambertian(samples, angles) if angles.improved else np.zeros(3)
    rest = np.maximum(samples.value - rho_d[:, None, None], 0)
    intensity, weight = rest.mean(axis=0), _weight(samples, angles)
    Y = intensity * weight
    scale = float(Y.sum() / weight.sum())
    first = factorised(Y / (scale or 1.0), recipe.terms[0], seed)
    seconds = [
        factorised(column.reshape(angles.shape[2:]), recipe.terms[1], seed)
        for column in first.left.T / Y.shape[1]
    ]
    u = np.stack([product.left.T for product in seconds])
    v = np.stack([product.right for product in seconds])
    if not angles.improved:  # the matrix has densities; what is kept are integrals over bins
        u, v = u * angles.bands, v * (TWO_PI / angles.shape[3])
    mass = u.sum(axis=-1, keepdims=True)
    F_o = first.right.reshape(-1, *angles.shape[:2]) * Y.shape[1]
    share, tints = _tints(rest, intensity, angles)
    factors = Factors(angles, F_o, _divided(u, mass), v * mass, rho_d, scale * share, tints)
    products = (first, *seconds)
    updates = sum(product.updates for product in products)
    return Factored(factors, updates, all(product.converged for product in products))


def _weight(samples: Samples, angles: Angles) -> Array:
    """What the reflectance is multiplied by in the matrix, shape (b, o)."""
    if not angles.improved:
        return samples.cos_i
    return samples.cos_i * samples.jacobian * solid_angles(angles)[:, None]


def _lambertian(samples: Samples, angles: Angles) -> Array:
    """Lambertian part of each channel: the value that the share `DARKER` is below, shape (3,)."""
    cos_o = np.repeat(np.cos(angles.theta_o), angles.shape[1])
    # Solid angles of light and view, and both cosines: each pair as often as it is seen.
    weight = _weight(samples, angles) * cos_o * np.sin(np.arccos(cos_o))
    return np.array([_quantile(value.ravel(), weight.ravel()) for value in samples.value])


def _quantile(value: Array, weight: Array) -> float:
    order = np.argsort(value)
    reached = np.cumsum(weight[order])
    return float(value[order][np.searchsorted(reached, DARKER * reached[-1])])


def _tints(
    rest: Array, intensity: Array, angles: Angles
) -> tuple[Array, tuple[Array, Array, Array]]:
    """Mean of each channel over the intensity, (3,), and a factor of each of three angles.

    The product of the means over the others is the one term of least divergence. Where nothing is
    reflected a colour is that of the rest, so that a channel that is black stays so.
    """
    seen = intensity > 0
    ratio = rest / np.where(seen, intensity, 1)
    mean = ratio.sum(axis=(1, 2)) / max(np.count_nonzero(seen), 1)
    ratio = np.where(seen, ratio, mean[:, None, None]).reshape(3, *angles.shape[2:], -1)
    share = ratio.mean(axis=(1, 2, 3))
    over = (ratio.mean(axis=(1, 2)), ratio.mean(axis=(2, 3)), ratio.mean(axis=(1, 3)))
    view, theta, phi = (_divided(mean, share[:, None]) for mean in over)
    return share, (view.reshape(3, *angles.shape[:2]), theta, phi)


def _divided(a: Array, b: Array) -> Array:
    """Quotient, 0 where the divisor is 0."""
    return a / np.where(b > 0, b, 1) * (b > 0)
