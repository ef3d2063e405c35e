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
from npfm.fitting.power_iterations.eigenproblem import distribution
from npfm.fitting.power_iterations.fresnel import fresnel
from npfm.fitting.power_iterations.mirrors import mirrors
from npfm.fitting.solvers.problem import Solver
from npfm.reflectance import slopes
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
        How it keeps D.
    """

    name: str
    form: Form

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
        that of the power iterations whatever the form (section 5.4 of Dupuy et al. 2015).

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
            small that its rho_s cannot be stored.
        """
        together = partial(_fit_together, form=self.form, kernel=kernel, way=fresnel)
        made = fit_coupled(self.name, table, objective, together, self.tabulate, ("rho_s",))
        return replace(made, records=tuple(with_end(record) for record in made.records))

    def tabulate(self, fit: Fit) -> Table:
        """Values of a fit at every cell of its grid, in 1/sr."""
        # Computed once for both halves of phi_d: exactly reciprocal.
        halves = _halves(self.form, fit)
        values = [np.concatenate([half, half[..., ::-1]], axis=-1) for half in halves]
        return as_table(values, fit.grid)

    def parameter_count(self, grid: HalfDifference) -> int:
        """Number of values stored for a material: rho_s and F of each channel, and D."""
        shape = self.form.convert(np.ones(grid.theta_h_bins), grid)
        factors = len(CHANNELS) * (1 + grid.theta_d_bins)
        return factors + sum(np.size(value) for value in shape.values())

    def rougher(self, fit: Fit, factor: float) -> Fit:
        """Return the fit with slopes that are so many times as steep, all else as it is."""
        changed = self.form.rougher(fit.parameters, fit.grid, factor)
        stored = {key: value.astype(channels.STORED) for key, value in changed.items()}
        return replace(fit, parameters=fit.parameters | stored, records=())


def _fit_together(samples: Sequence[Samples], form: Form, kernel: str, way: str) -> CoupledFit:
    began = time.process_time()
    grid = samples[0].grid
    D, status, iterations = distribution(samples, kernel)
    D = (D / D.max()).astype(channels.STORED).astype(float)
    ideal = mirrors(*TABULATED.surface({"D": D[None]}, grid), grid)
    factors = [fresnel(channel, ideal, way) for channel in samples]
    largest = np.array([F.max() for F in factors])
    scaled = [
        F / most if most > 0 else np.ones_like(F) for F, most in zip(factors, largest, strict=True)
    ]
    parameters = form.convert(D, grid) | {"F": np.stack(scaled), "rho_s": largest}
    seconds = time.process_time() - began
    trace = Trace("power iterations", status, iterations, 0, (seconds,), (1.0,))
    return CoupledFit(parameters, shared_traces([trace]))


def _halves(form: Form, fit: Fit) -> list[Array]:
    """Values of each channel for phi_d in its first half, in 1/sr."""
    p = {key: array.astype(float) for key, array in fit.parameters.items()}
    ideal = mirrors(*form.surface(p, fit.grid), fit.grid)
    return [rho_s * F[:, None] * ideal for rho_s, F in zip(p["rho_s"], p["F"], strict=True)]
