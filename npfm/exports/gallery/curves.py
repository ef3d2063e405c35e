"""Factors of fits as curves over angles, beside those that were published."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from npfm.figures.figure06 import PUBLISHED_ANGLES, published_curves, scale_to, scaled
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.fits import Fit
from npfm.reflectance.half_difference import HalfDifference

DIGITS = 5  # of a value in a page
MOST_VALUES = 3  # of a parameter that is told in words: one a channel


def curves(fit: Fit, published: Mapping[str, NDArray]) -> list[dict[str, Any]]:
    """Return D, G, F and F G^2 of a fit, as far as its model has them.

    Parameters
    ----------
    fit : Fit
        Curves are its arrays of a value a bin, D over theta_h, G over theta_i or theta_o, F over
        theta_d; where D but no G was fitted by Smith's relation, G follows from D.
    published : mapping of str to ndarray
        Published factors of the material, as `npfm.datasets.published_factors.read` returns them,
        or nothing.

    Returns
    -------
    list of dict
        `name`; `angles` in degrees and `values`, a list a channel or one for all, with maximum 1
        up to 80 degrees; `lobes` where they are of lobes that the channels share; and, beside
        curves of every channel, `published_angles` and `published`, in the scale of ours.
    """
    if not isinstance(fit.grid, HalfDifference):
        return []
    # Elsewhere F or D takes over what G does there, and nothing would be comparable.
    of_channels = all(name in fit.parameters and not _shared(fit, name) for name in "DGF")
    theirs = published_curves(published) if of_channels else {}
    made = [_curve(*named, theirs) for named in _factors(fit)]
    return [curve | ({"lobes": True} if _shared(fit, curve["name"]) else {}) for curve in made]


def parameters(fit: Fit) -> dict[str, list[float | None]]:
    """Return what a model has beside curves and tables: values by the name of the parameter."""
    small = {name: a for name, a in fit.parameters.items() if a.size <= MOST_VALUES}
    return {name: _rounded(array.ravel()) for name, array in small.items()}


def _factors(fit: Fit) -> Iterator[tuple[str, NDArray, NDArray]]:
    """Name, angles in degrees and values of every factor."""
    theta_h, theta_d = np.degrees(fit.grid.theta_h), np.degrees(fit.grid.theta_d)
    nodes = np.degrees(G_THETA)
    found = {
        name: _values(fit, name, n.size)
        for name, n in (("D", theta_h), ("G", nodes), ("F", theta_d))
    }
    if fit.model == "g-from-d" and found["D"] is not None:
        found["G"] = np.stack([masking_shadowing(D, fit.grid, G_THETA) for D in found["D"]])
    for (name, values), angles in zip(found.items(), (theta_h, nodes, theta_d), strict=True):
        if values is not None:
            yield name, angles, values
    F, G = found["F"], found["G"]
    if F is not None and G is not None and not _shared(fit, "G"):
        at_bins = np.stack([np.interp(theta_d, nodes, g) for g in G])
        yield "F G²", theta_d, F * at_bins**2


def _shared(fit: Fit, name: str) -> bool:
    """Whether a parameter has lobes that all channels share: shape (1, lobes, bins)."""
    array = fit.parameters.get(name)
    return array is not None and array.ndim == 3 and len(array) == 1


def _values(fit: Fit, name: str, bins: int) -> NDArray[np.float64] | None:
    array = fit.parameters.get(name)
    if array is not None and _shared(fit, name):
        array = array[0]
    if array is None or array.ndim != 2 or array.shape[1] != bins:
        return None
    return array.astype(float)


def _curve(
    name: str, angles: NDArray, values: NDArray, theirs: Mapping[str, NDArray]
) -> dict[str, Any]:
    ours = np.stack([scaled(channel, angles) for channel in values])
    made = {"name": name, "angles": _rounded(angles), "values": [_rounded(v) for v in ours]}
    if name in theirs and len(ours) == len(theirs[name]):
        nodes = PUBLISHED_ANGLES[name]
        made |= {
            "published_angles": _rounded(nodes),
            "published": [
                _rounded(p * scale_to(np.interp(angles, nodes, p), v, angles))
                for p, v in zip(theirs[name], ours, strict=True)
            ],
        }
    return made


def _rounded(values: NDArray) -> list[float | None]:
    return [float(f"{v:.{DIGITS}g}") if np.isfinite(v) else None for v in values]
