"""An anisotropic distribution of microfacets from backscattered light, by power iterations.

Dupuy et al. 2015, sections 4.2 and 4.3: with light and view both at o, F0 D(o) is 4 f(o, o) A(o, o)
with A(o, o) = cos(theta_o) times the integral of |o.h| D(h) (`npfm.reflectance.anisotropic_slopes`;
the paper has max(0, o.h), see `eigenproblem`). The matrix of 8100 x 8100 numbers that its algorithm
1 fills at 90 x 90 normals is circulant in the azimuth, and its products are taken by Fourier
transforms: no more is kept than a matrix over the elevations for each frequency.
"""

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.power_iterations.eigenproblem import iterated
from npfm.reflectance.anisotropic_slopes import Normals, facing, projected, too_narrow

Array = NDArray[np.float64]

#: Whether the shadowing has max(0, o.h) in place of |o.h|, by the names of `eigenproblem.KERNELS`.
CLAMPED = {"consistent": False, "paper": True}
TOO_NARROW = "degenerate: too few azimuths for so narrow a highlight"


def distribution(backscattered: Array, normals: Normals, kernel: str) -> tuple[Array, str, int]:
    """D of a material from its values with light and view in one direction.

    Parameters
    ----------
    backscattered : ndarray, shape normals.shape
        f(o, o) in any unit, not negative, for o at each of the normals.
    normals : Normals
        Where D is looked for.
    kernel : str
        ``consistent`` or ``paper``, as in `eigenproblem.KERNELS`.

    Returns
    -------
    D : ndarray, shape normals.shape
        Largest value 1, not negative.
    status : str
        ``converged``, ``iteration cap``, or what makes D arbitrary.
    iterations : int
    """
    spectrum = facing(normals, tuple(normals.theta_h.tolist()), CLAMPED[kernel])
    rows = 4 * backscattered * np.cos(normals.theta_h)[:, None]
    D, status, iterations = iterated(lambda D: rows * projected(spectrum, D), normals.shape)
    return D, resolved_status(D, normals, status), iterations


def resolved_status(D: Array, normals: Normals, status: str) -> str:
    """Status of iterations that ended at D, which may be too narrow for its azimuths."""
    return TOO_NARROW if status == "converged" and too_narrow(D, normals) else status
