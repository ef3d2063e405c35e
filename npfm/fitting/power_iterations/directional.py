"""Models of microfacets on tables of both directions: their values, and their Fresnel factor."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.objective import BLACK, Samples
from npfm.fitting.power_iterations.backscattering import areas, normals, shape
from npfm.reflectance.anisotropic_slopes import Normals, area
from npfm.reflectance.directional import Directional
from npfm.reflectance.microsurfaces import roughness, scale_matrix
from npfm.reflectance.tabulated_slopes import at_normals, looked_up, neighbours, rougher

Array = NDArray[np.float64]
Parameters = dict[str, NDArray]

#: Bins of the Fresnel factor, as MERL's.
THETA_D_BINS = 90
#: What angles on the edge of a bin may lack.
ROUNDING = 1e-6
#: Least ratio of roughness along the axes of a formula: with a smaller one rho may be 1 in float32.
NARROWEST = 1e-3
#: Parameters of a formula.
ROUGHNESS = ("alpha_x", "alpha_y", "rho")


@dataclass(frozen=True)
class Cells:
    """Half vectors of the cells of a table.

    Parameters
    ----------
    half : ndarray, shape (size, 3)
        Unit vectors.
    index, share : ndarray, shape (size, 4)
        Entries of a D of shape `shape` that a half vector is between, and their shares.
    theta_d_bin : ndarray of int, shape (size,)
    """

    half: Array
    index: NDArray[np.int32]
    share: Array
    theta_d_bin: NDArray[np.int32]


@lru_cache(maxsize=2)
def cells(grid: Directional) -> Cells:
    """Place the half vectors of a table."""
    # The sum is the same, to the last bit, with light and view exchanged.
    total = (grid.light[:, :, None, None] + grid.view).reshape(-1, 3)
    length = np.linalg.norm(total, axis=1)
    half = total / length[:, None]
    index, share = neighbours(half, shape(grid))
    theta_d = np.arccos(np.minimum(length / 2, 1.0))
    bins = np.minimum(theta_d / (np.pi / 2) * THETA_D_BINS + ROUNDING, THETA_D_BINS - 1)
    bins = np.where(bins < _head_on(grid), 0, bins)
    return Cells(half, index, share, bins.astype(np.int32))


def _head_on(grid: Directional) -> int:
    """Number of first theta_d bins in which D is read off, and F is F0."""
    return int(THETA_D_BINS / (2 * grid.theta_i_count) + ROUNDING) + 1


def mirrors(D: Array, S: Array, grid: Directional) -> Array:
    """Values of the BRDF for F = 1: equation 19 of Dupuy et al. 2015.

    D / (4 A) with A half of cos(theta_i) S(o) + cos(theta_o) S(i), as in
    `npfm.fitting.power_iterations.mirrors` where the mean slope is 0; never negative even where a
    measured D has another.

    Parameters
    ----------
    D : ndarray, shape (size,)
        Normalised, at the half vectors of the cells.
    S : ndarray, shape (theta_o, phi_o)
        Its `areas`.

    Returns
    -------
    ndarray, shape grid.shape
        In 1/sr.
    """
    cosine = np.cos(grid.theta_i)[:, None]
    at_i, at_o = (cosine * np.ones_like(S)).ravel(), S.ravel()
    shadowed = (at_i[:, None] * at_o + at_o[:, None] * at_i) / 2
    return (D.reshape(shadowed.shape) / (4 * shadowed)).reshape(grid.shape)


@dataclass(frozen=True)
class Form:
    """How a model keeps an anisotropic distribution of microfacets.

    Parameters
    ----------
    convert : callable
        The model's own parameters, first axis of length 1, of a D of shape `shape`.
    surface : callable
        The normalised D at the half vectors of the cells, and its `areas`, of those.
    rougher : callable
        Those of slopes that are so many times as steep along x and along y.
    covered : callable
        Area of the microfacets of a D of shape `shape`, as a share of what `at_normals` makes it.
        The steps of a table may be wider than a highlight, so that what D is between them, and with
        it the scale of F, depends on the form.
    """

    convert: Callable[[Array, Directional], Parameters]
    surface: Callable[[Parameters, Directional], tuple[Array, Array]]
    rougher: Callable[[Parameters, tuple[float, float]], Parameters]
    covered: Callable[[Array, Directional], float]


def _tabulated_surface(p: Parameters, grid: Directional) -> tuple[Array, Array]:
    [D] = p["D"]
    if D.shape != shape(grid):
        raise ValueError(f"D of shape {D.shape}, not {shape(grid)}")
    if not (D.min() >= 0 and D.max() > 0):
        raise ValueError("a D below 0, or 0 everywhere")
    summed = at_normals(D, normals(grid))
    covered, at = area(summed, normals(grid)), cells(grid)
    return looked_up(D, at.index, at.share) / covered, areas(summed / covered, grid)


def _tabulated_rougher(p: Parameters, factors: tuple[float, float]) -> Parameters:
    D = rougher(p["D"][0], factors)
    return {"D": (D / D.max())[None]}


#: A distribution that is kept as it is.
TABULATED = Form(
    lambda D, grid: {"D": D[None]}, _tabulated_surface, _tabulated_rougher, lambda D, grid: 1.0
)


def formula(
    between: Callable[[Array, Normals], Array],
    scale: Callable[[Array, Normals], Array],
    density: Callable[[Array, Array], Array],
    visible: Callable[[Array, Array], Array],
) -> Form:
    """Form of a distribution that is kept as alpha_x, alpha_y and rho of a formula.

    Parameters
    ----------
    between : callable
        What takes a D of shape `shape` to normals: exactly, if the formula is that of the surface.
    scale : callable
        Scale matrix of a D at normals.
    density, visible : callable
        D and its projected area, of unit vectors and a scale matrix
        (`npfm.reflectance.microsurfaces`).
    """

    def convert(D: Array, grid: Directional) -> Parameters:
        found = roughness(_not_flat(scale(between(D, normals(grid)), normals(grid))))
        return {name: np.array([value]) for name, value in zip(ROUGHNESS, found, strict=True)}

    def surface(p: Parameters, grid: Directional) -> tuple[Array, Array]:
        matrix = scale_matrix(*(float(p[name][0]) for name in ROUGHNESS))
        o = grid.view
        return density(cells(grid).half, matrix), 2 * visible(o, matrix) - o[..., 2]

    def rougher(p: Parameters, factors: tuple[float, float]) -> Parameters:
        return {
            name: p[name] * p[name].dtype.type(factor)
            for name, factor in zip(ROUGHNESS[:2], factors, strict=True)
        }

    def covered(D: Array, grid: Directional) -> float:
        at = normals(grid)
        return area(between(D, at), at) / area(at_normals(D, at), at)

    return Form(convert, surface, rougher, covered)


def _not_flat(scale: Array) -> Array:
    """A scale matrix that `NARROWEST` lets be stored."""
    squares, axes = np.linalg.eigh(scale)
    return axes * np.maximum(squares, NARROWEST**2 * squares[-1]) @ axes.T


def fresnel(samples: Samples, ideal: Array, way: str) -> Array:
    """F of each theta_d bin, shape (THETA_D_BINS,); as `npfm.fitting.power_iterations.fresnel`."""
    grid = samples.grid
    assert isinstance(grid, Directional)
    counts = ((samples.weight > 0) & (ideal > BLACK * ideal.max())).ravel()
    bins = cells(grid).theta_d_bin[counts]
    weight, value, ideal = (a.ravel()[counts] for a in (samples.weight, samples.value, ideal))
    seen = np.bincount(bins, minlength=THETA_D_BINS) > 0
    if not seen.any():
        return np.ones(THETA_D_BINS)
    if way == "median":
        F = np.zeros(THETA_D_BINS)
        for d in np.flatnonzero(seen):
            F[d] = np.median((value / ideal)[bins == d])
    else:
        above, below = {
            "least-squares": (weight * ideal * value, weight * ideal**2),
            "mean": (value / ideal, np.ones_like(value)),
        }[way]
        energy = np.bincount(bins, below, THETA_D_BINS)
        F = np.bincount(bins, above, THETA_D_BINS) / np.where(energy > 0, energy, 1.0)
    every = np.arange(THETA_D_BINS)
    F = np.interp(every, every[seen], F[seen])
    F[: _head_on(grid)] = F[0]
    return F


def at_cells(rho_s: Array, F: Array, grid: Directional) -> list[Array]:
    """rho_s F of each channel at the cells of a table, three of shape grid.shape."""
    bins = cells(grid).theta_d_bin
    return [(s * f)[bins].reshape(grid.shape) for s, f in zip(rho_s, F, strict=True)]
