"""Fits of independent-g and of shared-lobes in one form, and what samples see of their factors.

Independent-g is one lobe of one channel, three times; lobes that channels share are those of all
three, once; lobes that they do not share are three times those of one.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.fits import Fit
from npfm.fitting.objective import (
    VOLUME_FORM,
    Objective,
    compressive_weight,
    counted,
    importance,
    solid_angles,
    volume_form,
    weighted_median,
)
from npfm.fitting.shared_lobes.places import Places, places
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS

Array = NDArray[np.float64]

FACTORS = ("D", "F", "G")
#: Models whose fits have factors that a basis is made of: of one lobe a channel, and of several.
MODELS = ("independent-g", "shared-lobes")
#: As many as `npfm.models.shared_lobes` takes.
MOST_LOBES = 5
#: About so many bins of phi_d tell what the samples see, of the 90 of a folded table.
SEEN_BINS = 5


@dataclass(frozen=True)
class Lobes:
    """Lobes of the channels that share them.

    Parameters
    ----------
    D, F, G : ndarray, shapes (lobes, theta_h), (channels, theta_d), (lobes, nodes)
    rho_s, rho_d : ndarray, shapes (channels, lobes), (channels,)
    """

    D: Array
    F: Array
    G: Array
    rho_s: Array
    rho_d: Array


def checked_lobes(fit: Fit) -> list[Lobes]:
    """Return `lobes_of` a fit of one of `MODELS`, on a half-difference grid, out of a file.

    Raises
    ------
    NpfmError
        If its arrays are not those of its model.
    """
    theta_h, theta_d, _ = fit.grid.shape
    shapes = {name: fit.parameters[name].shape for name in (*FACTORS, "rho_s", "rho_d")}
    channels, *lobes = shapes["D"][:-1] or (0,)
    wanted = {
        "D": (channels, *lobes, theta_h),
        "F": (len(CHANNELS), theta_d),
        "G": (channels, *lobes, G_NODES),
        "rho_s": (len(CHANNELS), *lobes),
        "rho_d": (len(CHANNELS),),
    }
    if fit.model == MODELS[0]:
        known = channels == len(CHANNELS) and not lobes
    else:
        known = channels in (1, len(CHANNELS)) and len(lobes) == 1 and lobes[0] <= MOST_LOBES
    if shapes != wanted or not known:
        there = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise NpfmError(f"its arrays ({there}) are not those of {fit.model}; fit it again")
    return lobes_of(fit.parameters)


def lobes_of(parameters: Mapping[str, NDArray]) -> list[Lobes]:
    """Return the lobes that are the parameters of a fit of independent-g or of shared-lobes."""
    D, F, G, rho_s, rho_d = (
        np.asarray(parameters[name], dtype=float) for name in (*FACTORS, "rho_s", "rho_d")
    )
    if D.ndim == 2:  # independent-g
        D, G, rho_s = D[:, None], G[:, None], rho_s[:, None]
    if len(D) == 1:
        return [Lobes(D[0], F, G[0], rho_s, rho_d)]
    return [
        Lobes(D[c], F[c, None], G[c], rho_s[c, None], rho_d[c, None]) for c in range(len(rho_d))
    ]


def parameters_of(lobes: Sequence[Lobes], single: bool) -> dict[str, Array]:
    """Return the parameters of a fit, the inverse of `lobes_of`.

    Parameters
    ----------
    lobes : sequence of Lobes
        Of all channels.
    single : bool
        Whether the model is independent-g, whose arrays have no axis of the lobes.
    """
    D, G = (np.stack([getattr(each, name) for each in lobes]) for name in ("D", "G"))
    F, rho_s, rho_d = (
        np.concatenate([getattr(each, name) for each in lobes]) for name in ("F", "rho_s", "rho_d")
    )
    if single:
        D, G, rho_s = D[:, 0], G[:, 0], rho_s[:, 0]
    return {"D": D, "F": F, "G": G, "rho_s": rho_s, "rho_d": rho_d}


@dataclass(frozen=True)
class Seen:
    """What the samples see of each value of D, F and G; shapes as of `Lobes`.

    Each is a share of the energy: half the second derivative of the objective in the logarithm of
    the value, which is what an error of the logarithm costs.
    """

    D: Array
    F: Array
    G: Array


@dataclass(frozen=True)
class Cells:
    """Some cells of a grid, for sums over the samples; arrays of shape (theta_h * theta_d, phi_d).

    Parameters
    ----------
    at : Places
        Where they read G.
    weight : ndarray
        w_V w_I of those that count.
    plane : tuple of int
        Bins of theta_h and theta_d.
    compressive : bool
        Whether the objective has the weight w_C, which hangs on the value.
    """

    at: Places
    weight: Array
    plane: tuple[int, int]
    compressive: bool

    def weights(self, value: Array) -> Array:
        """Weights w of equation 8 at values of the BRDF, so that the energy of these is 1."""
        weight = self.weight
        lit = np.where(value > 0, weight, 0.0)
        if self.compressive and lit.any():
            # The objective's unit: the median, that of what is not black where most is.
            unit = weighted_median(value, weight) or weighted_median(value, lit)
            weight = weight * compressive_weight(value / unit)
        return weight / (np.vdot(weight, value**2) or 1.0)

    def over_nodes(self, values: Array) -> Array:
        """Sums of values of cells over those that read each node of G, at either place."""
        total, at = np.zeros(self.at.nodes), self.at
        for first, taps in ((at.first_i, at.taps_i), (at.first_o, at.taps_o)):
            for t in range(taps.shape[-1]):
                part = (values * np.abs(taps[..., t])).ravel()
                total += np.bincount((first + t).ravel(), part, minlength=at.nodes)
        return total


def cells(grid: HalfDifference, objective: Objective, spline: bool = False) -> Cells:
    """Every cell of about `SEEN_BINS` bins of phi_d of a folded table."""
    half = grid.phi_d_bins // 2
    every = max(half // SEEN_BINS, 1)
    volume = volume_form(grid) if objective.cells == VOLUME_FORM else solid_angles(grid)
    weight = np.where(counted(grid, objective.max_angle), volume * importance(grid), 0.0)
    at = places(grid, every, spline)
    kept = weight[..., every // 2 : half : every].reshape(at.inverse_cosines.shape)
    return Cells(at, kept, grid.shape[:2], objective.compressive)


def speculars(lobes: Lobes, at: Cells) -> Array:
    """Parts of the BRDF that lobes make, shape (channels, lobes, theta_h * theta_d, phi_d)."""
    rows = np.repeat(lobes.D, at.plane[1], axis=1)[..., None]
    each = rows * np.stack([at.at.kernel(G) for G in lobes.G])
    F = np.tile(lobes.F, at.plane[0])[:, None, :, None]
    return lobes.rho_s[..., None, None] * F * each


def seen_by(lobes: Lobes, at: Cells) -> Seen:
    """What the samples of a material would see of its factors if it were as its fit says."""
    parts = speculars(lobes, at)
    D, F, G = np.zeros_like(lobes.D), np.zeros_like(lobes.F), np.zeros_like(lobes.G)
    for channel, part in enumerate(parts):
        whole = part.sum(0)
        weight = at.weights(lobes.rho_d[channel] + whole)
        F[channel] = (weight * whole**2).sum(1).reshape(at.plane).sum(0)
        squares = weight * part**2
        D += squares.sum(2).reshape(-1, *at.plane).sum(2)
        # The derivative at a place is shared out to the two nodes that it is read between.
        G += np.stack([at.over_nodes(square) for square in squares])
    return Seen(D, F, G)
