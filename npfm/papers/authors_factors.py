"""The factors that Bagher et al. 2016 published for some materials."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import HalfDifference
from npfm.storage.archives import read_arrays

Array = NDArray[np.float64]

#: Axes of each array but the material's.
SHAPES = dict.fromkeys(("D", "G", "F"), (90, 3)) | dict.fromkeys(("rho_d", "rho_s"), (3,))
#: Nodes of G, in radians: at whole degrees, half a degree before those of our fits, while D and F
#: are those of a bin. The file does not say; of three readings it is the one that the measured
#: values support (docs/reproduction.md).
G_THETA = np.deg2rad(np.arange(90.0))
#: The factors of 10 000 materials in double precision, with their names, are no more.
MOST_BYTES = 2**26


def read(path: str | Path) -> dict[str, Mapping[str, Array]]:
    """Read published factors.

    Parameters
    ----------
    path : str or Path
        ``.npz`` with `names` (n), `D`, `G` and `F` (n, 90, 3), and `rho_d` and `rho_s` (n, 3) as
        coefficients of pi times the BRDF; docs/data.md.

    Returns
    -------
    dict of str to mapping of str to ndarray of shape (3, 90), or (3,)
        D, G and F, and the coefficients of the BRDF in 1/sr, by material, the channels first; NaN
        at the first node of G and the first bin of F, which no sample has touched.

    Raises
    ------
    NpfmError
        If the file is absent or holds something else.
    """
    arrays = read_arrays(path, "published factors", "see docs/data.md", MOST_BYTES)
    if missing := sorted({"names", *SHAPES} - set(arrays)):
        raise NpfmError(f"{path}: lacks {', '.join(missing)}; see docs/data.md")
    names = _names(path, arrays["names"])
    factors = {name: _checked(path, name, arrays[name], len(names)) for name in SHAPES}
    for name in ("rho_d", "rho_s"):
        factors[name] /= np.pi
    factors["G"][:, 0] = factors["F"][:, 0] = np.nan
    return {
        material: {name: array[k].T for name, array in factors.items()}
        for k, material in enumerate(names)
    }


def _names(path: str | Path, names: NDArray) -> list[str]:
    if names.ndim != 1 or names.dtype.kind != "U" or len(set(names)) != names.size:
        raise NpfmError(f"{path}: names is not a list of different texts; see docs/data.md")
    return [str(name) for name in names]


def _checked(path: str | Path, name: str, array: NDArray, count: int) -> Array:
    expected = (count, *SHAPES[name])
    if array.shape != expected:
        raise NpfmError(
            f"{path}: {name} is of shape {array.shape}, not {expected}; see docs/data.md"
        )
    if array.dtype.kind not in "fiu":
        raise NpfmError(f"{path}: {name} does not hold numbers; see docs/data.md")
    seen = array[:, 1:] if name in ("G", "F") else array  # No sample has touched the first.
    if not np.isfinite(seen).all() or (seen < 0).any():
        raise NpfmError(
            f"{path}: {name} holds a NaN, an infinity or a negative value; take the file again "
            "from where it was published"
        )
    return array.astype(float)


def tabulate_channel(
    grid: HalfDifference,
    D: Array,
    F: Array,
    G: Array,
    rho_d: float,
    rho_s: float,
    *,
    g_theta: Array = G_THETA,
    f_theta: Array | None = None,
) -> Array:
    """Equation 3 at the centre of every cell of a grid, for one channel of published factors.

    Parameters
    ----------
    grid : HalfDifference
        With as many theta_h and theta_d bins as D and F have components.
    D, F, G : ndarray
        Factors, NaN where a component is not known.
    rho_d, rho_s : float
        In 1/sr.
    g_theta, f_theta : ndarray, optional
        Angles in radians that the components of G and F belong to, linear between them; without
        `f_theta`, those of F belong to the bins of theta_d.

    Returns
    -------
    ndarray, shape grid.shape
        BRDF in 1/sr; NaN in cells that rest on an unknown component, and below the horizon.
    """
    if f_theta is not None:
        F = np.interp(grid.theta_d, f_theta, F)
    value = rho_s * D[:, None, None] * F[:, None]
    for cosine in grid.cosines:
        theta = np.arccos(np.clip(cosine, 0, 1))
        value = value * np.interp(theta, g_theta, G) / np.cos(np.minimum(theta, g_theta[-1]))
    return np.where(grid.above_horizon, rho_d + value, np.nan)
