"""The fits of many materials in one small picture, for a renderer on a graphics card.

Bagher et al. 2016, appendix "Rendering Details": all fits of independent-g in one float texture.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from npfm.errors import NpfmError
from npfm.exports.sources import Source
from npfm.fitting.fits import Fit
from npfm.storage.names import distinct
from npfm.storage.pictures import EXR, write_exr

NAME = "texture"
ABOUT = "the factors of many materials as one small float picture, for a shader"
SUFFIX = ".exr"
MODELS = ("independent-g",)
MANY = True
KIND = EXR
#: Parameters from the top row to the bottom row.
PARAMETERS = ("rho_d", "rho_s", "D", "G", "F")


def write(path: str, sources: Sequence[Source]) -> None:
    """Write the texture of some fits, with a header that tells the names and rows.

    Raises
    ------
    NpfmError
        If two fits have one name, a name has a blank in it, or `texture` refuses a fit.
    """
    names = distinct(source.name for source in sources)
    if wrong := [name for name in names if name.split() != [name]]:
        raise NpfmError(f"'{wrong[0]}': blanks stand between names in the header; rename the fit")
    fits = {source.name: source.fit for source in sources}
    write_exr(path, texture(fits), labels(fits))


def texture(fits: Mapping[str, Fit]) -> NDArray[np.float32]:
    """Lay fits side by side.

    Parameters
    ----------
    fits : mapping of str to Fit
        Fits with the parameters `PARAMETERS` by material, all on one grid.

    Returns
    -------
    ndarray of float32, shape (rows, materials, 3)
        A column each material, colour channels last; rows as `rows` says. rho_d and rho_s are in
        1/sr, the factors have maximum 1.

    Raises
    ------
    NpfmError
        If a fit has other parameters or another grid.
    """
    first = next(iter(fits.values()))
    for material, fit in fits.items():
        if set(fit.parameters) != set(PARAMETERS) or fit.grid != first.grid:
            raise NpfmError(
                f"the fit of {material} does not go into a texture (a fit of {fit.model} on the "
                f"grid {fit.grid.name}); give fits of independent-g on one grid"
            )
    columns = [
        np.concatenate([fit.parameters[name].reshape(3, -1) for name in PARAMETERS], axis=1)
        for fit in fits.values()
    ]
    return np.stack(columns, axis=-1).transpose(1, 2, 0)


def rows(fit: Fit) -> dict[str, slice]:
    """Rows of the texture that hold each parameter."""
    sizes = [fit.parameters[name].size // 3 for name in PARAMETERS]
    ends = np.cumsum(sizes)
    return {
        name: slice(int(end) - size, int(end))
        for name, size, end in zip(PARAMETERS, sizes, ends, strict=True)
    }


def labels(fits: Mapping[str, Fit]) -> dict[str, str]:
    """What the header of the picture says: materials from the left, rows of the parameters."""
    places = rows(next(iter(fits.values())))
    return {
        "materials": " ".join(fits),
        "rows": " ".join(f"{name}={p.start}:{p.stop}" for name, p in places.items()),
    }
