"""Fits of models that keep a distribution of microfacets and a Fresnel factor, and no more.

rho = rho_s F(theta_d) D(theta_h) / (4 A), with A as in `mirrors`: D is shared by the channels; F
and rho_s, which takes the scale of F, are of each. Nothing is searched for (Dupuy et al. 2015).
What such models differ in is their `Form`.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from npfm.fitting import channels
from npfm.fitting.channels import CoupledFit, as_table, fit_coupled, shared_traces, with_end
from npfm.fitting.fits import Fit, Trace
from npfm.fitting.objective import Objective, Samples
from npfm.fitting.power_iterations import backscattering, directional
from npfm.fitting.power_iterations.eigenproblem import distribution
from npfm.fitting.power_iterations.fresnel import fresnel
from npfm.fitting.power_iterations.mirrors import mirrors
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance import slopes
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.slopes import ELEVATIONS, normalised, projected_area
from npfm.reflectance.table import CHANNELS, Table

Array = NDArray[np.float64]
Parameters = dict[str, NDArray]


@dataclass(frozen=True)
class Form:
    """How a model keeps a distribution of microfacets.

    Parameters
    ----------
    convert : callable
        The model's own parameters, first axis of length 1, of a D at the bin centres of a grid.
    surface : callable
        The normalised D at the bin centres, and its projected areas at `ELEVATIONS`, of those.
    rougher : callable
        Those of slopes that are so many times as steep.
    """

    convert: Callable[[Array, HalfDifference], Parameters]
    surface: Callable[[Parameters, HalfDifference], tuple[Array, Array]]
    rougher: Callable[[Parameters, HalfDifference, float], Parameters]


def _tabulated_surface(p: Parameters, grid: HalfDifference) -> tuple[Array, Array]:
    D = normalised(p["D"][0], grid)
    return D, projected_area(D, grid)


def _tabulated_rougher(p: Parameters, grid: HalfDifference, factor: float) -> Parameters:
    D = slopes.rougher(p["D"][0], grid, factor)
    return {"D": (D / D.max())[None]}


#: A distribution that is kept as it is.
TABULATED = Form(lambda D, grid: {"D": D[None]}, _tabulated_surface, _tabulated_rougher)


def formula(
    roughness: Callable[[Array, HalfDifference], float],
    density: Callable[[Array, float], Array],
    area: Callable[[Array, float], Array],
) -> Form:
    """Form of a distribution that is kept as the roughness alpha of a formula.

    Parameters
    ----------
    roughness : callable
        alpha of a D at the bin centres of a grid.
    density, area : callable
        D and its projected area, of cosines and alpha (`npfm.reflectance.microsurfaces`).
    """

    def surface(p: Parameters, grid: HalfDifference) -> tuple[Array, Array]:
        alpha = float(p["alpha"][0])
        return density(np.cos(grid.theta_h), alpha), area(np.cos(ELEVATIONS), alpha)

    return Form(
        lambda D, grid: {"alpha": np.array([roughness(D, grid)])},
        surface,
        lambda p, grid, factor: {"alpha": p["alpha"] * p["alpha"].dtype.type(factor)},
    )


@dataclass(frozen=True)
class Microfacets:
    """A model that fits so, and what its file has to have.

    Parameters
    ----------
    name : str
        Of the model.
    form : Form
        How it keeps D of an isotropic table.
    directional : directional.Form
        How it keeps D of a table of both directions.
    """

    name: str
    form: Form
    directional: directional.Form

    def fit(
        self,
        table: Table,
        objective: Objective,
        solve: Solver,
        seed: int,
        *,
        kernel: str = "consistent",
        fresnel: str = "least-squares",
    ) -> Fit:
        """Fit the model to a table; the same steps for every table, and none that can fail.

        D comes first, F from the mirrors of the stored D; only then is D converted, so that F is
        that of the power iterations whatever the form (section 5.4 of Dupuy et al. 2015). On tables
        of both directions that is so but for its scale (`directional.Form.covered`).

        Parameters
        ----------
        table : Table
            Measured BRDF in 1/sr.
        objective : Objective
            Which samples count, how much in the least squares of F, and what the record tells.
        solve, seed
            Not needed.
        kernel : str
            A key of `eigenproblem.KERNELS`.
        fresnel : str
            A key of `fresnel.WAYS`.

        Raises
        ------
        NpfmError
            If a channel has no sample that counts, a NaN or an infinity, or values so large or so
            small that its rho_s cannot be stored; if light and view have different directions.
        """
        together = partial(self._fit_together, kernel=kernel, way=fresnel)
        made = fit_coupled(self.name, table, objective, together, self.tabulate, ("rho_s",))
        return replace(made, records=tuple(with_end(record) for record in made.records))

    def _fit_together(self, samples: Sequence[Samples], kernel: str, way: str) -> CoupledFit:
        began = time.process_time()
        grid = samples[0].grid
        if isinstance(grid, Directional):
            D, status, iterations = backscattering.distribution(samples, kernel)
            D = _stored(D)
            ideal = directional.mirrors(*directional.TABULATED.surface({"D": D[None]}, grid), grid)
            share = self.directional.covered(D, grid)
            factors = [share * directional.fresnel(channel, ideal, way) for channel in samples]
            shape = self.directional.convert(D, grid)
        else:
            D, status, iterations = distribution(samples, kernel)
            D = _stored(D)
            ideal = mirrors(*TABULATED.surface({"D": D[None]}, grid), grid)
            factors = [fresnel(channel, ideal, way) for channel in samples]
            shape = self.form.convert(D, grid)
        parameters = shape | _scaled(factors)
        seconds = time.process_time() - began
        trace = Trace("power iterations", status, iterations, 0, (seconds,), (1.0,))
        return CoupledFit(parameters, shared_traces([trace]))

    def tabulate(self, fit: Fit) -> Table:
        """Values of a fit at every cell of its grid, in 1/sr."""
        p = {key: array.astype(float) for key, array in fit.parameters.items()}
        grid = fit.grid
        if isinstance(grid, Directional):
            ideal = directional.mirrors(*self.directional.surface(p, grid), grid)
            values = [F * ideal for F in directional.at_cells(p["rho_s"], p["F"], grid)]
        else:
            ideal = mirrors(*self.form.surface(p, grid), grid)
            halves = [s * F[:, None] * ideal for s, F in zip(p["rho_s"], p["F"], strict=True)]
            # Computed once for both halves of phi_d: exactly reciprocal.
            values = [np.concatenate([half, half[..., ::-1]], axis=-1) for half in halves]
        return as_table(values, grid)

    def parameter_count(self, grid: HalfDifference | Directional) -> int:
        """Number of values stored for a material: rho_s and F of each channel, and D."""
        if isinstance(grid, Directional):
            shape = self.directional.convert(np.ones(backscattering.shape(grid)), grid)
            bins = directional.THETA_D_BINS
        else:
            shape = self.form.convert(np.ones(grid.theta_h_bins), grid)
            bins = grid.theta_d_bins
        return len(CHANNELS) * (1 + bins) + sum(np.size(value) for value in shape.values())

    def rougher(self, fit: Fit, factors: tuple[float, float]) -> Fit:
        """Return the fit with slopes that are so many times as steep, all else as it is.

        Along x and along y; on a half-difference grid, the same.
        """
        if isinstance(fit.grid, Directional):
            changed = self.directional.rougher(fit.parameters, factors)
        else:
            changed = self.form.rougher(fit.parameters, fit.grid, factors[0])
        stored = {key: value.astype(channels.STORED) for key, value in changed.items()}
        return replace(fit, parameters=fit.parameters | stored, records=())


def _stored(D: Array) -> Array:
    """D as it is stored, of maximum 1."""
    return (D / D.max()).astype(channels.STORED).astype(float)


def _scaled(factors: Sequence[Array]) -> Parameters:
    """F of maximum 1, and rho_s, which takes its scale."""
    largest = np.array([F.max() for F in factors])
    scaled = [
        F / most if most > 0 else np.ones_like(F) for F, most in zip(factors, largest, strict=True)
    ]
    return {"F": np.stack(scaled), "rho_s": largest}
