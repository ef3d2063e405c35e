"""The compressed B: its equations, what rank buys, and why weights are needed."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from npfm.datasets import neural
from npfm.errors import NpfmError
from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import bivariate_g, low_rank_b
from npfm.models.low_rank_b import Compressor, Equations
from npfm.reflectance.table import Table

solve = chosen(SolverSettings())


def samples_of(table, channel=0):
    return fold(channel_samples(table, channel, Objective()))


@pytest.fixture(scope="module")
def compressor(table):
    problem, free, _ = bivariate_g.fit_samples(samples_of(table, 1), solve)
    return Compressor(problem, free)


def best(compressor, rank):
    runs = [compressor.minimise(name, V, 0.0) for name, V in compressor.starts(rank, 1).items()]
    return min(runs, key=lambda run: run[1].objective[-1])


def relative(problem, state):
    return problem.objective(state) / problem.energy


@pytest.mark.parametrize("diffuse", [0.5, -1.0])
def test_factor_and_rho_d_are_those_of_least_squares(compressor, diffuse):
    """One design matrix for all rows of U and rho_d, without the sums; rho_d free and at 0."""
    rng = np.random.default_rng(2)
    n, m, phi, rank = 5, 6, 4, 2
    w, K, V = rng.random((n, m, phi)), rng.uniform(0.5, 3, (n, m, phi)), rng.normal(size=(m, rank))
    V[:, 0] = 1
    r = diffuse + K * rng.normal(1, 0.5, (n, 1, 1)) + rng.normal(0, 0.1, w.shape)
    sums = ((w * x).sum(-1) for x in (K * K, r * K, K))
    equations = low_rank_b.Equations(*sums, w.sum(), (w * r).sum())
    slopes = np.einsum("hdp,dr->hdpr", K, V)
    design = np.zeros((n, m, phi, n, rank))
    design[np.arange(n), :, :, np.arange(n)] = slopes
    design = np.column_stack([design.reshape(w.size, -1), np.ones(w.size)])
    least = np.append(np.full(n * rank, -np.inf), 0.0)
    root = np.sqrt(w.ravel())
    expected = lsq_linear(design * root[:, None], r.ravel() * root, (least, np.inf), tol=1e-14).x
    assert (expected[-1] > 1e-3) == (diffuse > 0)
    np.testing.assert_allclose(equations.solved(V).ravel(), expected[:-1], rtol=1e-5)


def test_full_rank_gives_bivariate_g(compressor):
    state = best(compressor, 18)[0].state
    expected = compressor.problem.objective(compressor.free)
    assert compressor.problem.objective(state) == pytest.approx(expected, rel=1e-6)


def test_each_product_lowers_the_objective(compressor):
    found = [best(compressor, rank)[1].objective[-1] for rank in (1, 2, 3, 4, 6)]
    assert all(later < 0.999 * earlier for earlier, later in pairwise(found))
    assert found[-1] > relative(compressor.problem, compressor.free)


def test_a_B_of_low_rank_is_found(compressor):
    """Whatever weights the cells have, and though most of it could be noise."""
    rng = np.random.default_rng(7)
    U, V = rng.random((18, 2)) * compressor.free.B.max(1)[:, None], rng.random((18, 2))
    B, sums, problem = U @ V.T, compressor.free.sums, compressor.problem
    wrk = sums.wkk * B + 0.3 * sums.wk
    wr = sums.wk * B + 0.3 * sums.w
    wrr = np.vdot(B, wrk) + 0.3 * wr.sum()
    exact = replace(compressor.free, sums=replace(sums, wrk=wrk, wr=wr, wrr=wrr), B=B, rho_d=0.3)
    state = best(Compressor(problem, exact), 2)[0].state
    np.testing.assert_allclose(state.B[sums.wkk > 0], B[sums.wkk > 0], rtol=1e-3)
    assert state.rho_d == pytest.approx(0.3, rel=1e-3)


def test_a_fit_says_what_it_is(table):
    fit = low_rank_b.fit(table, Objective(), solve, 1, rank=2)
    assert fit.parameters["U"].shape == fit.parameters["V"].shape == (3, 18, 2)
    assert fit.parameter_count == low_rank_b.parameter_count(table.grid, 2) == 3 * (72 + 90 + 1)
    assert np.abs(fit.parameters["V"]).max(axis=(1, 2)) == pytest.approx(1)
    made = low_rank_b.tabulate(fit)
    assert made.values[:, table.grid.above_horizon].min() >= 0
    for channel, record in enumerate(fit.records):
        samples = channel_samples(table, channel, Objective())
        found = evaluate(samples, made.values[channel] / samples.scale) / samples.energy
        assert record.objective == pytest.approx(found, rel=1e-5)


@pytest.mark.parametrize("rank", [0, 19])
def test_an_impossible_rank_is_refused(table, rank):
    with pytest.raises(NpfmError, match=f"rank {rank}: give a rank from 1 to 18"):
        low_rank_b.fit(table, Objective(), solve, 1, rank=rank)


def test_noise_is_fitted_no_worse_than_by_a_constant(table):
    noise = np.random.default_rng(5).random(table.grid.shape)
    made = Table(np.where(table.valid, noise, -1.0), table.grid)
    fit = low_rank_b.fit(made, Objective(), solve, 1, rank=1)
    for channel, record in enumerate(fit.records):
        samples = channel_samples(made, channel, Objective())
        mean = np.sum(samples.weight * samples.value) / np.sum(samples.weight)
        constant = evaluate(samples, np.full(noise.shape, mean)) / samples.energy
        assert record.objective <= constant * (1 + 1e-9)


def truncated(free, rank):
    """B by the largest singular values, none of its cells weighted: what the paper tried."""
    U, s, Vt = np.linalg.svd(free.B, full_matrices=False)
    return replace(free, B=np.maximum((U[:, :rank] * s[:rank]) @ Vt[:rank], 0.0))


@pytest.mark.parametrize(("name", "gain"), [("alum-bronze", 2.5), ("nylon", 1.2)])
def test_weights_are_needed(data, name, gain):
    material = neural.load(data / "merl_nbrdf.zip", name)
    problem, free, _ = bivariate_g.fit_samples(samples_of(material), solve)
    compressor = Compressor(problem, free)
    found = best(compressor, 4)[1].objective[-1]
    assert gain * found < relative(problem, truncated(free, 4))
    assert relative(problem, free) < found < 1.3 * relative(problem, free)


def test_a_row_without_weight_leaves_the_equations_solvable():
    """Its system is singular: it takes the shortest solution, the other rows keep theirs."""
    rng = np.random.default_rng(1)
    wkk, wrk, wk = rng.uniform(1, 2, (3, 5, 6))
    V = np.linalg.qr(rng.standard_normal((6, 2)))[0]
    for array in (wkk, wrk, wk):
        array[3] = 0
    found = Equations(wkk, wrk, wk, 100.0, 1.0).solved(V)
    rows = [0, 1, 2, 4]
    assert (found[3] == 0).all()
    assert np.isfinite(found).all()
    alone = Equations(wkk[rows], wrk[rows], wk[rows], 100.0, 1.0).solved(V)
    np.testing.assert_allclose(found[rows], alone, rtol=1e-10)
