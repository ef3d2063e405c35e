"""What the published fits of Ngan et al. 2005 have in common, and the lobes of some of them.

The fits are of MERL's stored values without the scaling of its channels: against the tables, the
published parameters of Cook and Torrance alone are low by a median of 0.03, 0.19 and 0.56 in red,
green and blue (as logarithms), so by log 1.15 and log 1.66 more in green and blue than in red.
Here the scaling is applied.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.parametric.lobes import Directions, Form, Model, Shape
from npfm.reflectance.merl import CHANNEL_SCALE
from npfm.reflectance.table import Table

#: MERL's scaling of the channels, relative to red.
CHANNEL_WEIGHT = CHANNEL_SCALE / CHANNEL_SCALE[0]
#: About so many samples are fitted to.
SAMPLES = 80_000


def ward(shape: Shape, at: Directions) -> NDArray:
    """Ward 1992: exp(-tan^2 theta_h / m^2) / (4 pi m^2 sqrt(cos theta_i cos theta_o)), in 1/sr."""
    m2 = shape["roughness"] ** 2
    return np.exp(-at.tan2_h / m2) / (4 * np.pi * m2 * np.sqrt(at.cos_i * at.cos_o))


def blinn_phong(shape: Shape, at: Directions) -> NDArray:
    """Blinn 1977: (n + 2) / (2 pi) cos(theta_h)^n, in 1/sr."""
    n = shape["n"]
    value = (n + 2) / (2 * np.pi) * at.cos_h**n
    # It depends on no other angle, and has a value at each of them.
    return np.broadcast_arrays(value, at.cos_i)[0]


WARD = Form(
    ward,
    lambda x: {"roughness": np.exp(x[0])},
    bounds=((np.log(2e-3),), (np.log(3.0),)),
    starts={f"roughness={m:g}": (np.log(m),) for m in (0.01, 0.04, 0.15, 0.4)},
    shared=True,
    samples=SAMPLES,
)
BLINN_PHONG = Form(
    blinn_phong,
    lambda x: {"n": np.exp(x[0])},
    bounds=((np.log(0.1),), (np.log(1e6),)),
    starts={f"n={n:g}": (np.log(n),) for n in (10, 100, 1000, 10_000)},
    shared=True,
    samples=SAMPLES,
)


def published(
    model: Model,
    table: Table,
    objective: Objective,
    albedos: tuple[NDArray, NDArray],
    shape: Mapping[str, NDArray],
) -> Fit:
    """Return published parameters as a fit; the table is for the record alone.

    Parameters
    ----------
    model : Model
        Whose they are.
    table, objective
        The measurement and what is recorded of it.
    albedos : two ndarrays, shape (3,)
        The published diffuse albedo, and what the lobe is multiplied by, as published.
    shape : mapping of str to ndarray
        The lobe's parameters by the names that the model's form has for them.

    Raises
    ------
    NpfmError
        If a channel of the table has no sample that counts.
    """
    diffuse, lobe = albedos
    values = {"rho_d": diffuse * CHANNEL_WEIGHT / np.pi, "rho_s": lobe * CHANNEL_WEIGHT, **shape}
    return model.published(table, objective, values)
