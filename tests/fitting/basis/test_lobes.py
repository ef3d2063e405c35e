"""What samples see of factors, against what changing them does to the objective."""

import numpy as np
import pytest
from lobed import GRID, fit_of, lobes

from npfm.fitting.basis import lobes as module
from npfm.fitting.basis.lobes import cells, lobes_of, parameters_of, seen_by
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.registry import model as module_of
from npfm.reflectance.table import Table

both = pytest.mark.parametrize("model", ["independent-g", "shared-lobes"])


@both
def test_parameters_come_back(model):
    fit = fit_of(model, 0.3, 1.0, 0.5)
    back = parameters_of(lobes_of(fit.parameters), model == "independent-g")
    assert back.keys() == fit.parameters.keys()
    for name, array in back.items():
        assert np.array_equal(array.astype(np.float32), fit.parameters[name])


def test_lobes_that_channels_do_not_share_come_back():
    parameters = parameters_of([lobes(0.3, 1.0, 0.5, count=2)] * 3, False)
    assert parameters["D"].shape == (3, 2, 18) and parameters["rho_s"].shape == (3, 2)
    assert len(lobes_of(parameters)) == 3
    again = parameters_of(lobes_of(parameters), False)
    assert all(np.array_equal(array, again[name]) for name, array in parameters.items())


@pytest.mark.parametrize("compressive", [True, False])
def test_what_is_seen_is_the_price_of_an_error(monkeypatch, compressive):
    """Where a fit is met exactly, an error of a logarithm costs its square times what is seen."""
    monkeypatch.setattr(module, "SEEN_BINS", 18)
    objective = Objective(compressive=compressive)
    fit = fit_of("independent-g", 0.3, 1.0, 0.5)
    seen = seen_by(lobes_of(fit.parameters)[0], cells(GRID, objective))
    tabulate = module_of("independent-g").tabulate
    exact = tabulate(fit)
    samples = channel_samples(Table(exact.values, GRID), 0, objective)

    def cost(name, k, step=1e-2):
        total = 0.0
        for sign in (1, -1):
            changed = {n: a.copy() for n, a in fit.parameters.items()}
            changed[name][0, k] *= np.exp(sign * step)
            table = tabulate(type(fit)("independent-g", changed, GRID))
            total += evaluate(samples, np.maximum(table.values[0], 0) / samples.scale)
        return total / (2 * step**2 * samples.energy)

    for name in ("D", "F"):
        for k in (0, 4, 9, 15):
            assert getattr(seen, name)[0, k] == pytest.approx(cost(name, k), rel=1e-2, abs=1e-12)
    # Between nodes a derivative is shared out, and its square is not.
    for k in (10, 40, 70):
        assert 0.8 < seen.G[0, k] / cost("G", k) < 2.5


def test_a_black_channel_sees_nothing():
    black = lobes(0.3, 1.0, 0.5)
    black.rho_s[:], black.rho_d[:] = 0, 0
    seen = seen_by(black, cells(GRID, Objective()))
    assert not seen.D.any() and not seen.F.any() and not seen.G.any()


@pytest.mark.parametrize("lit", [18, 2])
def test_values_are_weighed_as_samples_of_a_table_are_however_dark_most_of_it_is(lit):
    plane = np.zeros((18, 18))
    plane[:, :lit] = np.random.default_rng(4).uniform(1, 2, (18, lit))
    whole = np.where(GRID.above_horizon, plane[..., None], -1.0)
    samples = channel_samples(Table(np.stack([whole] * 3), GRID), 0, Objective())
    at = cells(GRID, Objective())
    every = 18 // at.weight.shape[1]
    theirs = samples.weight[..., every // 2 : 18 : every].reshape(at.weight.shape)
    found = at.weights(np.broadcast_to(plane.reshape(-1, 1), at.weight.shape))
    np.testing.assert_allclose(found / found.sum(), theirs / theirs.sum(), rtol=1e-6)


def test_cells_are_weighed_as_the_objective_says():
    plain, angles = (cells(GRID, Objective(cells=name)) for name in ("volume-form", "solid-angle"))
    assert plain.weight.shape == angles.weight.shape
    assert not np.allclose(plain.weight / plain.weight.sum(), angles.weight / angles.weight.sum())
    narrow = cells(GRID, Objective(max_angle=60))
    assert (narrow.weight > 0).sum() < (plain.weight > 0).sum()
