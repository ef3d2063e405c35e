"""Factors as columns of a spreadsheet, in physical units.

rho = rho_d + D(theta_h) F(theta_d) G(theta_i) G(theta_o) / (4 cos(theta_i) cos(theta_o)), in 1/sr:
D is a distribution of microfacets, whose integral over the hemisphere, weighted by cos(theta_h), is
1, G has its largest value 1, and F takes the scale that is left, with that of rho_s. A fit has the
same product in another scale (Bagher et al. 2016, equation 3).
"""

import csv
from collections.abc import Sequence
from itertools import zip_longest

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.exports.sources import Source
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.fits import Fit
from npfm.reflectance.slopes import normalised
from npfm.reflectance.table import CHANNELS
from npfm.storage.files import Kind, marked, replacing

NAME = "csv"
ABOUT = "the factors D, F and G and the diffuse part as columns of a spreadsheet"
SUFFIX = ".csv"
MODELS = ("independent-g", "g-from-d")
FIRST = "theta_h (degrees)"
KIND = Kind("a table of factors", SUFFIX, marked(f"{FIRST},".encode()))
DIGITS = 6  # float32 has no more

Array = NDArray[np.float64]


def write(path: str, sources: Sequence[Source]) -> None:
    """Write the factors: angles with their values, three times, and the diffuse part."""
    [source] = sources
    try:
        listed = columns(source.fit)
    except NpfmError as error:
        raise NpfmError(f"{source.path}: {error}") from error
    with replacing(path, KIND) as temporary, temporary.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(listed)
        for row in zip_longest(*listed.values()):
            writer.writerow("" if value is None else f"{value:.{DIGITS}g}" for value in row)


def columns(fit: Fit) -> dict[str, Array]:
    """Columns by what stands above them; a unit in brackets.

    Parameters
    ----------
    fit : Fit
        Of one of `MODELS`; the G of g-from-d is the one that follows from D.
    """
    D, F, G, rho_d = physical(fit)
    made = {FIRST: np.degrees(fit.grid.theta_h)}
    made |= _channels("D", "1/sr", D)
    made |= {"theta_d (degrees)": np.degrees(fit.grid.theta_d)} | _channels("F", "reflectance", F)
    made |= {"theta_i or theta_o (degrees)": np.degrees(G_THETA)} | _channels("G", "share", G)
    return made | _channels("rho_d", "1/sr", rho_d[:, None])


def physical(fit: Fit) -> tuple[Array, Array, Array, Array]:
    """Factors in the scale of a distribution of microfacets.

    Returns
    -------
    D, F, G : ndarray, shape (3, n)
        D in 1/sr at the bins of theta_h, F at those of theta_d, G at `G_THETA`.
    rho_d : ndarray, shape (3,)
        In 1/sr.

    Raises
    ------
    NpfmError
        If D has negative values or none but 0.
    """
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    for name, channel in zip(CHANNELS, p["D"], strict=True):
        if not channel.any() or (channel < 0).any():
            raise NpfmError(f"D of the {name} channel is no distribution; fit the material again")
    D = np.stack([normalised(channel, fit.grid) for channel in p["D"]])
    if fit.model == "g-from-d":
        p["G"] = np.stack([masking_shadowing(channel, fit.grid, G_THETA) for channel in p["D"]])
        p["G"] /= p["G"].max(axis=1, keepdims=True)
    largest = p["G"].max(axis=1)
    # D is largest somewhere, where its scale is exact.
    scale = p["D"].max(axis=1) / D.max(axis=1)
    F = (4 * p["rho_s"] * scale * largest**2)[:, None] * p["F"]
    return D, F, p["G"] / largest[:, None], p["rho_d"]


def _channels(name: str, unit: str, values: Array) -> dict[str, Array]:
    return {f"{name} {c} ({unit})": v for c, v in zip(CHANNELS, values, strict=True)}
