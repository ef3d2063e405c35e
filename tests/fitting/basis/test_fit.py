"""Fits in a basis: derivatives, materials of the basis itself, and free fits as the bound."""

from functools import partial

import numpy as np
import pytest
from lobed import GRID, many

from npfm.fitting.basis import library
from npfm.fitting.basis.fit import fit, fit_table, prepare, project
from npfm.fitting.basis.lobes import lobes_of
from npfm.fitting.basis.problem import BasisProblem
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.registry import model as module_of
from npfm.fitting.shared_lobes.isotropic import SharedLobesProblem
from npfm.fitting.solvers import gauss_newton
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.table import Table

both = pytest.mark.parametrize("model", ["independent-g", "shared-lobes"])

SOLVE = partial(gauss_newton.solve, settings=SolverSettings())


def prepared(model, seed=0):
    """A material, noisy, and the factors of all."""
    fits = many(model)
    table = module_of(model).tabulate(fits["m1"])
    noise = 1 + 0.02 * np.random.default_rng(seed).standard_normal(table.values.shape)
    return fits, Table(np.where(table.values < 0, -1, table.values * noise), GRID)


def samples_of(table):
    return [fold(channel_samples(table, k, Objective())) for k in range(3)]


@both
def test_derivatives_are_those_of_differences(model):
    fits, table = prepared(model)
    bases = library.gather(fits, Objective()).bases(3)
    step = 1 if model == "independent-g" else 3
    free = SharedLobesProblem(samples_of(table)[:step], 1 if step == 1 else 2)
    problem = BasisProblem(free, *(bases[name] for name in "DFG"))
    packed = 0.3 * np.random.default_rng(1).standard_normal(3 * sum(problem.counts))
    state = problem.unpack(packed)
    gradient, matrix = problem.normal_equations(state)
    # Coefficients are at their best, so that only the factors' own part is left.
    for k in range(packed.size):
        ends = [
            problem.objective(problem.unpack(packed + sign * 1e-5 * (np.arange(packed.size) == k)))
            for sign in (1, -1)
        ]
        assert gradient[k] == pytest.approx((ends[0] - ends[1]) / 4e-5, rel=1e-4, abs=1e-8)
    assert np.linalg.eigvalsh(matrix).min() > -1e-9


@both
def test_a_material_of_the_basis_is_met_as_well_as_by_its_own_factors(model):
    """Eight rows have seven directions: with seven curves the material itself is in the basis."""
    fits, table = prepared(model)
    found = library.gather(fits, Objective())
    bases, samples = found.bases(20), samples_of(table)
    groups = prepare(samples, found)
    fitted = fit(groups, found, bases, SOLVE)
    own = lobes_of(fits["m1"].parameters)
    laid = project(groups, own, found, bases, Objective())
    floor = np.mean([s.floor / s.energy for s in samples])
    assert fitted.objective <= laid.objective * (1 + 1e-3)
    assert laid.objective < floor + 0.01
    for lobes, reference in zip(laid.lobes, own, strict=True):
        assert np.log(lobes.D) == pytest.approx(np.log(reference.D), abs=0.02)


@both
def test_more_curves_and_free_factors_do_better(model):
    fits, table = prepared(model)
    others = library.gather(fits, Objective()).without("m1")
    groups = prepare(samples_of(table), others)
    reached = [fit(groups, others, others.bases(n), SOLVE).objective for n in (1, 2, 4)]
    assert reached[2] < 1.1 * min(reached)  # where the noise ends it, the end is not exact
    free = module_of(model).fit(table, Objective(), SOLVE, 1, **_settings(model))
    assert np.mean([r.objective for r in free.records]) <= reached[2] * (1 + 1e-3)


def _settings(model):
    return {"starts": 5} if model == "independent-g" else {"lobes": 2}


@both
def test_a_table_has_a_fit_like_any_other(model):
    fits, table = prepared(model)
    others = library.gather(fits, Objective()).without("m1")
    made = fit_table(table, others, 3, Objective(), SOLVE, module_of(model).tabulate)
    assert made.model == model and made.grid == GRID
    assert {k: a.shape for k, a in made.parameters.items()} == {
        k: a.shape for k, a in fits["m1"].parameters.items()
    }
    samples = samples_of(table)
    reached = fit(prepare(samples, others), others, others.bases(3), SOLVE).objective
    assert np.mean([r.objective for r in made.records]) == pytest.approx(reached, rel=1e-4)
    assert all(record.status == "converged" for record in made.records)


def test_permuted_channels_have_permuted_fits():
    fits, table = prepared("independent-g")
    others = library.gather(fits, Objective()).without("m1")
    first, second = (
        fit_table(t, others, 2, Objective(), SOLVE, module_of("independent-g").tabulate)
        for t in (table, Table(table.values[[2, 0, 1]], GRID))
    )
    for name, array in first.parameters.items():
        assert np.array_equal(array[[2, 0, 1]], second.parameters[name])


@both
def test_a_black_table_has_a_fit(model):
    fits, table = prepared(model)
    others = library.gather(fits, Objective()).without("m1")
    black = Table(np.where(table.values < 0, -1, 0.0), GRID)
    made = fit_table(black, others, 2, Objective(), SOLVE, module_of(model).tabulate)
    assert all(np.isfinite(array).all() for array in made.parameters.values())
    assert module_of(model).tabulate(made).values.max() == 0
