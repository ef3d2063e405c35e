"""Models of a diffuse part and one lobe of a few parameters: their values and records.

Every one is rho = rho_d + rho_s lobe(theta_h, theta_d, theta_i, theta_o).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from npfm.fitting.channels import as_table
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.fitting.published import with_record
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS, Table

Shape = Mapping[str, NDArray | float]


@dataclass(frozen=True)
class Directions:
    """Where a lobe is evaluated; arrays in radians, of shapes that broadcast.

    The cosines are positive.

    Parameters
    ----------
    theta_h, theta_d, cos_i, cos_o : ndarray
    vectors : tuple of three ndarray, shape (n, 3)
        Half vectors, light and view over a surface with normal z and tangent x, where n is the
        size of the others; empty where they are not known.
    """

    theta_h: NDArray
    theta_d: NDArray
    cos_i: NDArray
    cos_o: NDArray
    vectors: tuple[NDArray, ...] = field(default=(), kw_only=True)

    @cached_property
    def cos_h(self) -> NDArray:
        """Cosine of theta_h."""
        return np.cos(self.theta_h)

    @cached_property
    def cos_d(self) -> NDArray:
        """Cosine of theta_d."""
        return np.cos(self.theta_d)

    @cached_property
    def tan2_h(self) -> NDArray:
        """Square of the tangent of theta_h."""
        return np.tan(self.theta_h) ** 2

    @cached_property
    def thetas(self) -> tuple[NDArray, NDArray]:
        """Theta_i and theta_o."""
        return np.arccos(np.minimum(self.cos_i, 1)), np.arccos(np.minimum(self.cos_o, 1))

    @cached_property
    def grooves(self) -> NDArray:
        """Shadowing of V-shaped grooves over cos(theta_i) cos(theta_o), Cook and Torrance 1982."""
        least = np.minimum(self.cos_i, self.cos_o)
        shadowing = np.minimum(1, 2 * self.cos_h * least / self.cos_d)
        return shadowing / (self.cos_i * self.cos_o)


NORMAL = Directions(
    *(np.array([value]) for value in (0.0, 0.0, 1.0, 1.0)),
    vectors=(np.array([[0.0, 0.0, 1.0]]),) * 3,
)


def at_cells(grid: HalfDifference | Directional, cells: NDArray) -> Directions:
    """Directions of cells of a grid, which are given as flat indices."""
    cosines = (np.broadcast_to(cosine, grid.shape).flat[cells] for cosine in grid.cosines)
    if isinstance(grid, HalfDifference):
        h, d, _ = np.unravel_index(cells, grid.shape)
        return Directions(grid.theta_h[h], grid.theta_d[d], *cosines)
    a, b, c, d = np.unravel_index(cells, grid.shape)
    light, view = grid.light[a, b], grid.view[c, d]
    # The sum is the same, to the last bit, with light and view exchanged.
    half = light + view
    length = np.linalg.norm(half, axis=-1)
    half = half / length[:, None]
    angles = np.arccos(np.minimum(half[:, 2], 1)), np.arccos(np.minimum(length / 2, 1))
    return Directions(*angles, *cosines, vectors=(half, light, view))


@dataclass(frozen=True)
class Form:
    """A lobe and how it is searched for.

    Parameters
    ----------
    lobe : callable
        Values, not negative, of a shape at some directions.
    shape : callable
        The lobe's parameters by name, from the vector that is searched.
    bounds : tuple of two sequences of float
        Of that vector.
    starts : dict of str to sequence of float
        Such vectors, by name.
    shared : bool
        Whether the channels have one shape together.
    samples : int
        About so many are fitted to, taken evenly from all three angles.
    """

    lobe: Callable[[Shape, Directions], NDArray]
    shape: Callable[[NDArray], Shape]
    bounds: tuple[Sequence[float], Sequence[float]]
    starts: Mapping[str, Sequence[float]]
    shared: bool
    samples: int


def parameter_count(form: Form) -> int:
    """Number of values stored for a material: rho_d and rho_s of each channel, and the shapes."""
    shapes = 1 if form.shared else len(CHANNELS)
    return 2 * len(CHANNELS) + shapes * len(form.shape(np.array(form.bounds[0])))


def tabulate(form: Form, fit: Fit) -> Table:
    """Values of a fit at every cell of its grid, in 1/sr."""
    grid = fit.grid
    directional = isinstance(grid, Directional)
    if directional:
        directions = at_cells(grid, np.arange(grid.size))
    else:
        half = grid.phi_d_bins // 2
        cosines = (np.where(grid.above_horizon, c, 1.0)[..., :half] for c in grid.cosines)
        directions = Directions(grid.theta_h[:, None, None], grid.theta_d[:, None], *cosines)
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    rho_d, rho_s = p.pop("rho_d"), p.pop("rho_s")
    shapes = [dict(zip(p, values, strict=True)) for values in zip(*p.values(), strict=True)]
    lobes = [form.lobe(shape, directions) for shape in shapes]
    lobes = lobes * (len(CHANNELS) // len(lobes))
    values = [d + s * lobe for d, s, lobe in zip(rho_d, rho_s, lobes, strict=True)]
    if directional:
        return as_table([value.reshape(grid.shape) for value in values], grid)
    # Computed once for both halves of phi_d: exactly reciprocal.
    return as_table([np.concatenate([v, v[..., ::-1]], axis=-1) for v in values], grid)


@dataclass(frozen=True)
class Model:
    """What the file of a model of one lobe has, but for its `fit`.

    Parameters
    ----------
    name : str
        Of the model.
    form : Form
        Its lobe.
    """

    name: str
    form: Form

    def parameter_count(self, grid: HalfDifference) -> int:
        """Number of values stored for a material, on whatever grid."""
        return parameter_count(self.form)

    def tabulate(self, fit: Fit) -> Table:
        """Values of a fit at every cell of its grid, in 1/sr."""
        return tabulate(self.form, fit)

    def published(self, table: Table, objective: Objective, values: Mapping[str, ArrayLike]) -> Fit:
        """Return published parameters as a fit, with a record of the table that says so.

        Raises
        ------
        NpfmError
            If a channel of the table has no sample that counts.
        """
        arrays = {name: np.atleast_1d(value).astype(np.float32) for name, value in values.items()}
        fit = Fit(self.name, arrays, table.grid)
        return with_record(fit, self.tabulate(fit), table, objective)
