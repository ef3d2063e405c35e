"""What power iterations recover of known anisotropic surfaces, and what they take."""

import time
from collections.abc import Callable, Iterable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from npfm.fitting.power_iterations.circulant import distribution
from npfm.fitting.power_iterations.eigenproblem import power_iterations
from npfm.reflectance.anisotropic_slopes import (
    Normals,
    beckmann_scale,
    facing,
    ggx_scale,
    normalised,
    projected,
)
from npfm.reflectance.microsurfaces import (
    anisotropic_beckmann,
    anisotropic_beckmann_area,
    anisotropic_ggx,
    anisotropic_ggx_area,
    roughness,
    turned_scale,
)

Array = NDArray[np.float64]

SURFACES = {
    "beckmann": (anisotropic_beckmann, anisotropic_beckmann_area, beckmann_scale),
    "ggx": (anisotropic_ggx, anisotropic_ggx_area, ggx_scale),
}
#: Roughness of the surface that is timed.
TIMED = 0.1, 0.5
#: Most normals whose matrix is filled: a tenth of a second, and 34 MB.
DENSE = 2100


def backscattered(surface: str, scale: Array, normals: Normals) -> Array:
    """f(o, o) for F = 1 in 1/sr, shape normals.shape: D / (4 A) with A as in `mirrors`."""
    density, area, _ = SURFACES[surface]
    o = normals.directions
    return density(o, scale) / (4 * o[..., 2] * (2 * area(o, scale) - o[..., 2]))


def recovery(
    nodes: Iterable[tuple[int, int]], alphas: Iterable[tuple[float, float]], turns: Iterable[float]
) -> pd.DataFrame:
    """Anisotropic surfaces found again from backscattered light.

    Parameters
    ----------
    nodes : iterable of tuple of int
        Elevations and azimuths at which they are sampled.
    alphas : iterable of tuple of float
        Roughness along two axes.
    turns : iterable of float
        Degrees from x to the first of them.

    Returns
    -------
    DataFrame
        Columns surface, elevations, azimuths, alpha_1, alpha_2, turn; alpha_error, the larger
        relative error of alpha_x and alpha_y, and rho_error; backscatter_error, the largest error
        of what the found surface reflects back, as a share of the largest value; status and
        iterations.
    """
    rows = [
        (surface, *count, *alpha, turn, *_errors(surface, count, alpha, turn))
        for surface in SURFACES
        for count in nodes
        for alpha in alphas
        for turn in turns
    ]
    known = ["surface", "elevations", "azimuths", "alpha_1", "alpha_2", "turn"]
    found = ["alpha_error", "rho_error", "backscatter_error", "status", "iterations"]
    return pd.DataFrame(rows, columns=known + found)


def _errors(
    surface: str, count: tuple[int, int], alpha: tuple[float, float], turn: float
) -> tuple[float, float, float, str, int]:
    normals, scale = Normals(*count), turned_scale(alpha, np.deg2rad(turn))
    exact = backscattered(surface, scale, normals)
    D, status, iterations = distribution(exact, normals, "consistent")
    expected = np.array(roughness(scale))
    found = np.array(roughness(SURFACES[surface][2](D, normals)))
    relative = np.abs(found[:2] / expected[:2] - 1).max()
    spectrum = facing(normals, tuple(normals.theta_h.tolist()))
    D = normalised(D, normals)
    reflected = D / (4 * np.cos(normals.theta_h)[:, None] * projected(spectrum, D))
    error = np.abs(reflected - exact).max() / exact.max()
    return relative, abs(found[2] - expected[2]), error, status, iterations


def timing(nodes: Iterable[tuple[int, int]], repeats: int) -> pd.DataFrame:
    """Seconds of the anisotropic eigenproblem against the samples it is made from (Figure 5).

    Returns
    -------
    DataFrame
        Columns nodes, the number of backscattering samples; part; seconds: of processor time, the
        median of the repeats. ``circulant`` is the eigenproblem by Fourier transforms, ``kernel``
        the transform of the kernel that is made once for all materials, ``dense`` the eigenproblem
        with the whole matrix, for up to `DENSE` samples.
    """
    rows = []
    for count in nodes:
        normals = Normals(*count)
        exact = backscattered("ggx", turned_scale(TIMED, 0.3), normals)
        elevations = tuple(normals.theta_h.tolist())

        def circulant(exact: Array = exact, normals: Normals = normals) -> object:
            return distribution(exact, normals, "consistent")

        def kernel(
            normals: Normals = normals, elevations: tuple[float, ...] = elevations
        ) -> object:
            return facing.__wrapped__(normals, elevations)

        def dense(exact: Array = exact, normals: Normals = normals) -> object:
            return power_iterations(dense_matrix(exact, normals))

        parts: dict[str, Callable[[], object]] = {"kernel": kernel, "circulant": circulant}
        if exact.size <= DENSE:
            parts["dense"] = dense
        circulant()
        rows += [(exact.size, name, _median(part, repeats)) for name, part in parts.items()]
    return pd.DataFrame(rows, columns=["nodes", "part", "seconds"])


def dense_matrix(backscattered: Array, normals: Normals) -> Array:
    """The whole matrix of the eigenproblem: algorithm 1 of Dupuy et al. 2015, with |o.h|."""
    o = normals.directions.reshape(-1, 3)
    rows = 4 * backscattered.ravel() * o[:, 2]
    weight = np.repeat(normals.solid_angle, normals.phi_h_bins)
    return rows[:, None] * np.abs(o @ o.T) * weight


def _median(part: Callable[[], object], repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        began = time.process_time()
        part()
        seconds.append(time.process_time() - began)
    return float(np.median(seconds))
