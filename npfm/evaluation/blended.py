"""Materials between others: blends of their factors, each factor by its logarithm.

A blend of tables shows the highlights of its materials one on top of the other. Where factors are
blended in logarithms there is one highlight, of a width in between. The specular part is then the
weighted geometric mean of the specular parts, whatever scales the factors have, and the diffuse
coefficients, which may be 0, are averaged.

A geometric mean is darker than what it is of: by Hoelder's inequality its albedo is at most the
geometric mean of the albedos. `same_albedo` takes rho_s so that the specular albedo at normal
incidence is the average.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.fitting.basis.curves import Basis, coefficients, log_factors, reconstruct
from npfm.fitting.channels import as_table
from npfm.fitting.factors.microfacet import G_NODES, G_THETA, elevations, tabulate_channel
from npfm.fitting.fits import Fit, load
from npfm.reflectance.grids import Grid
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, Table
from npfm.rendering.products import Products, Reading

Array = NDArray[np.float64]

FACTORS = ("D", "F", "G")
PARAMETERS = (*FACTORS, "rho_s", "rho_d")
#: Least value of a factor whose logarithm is taken, as a share of its largest: the clamp of
#: independent-g (Bagher et al. 2016, section 4.3).
FLOOR = 1e-6
#: Stands for a rho_s of 0. Others may be anything: F of a mirror is largest at grazing, and rho_s a
#: million times as large for it.
NOTHING = 1e-30


@dataclass(frozen=True)
class Palette:
    """Materials that are blended, by the logarithms of their factors.

    Parameters
    ----------
    logs : mapping of str to ndarray, shape (materials, 3, n)
        Of D, F and G.
    log_rho_s, rho_d : ndarray, shape (materials, 3)
    grid : HalfDifference
        Of the tables that the factors were fitted to.
    """

    logs: Mapping[str, Array]
    log_rho_s: Array
    rho_d: Array
    grid: HalfDifference

    @property
    def value_count(self) -> int:
        """Number of values of one material."""
        return sum(logs[0].size for logs in self.logs.values()) + 2 * len(CHANNELS)

    def factors(self, parts: NDArray) -> dict[str, Array]:
        """D, F and G of blends of these parts of the materials, shape (n, materials)."""
        return {name: np.exp(np.tensordot(parts, logs, 1)) for name, logs in self.logs.items()}

    def products(self, parts: NDArray) -> Products:
        """Blends in logarithms: the specular part is the geometric mean.

        Parameters
        ----------
        parts : ndarray, shape (n, materials)
            How much of each material there is; each row adds up to 1.
        """
        rho_s = np.exp(parts @ self.log_rho_s)
        return Products(**self.factors(parts), rho_s=rho_s, rho_d=parts @ self.rho_d)

    def same_albedo(self, parts: NDArray) -> Products:
        """The same blends with the average of the specular albedos at normal incidence."""
        blends = self.products(parts)
        own = specular_albedo(self.products(np.eye(len(self.rho_d))), self.grid)
        made = specular_albedo(blends, self.grid)
        return replace(blends, rho_s=blends.rho_s * (parts @ own) / made)


#: Blends of a palette, by their names.
BLENDS: dict[str, Callable[[Palette, NDArray], Products]] = {
    "log-factors": Palette.products,
    "same-albedo": Palette.same_albedo,
}


def palette(paths: Sequence[str]) -> Palette:
    """Gather the factors of fits.

    Parameters
    ----------
    paths : sequence of str
        Files of fits of independent-g, or of another model of one D, F and G a channel.

    Raises
    ------
    NpfmError
        If a file is no fit, has other parameters, or is on another grid than the first.
    """
    fits = [load(path) for path in paths]
    grid = fits[0].grid
    for path, fit in zip(paths, fits, strict=True):
        _check(path, fit, grid)
    given = {
        name: np.stack([fit.parameters[name].astype(float) for fit in fits]) for name in PARAMETERS
    }
    logs = {name: log_factors(given[name], FLOOR) for name in FACTORS}
    strength = np.maximum(given["rho_s"], 0)
    for name in FACTORS:
        strength = strength * np.maximum(given[name].max(axis=-1), 0) ** (2 if name == "G" else 1)
    log_rho_s = np.log(np.maximum(strength, NOTHING))
    return Palette(logs, log_rho_s, np.maximum(given["rho_d"], 0), grid)


def in_bases(given: Palette, bases: Mapping[str, Basis]) -> Palette:
    """Lay factors into bases of their logarithms, and keep the specular albedo at normal incidence.

    A blend of the coefficients of the curves is the blend of the logarithms that they make.

    Parameters
    ----------
    given : Palette
    bases : mapping of str to Basis
        Of D, F and G.
    """
    logs = {}
    for name, basis in bases.items():
        rows = given.logs[name].reshape(-1, basis.mean.size)
        found = np.log(reconstruct(basis, coefficients(basis, rows)))
        logs[name] = found.reshape(given.logs[name].shape)
    laid, alone = replace(given, logs=logs), np.eye(len(given.rho_d))
    before, after = (specular_albedo(p.products(alone), p.grid) for p in (given, laid))
    return replace(laid, log_rho_s=given.log_rho_s + np.log(before / after))


def _check(path: str, fit: Fit, grid: Grid) -> None:
    if not isinstance(grid, HalfDifference) or fit.grid != grid:
        raise NpfmError(
            f"{path}: on the grid {fit.grid.name}; give fits on one half-difference grid"
        )
    channels = len(CHANNELS)
    wanted: dict[str, tuple[int, ...]] = {
        "D": (channels, grid.theta_h_bins),
        "F": (channels, grid.theta_d_bins),
        "G": (channels, G_NODES),
        "rho_s": (channels,),
        "rho_d": (channels,),
    }
    if {key: value.shape for key, value in fit.parameters.items()} != wanted:
        raise NpfmError(
            f"{path}: a fit of {fit.model} has no single D, F and G a channel to be blended; "
            "give fits of independent-g"
        )


def specular_albedo(products: Products, grid: HalfDifference) -> Array:
    """Share of light that falls along the normal which the specular part reflects, shape (n, 3).

    There theta_h = theta_d = theta_o / 2: the integral is a sum over the bins of theta_h below 45
    degrees, each at its middle.
    """
    edges = np.minimum(grid.theta_h_edges, np.pi / 4)
    inside = edges[:-1] < np.pi / 4
    half, width = ((edges[1:] + edges[:-1]) / 2)[inside], np.diff(edges)[inside]
    F = products.F[..., (half / (np.pi / 2) * grid.theta_d_bins).astype(int)]
    at = np.interp(2 * half, G_THETA, np.arange(float(G_NODES)))
    node = np.minimum(at.astype(int), G_NODES - 2)
    before, after = products.G[..., node], products.G[..., node + 1]
    G = products.G[..., :1] * (before + (at - node) * (after - before))
    # The cosine of theta_o is in the integral, and in the denominator of the product.
    ring = 2 * np.pi * np.sin(2 * half) * 2 * width
    return products.rho_s * ((products.D[..., inside] * F * G) @ ring)


def reading(grid: HalfDifference) -> Reading:
    """Where the cells of a grid read G."""
    at = elevations(grid)
    return Reading(at.node_i, at.part_i, at.node_o, at.part_o, at.inverse_cosines)


def tabulated(products: Products, grid: HalfDifference) -> list[Table]:
    """Tables of blends, one each."""
    return [
        as_table([tabulate_channel(grid, *channel) for channel in zip(*factors, strict=True)], grid)
        for factors in zip(
            *(products.D, products.F, products.G, products.rho_d, products.rho_s), strict=True
        )
    ]
