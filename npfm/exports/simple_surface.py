"""What programs with one metal and one plastic can say of a fit of ``ggx-fitted``.

Both are GGX with Smith's correlated shadowing, as the fit is: the lobe is the same, and its
roughness is the root of alpha. A metal has the colour of the fit at normal incidence and no diffuse
part; a dielectric has a base, of which less is seen where more is reflected above it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.evaluation.table_distances import distances
from npfm.exports.sources import Source
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.microsurfaces import ggx, ggx_area
from npfm.reflectance.table import INVALID, Table

Array = NDArray[np.float64]

#: A metal is taken unless a dielectric is nearer by more than this share of the fit itself:
#: programs that know no extensions show it as well.
NEARER = 0.01
#: Mean of (1 - cos)^5 over a hemisphere, weighted by the cosine.
MEAN_RISE = 1 / 21


@dataclass(frozen=True)
class Lobe:
    """A fit of ``ggx-fitted``.

    Parameters
    ----------
    rho_d, rho_s : ndarray, shape (3,)
        In 1/sr, and without unit.
    alpha, f0 : float
        Roughness, and Schlick's factor at normal incidence as a share of that at grazing.
    """

    rho_d: Array
    rho_s: Array
    alpha: float
    f0: float

    @property
    def normal(self) -> Array:
        """What is reflected at normal incidence, shape (3,), at most 1."""
        return np.minimum(self.rho_s * self.f0, 1)

    @property
    def roughness(self) -> float:
        """Root of alpha: the roughness of glTF, OpenPBR and most programs."""
        return float(np.sqrt(self.alpha))

    @property
    def weight(self) -> float:
        """What is reflected at grazing incidence by the brightest channel, at most 1."""
        return float(min(self.rho_s.max(), 1.0))

    def base(self, layer: Array) -> Array:
        """Albedo (3,) of a base that is `rho_d` below a layer that reflects shares of light."""
        return np.clip(np.pi * self.rho_d / np.maximum(1 - layer, 1e-3), 0, 1)


def lobe(source: Source) -> Lobe:
    """Return the parameters of a fit.

    Raises
    ------
    NpfmError
        If they are negative.
    """
    p = {name: array.astype(float) for name, array in source.fit.parameters.items()}
    if any((array < 0).any() for array in p.values()):
        raise NpfmError(f"{source.path}: negative parameters; fit the material again")
    return Lobe(p["rho_d"], p["rho_s"], float(p["alpha"][0]), float(p["f0"][0]))


def mean_schlick(normal: Array, weight: float) -> Array:
    """Mean over a hemisphere of what Schlick's form reflects."""
    return normal + (weight - normal) * MEAN_RISE


def schlick(normal: Array, weight: float, grid: HalfDifference) -> Array:
    """Schlick's form at the cells of a grid, shape (3, 1, theta_d_bins, 1)."""
    rise = (1 - np.cos(grid.theta_d)) ** 5
    return (normal[:, None] + (weight - normal[:, None]) * rise)[:, None, :, None]


def facets(alpha: float, grid: HalfDifference) -> Array:
    """D G / (4 cos(theta_i) cos(theta_o)) at the cells of a grid, in 1/sr."""
    cos_i, cos_o = (np.maximum(cosine, 1e-6) for cosine in grid.cosines)
    area_i, area_o = ggx_area(cos_i, alpha), ggx_area(cos_o, alpha)
    D = ggx(np.cos(grid.theta_h), alpha)[:, None, None]
    return D / (4 * (area_o * cos_i + area_i * cos_o - cos_i * cos_o))


def as_table(values: Array, grid: HalfDifference) -> Table:
    """Return a table of values above the horizon."""
    return Table(np.where(grid.above_horizon, values, INVALID), grid)


def chosen(metal: Table, dielectric: Table, fitted: Table) -> tuple[bool, str]:
    """Whether to take the metal, and how far what is taken is from the fit, in words.

    The distance is the root mean square difference of cube roots, of that of the fit itself.
    """
    black = Table(np.zeros_like(fitted.values), fitted.grid)
    near = {
        name: distances(table, fitted)["cube-root"]
        for name, table in (("metal", metal), ("dielectric", dielectric), ("black", black))
    }
    is_metal = near["metal"] < near["dielectric"] + NEARER * near["black"]
    share = near["metal" if is_metal else "dielectric"] / (near["black"] or 1.0)
    name = "a metal" if is_metal else "a dielectric"
    return is_metal, f"{name}, {share:.1%} from the fit (rms of cube roots)"
