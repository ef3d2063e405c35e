"""Factors that Bagher et al. 2016 published for some materials, read from an ``.npz`` file."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.storage.archives import read_arrays

Array = NDArray[np.float64]
#: D, G and F, the channels first, and rho_d and rho_s.
Factors = Mapping[str, Array]

#: Axes of each array but the material's.
SHAPES = dict.fromkeys(("D", "G", "F"), (90, 3)) | dict.fromkeys(("rho_d", "rho_s"), (3,))
#: Nodes of G, in radians: at whole degrees, half a degree before those of our fits, while D and F
#: are those of a bin. The file does not say; of three readings it is the one that the measured
#: values support (docs/reproduction.md).
G_THETA = np.deg2rad(np.arange(90.0))
#: The factors of 10 000 materials in double precision, with their names, are no more.
MOST_BYTES = 2**26


def read(path: str | Path) -> dict[str, Factors]:
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
