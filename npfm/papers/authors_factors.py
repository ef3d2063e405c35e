"""The factors that Bagher et al. 2016 published for some materials."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError

#: Axes of each array but the material's.
SHAPES = dict.fromkeys(("D", "G", "F"), (90, 3)) | dict.fromkeys(("rho_d", "rho_s"), (3,))


def read(path: str | Path) -> dict[str, Mapping[str, NDArray[np.float64]]]:
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
    try:
        with np.load(path) as archive:
            names = [str(name) for name in archive["names"]]
            factors = {name: np.array(archive[name], dtype=float) for name in SHAPES}
    except (OSError, ValueError, KeyError, EOFError) as error:
        raise NpfmError(f"{path}: cannot be read as published factors ({error})") from error
    for name, array in factors.items():
        if array.shape != (len(names), *SHAPES[name]):
            raise NpfmError(
                f"{path}: {name} is of shape {array.shape}, not {(len(names), *SHAPES[name])}; "
                "see docs/data.md"
            )
    for name in ("rho_d", "rho_s"):
        factors[name] /= np.pi
    factors["G"][:, 0] = factors["F"][:, 0] = np.nan
    return {
        material: {name: array[k].T for name, array in factors.items()}
        for k, material in enumerate(names)
    }
