"""A fit as a function of GLSL that reads its numbers from rows.

Where the rows are, the function does not know: `npfm.exports.glsl` writes them beside it, and the
demo of the gallery has them in a texture. The numbers of independent-g are in the rows of the
paper's "uber-texture" (`npfm.exports.texture`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.factors.microfacet import G_NODES, G_THETA
from npfm.fitting.factors.smith import masking_shadowing
from npfm.fitting.fits import Fit
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.slopes import ELEVATIONS, normalised, projected_area

FOLDER = Path(__file__).parent
TABULATED = ("fresnel_table", "distribution_table", "facets")
FORMULA = ("fresnel_table", "distribution_ggx", "facets")
SCHLICK = ("fresnel_schlick", "distribution_ggx", "facets")

Parameters = Mapping[str, NDArray[np.float64]]
Sections = dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Shader:
    """A function of GLSL, and the numbers that it reads.

    Parameters
    ----------
    pieces : tuple of str
        Names of the files beside this one that it is made of, after ``angles``.
    constants : dict of str to int, bool or float
        What the pieces are compiled with, by their names in GLSL: bins, and the first row of
        each of the model's arrays.
    rows : ndarray of float32, shape (n, 3)
        Numbers of the channels. What the channels share is three times there.
    """

    pieces: tuple[str, ...]
    constants: dict[str, float]
    rows: NDArray[np.float32]

    @property
    def source(self) -> str:
        """Constants, and the functions down to ``npfm_brdf``; not ``npfm_row``, which they call."""
        said = [_constant(*named) for named in self.constants.items()]
        texts = [(FOLDER / f"{piece}.glsl").read_text() for piece in ("angles", *self.pieces)]
        return "\n".join(["vec3 npfm_row(int k);", *said, "", "\n".join(texts)])


def shader(fit: Fit) -> Shader:
    """Return a fit as a function of GLSL.

    Parameters
    ----------
    fit : Fit
        Of one of `MODELS`.

    Raises
    ------
    NpfmError
        If it is of another model, or on a grid that is not of half and difference angles.
    """
    if fit.model not in MODELS or not isinstance(fit.grid, HalfDifference):
        raise NpfmError(
            f"a fit of {fit.model} on the grid {fit.grid.name} is no function of GLSL; "
            f"give one of {' or '.join(MODELS)} on a {HalfDifference.kind} grid"
        )
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    pieces, constants, sections = MODELS[fit.model](p, fit.grid)
    starts = np.cumsum([0, *(len(rows) for rows in sections.values())]).tolist()
    places = {f"npfm_{name}": start for name, start in zip(sections, starts, strict=False)}
    bins = {"npfm_theta_h_bins": fit.grid.theta_h_bins, "npfm_theta_d_bins": fit.grid.theta_d_bins}
    rows = np.concatenate(list(sections.values())).astype(np.float32)
    return Shader(pieces, constants | bins | places, rows)


def _lobes(p: Parameters, grid: HalfDifference) -> tuple[tuple[str, ...], dict, Sections]:
    """Rows of lobes, each with its D and its G, in the order of `npfm.exports.texture`."""
    D, G = (_by_lobe(p[name]) for name in "DG")
    rho_s = p["rho_s"].reshape(3, -1).T
    constants = {
        "npfm_lobes": len(rho_s),
        "npfm_G_nodes": G_NODES,
        "npfm_spline": "spline" in p,
        "npfm_least_cosine": float(np.cos(G_THETA[-1])),
        "npfm_largest_cosine": float(np.cos(G_THETA[0])),
    }
    sections = {"rho_d": p["rho_d"][None], "rho_s": rho_s, "D": D, "G": G, "F": p["F"].T}
    return ("lobes",), constants, sections


def _by_lobe(factor: NDArray) -> NDArray:
    """Rows, one lobe after another, of a factor (channels or 1, nodes) or (.., lobes, nodes)."""
    every = np.broadcast_to(factor, (3, *factor.shape[1:]))
    return every.reshape(3, -1).T


def _derived(p: Parameters, grid: HalfDifference) -> tuple[tuple[str, ...], dict, Sections]:
    G = np.stack([masking_shadowing(D, grid, G_THETA) for D in p["D"]])
    return _lobes({**p, "G": G / G.max(axis=1, keepdims=True)}, grid)


def _tabulated(p: Parameters, grid: HalfDifference) -> tuple[tuple[str, ...], dict, Sections]:
    D = normalised(p["D"][0], grid)
    rows = {"D": _grey(D), "sigma": _grey(projected_area(D, grid))}
    return TABULATED, {"npfm_sigma_nodes": ELEVATIONS.size}, _colours(p) | rows


def _formula(p: Parameters, grid: HalfDifference) -> tuple[tuple[str, ...], dict, Sections]:
    return FORMULA, {}, _colours(p) | {"alpha": _grey(p["alpha"])}


def _schlick(p: Parameters, grid: HalfDifference) -> tuple[tuple[str, ...], dict, Sections]:
    colours = {name: p[name][None] for name in ("rho_d", "rho_s")}
    return SCHLICK, {}, colours | {name: _grey(p[name]) for name in ("alpha", "f0")}


def _colours(p: Parameters) -> Sections:
    """Rows of a model without a diffuse part."""
    return {"rho_d": np.zeros((1, 3)), "rho_s": p["rho_s"][None], "F": p["F"].T}


def _grey(values: NDArray) -> NDArray:
    return np.repeat(values[:, None], 3, axis=1)


def _constant(name: str, value: float) -> str:
    kind = {bool: "bool", int: "int", float: "float"}[type(value)]
    return f"const {kind} {name} = {str(value).lower()};"


#: How the numbers of each model are laid out.
MODELS: dict[str, Callable[[Parameters, HalfDifference], tuple[tuple[str, ...], dict, Sections]]]
MODELS = {
    "independent-g": _lobes,
    "g-from-d": _derived,
    "shared-lobes": _lobes,
    "power-iteration": _tabulated,
    "ggx": _formula,
    "ggx-fitted": _schlick,
}
