"""Shared lobes of anisotropic tables; small grids, for the sake of time."""

import numpy as np
import pytest

from npfm.datasets import synthetic_anisotropic
from npfm.errors import NpfmError
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples, evaluate
from npfm.fitting.registry import tabulated
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.models import shared_lobes
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.table import Table

GRID = Directional(4, 12, 4, 12)


def fit_with(table, solver="gauss-newton", **settings):
    solve = chosen(SolverSettings(solver, max_iterations=settings.pop("cap", 1000)))
    return shared_lobes.fit(table, Objective(), solve, 1, **settings)


def relative_objective(table, made, channel):
    samples = channel_samples(table, channel, Objective())
    return evaluate(samples, made.values[channel] / samples.scale) / (samples.energy or 1.0)


def best_constant(table, channel):
    samples = channel_samples(table, channel, Objective())
    mean = np.sum(samples.weight * samples.value) / np.sum(samples.weight)
    return evaluate(samples, np.full(table.grid.shape, mean)) / (samples.energy or 1.0)


def smooth(seed=2):
    """A fit of no material: three lobes that vary over all angles."""
    rng = np.random.default_rng(seed)
    theta, phi = np.meshgrid(GRID.theta_i, GRID.phi_i, indexing="ij")
    lobes = []
    for width, turn in ((0.2, 0.3), (0.4, 1.2), (0.9, 2.0)):
        stretched = theta**2 * (1 + np.cos(phi - turn) ** 2) / width**2
        lobes.append(np.exp(-stretched))
    G = [np.cos(theta) ** power * (1 + 0.2 * np.cos(2 * phi)) / 1.2 for power in (0.2, 0.5, 1.0)]
    for g in G:
        g[0] = g[0].mean()
    F = [0.3 + 0.7 * np.linspace(0, 1, 90) ** power for power in (1, 2, 4)]
    parameters = {
        "D": np.stack(lobes)[None],
        "G": np.stack([g / g.max() for g in G])[None],
        "F": np.stack(F),
        "rho_s": rng.uniform(0.2, 1, (3, 3)),
        "rho_d": np.array([0.1, 0.2, 0.05]),
    }
    single = {name: array.astype(np.float32) for name, array in parameters.items()}
    return Fit("shared-lobes", single, GRID)


@pytest.fixture(scope="module")
def table():
    return synthetic_anisotropic.load("shot-silk", 1, GRID)


@pytest.fixture(scope="module")
def fitted(table):
    return fit_with(table)


def slow_table(fit):
    """Equation 4 of Peng et al. 2017, pair by pair of directions."""
    p = {name: array.astype(float) for name, array in fit.parameters.items()}
    grid = fit.grid
    values = np.empty((3, *grid.shape))

    def bilinear(lobe, vector):
        theta = np.arccos(np.clip(vector[2], -1, 1)) / (np.pi / 2) * grid.theta_i_count
        phi = np.arctan2(vector[1], vector[0]) / (2 * np.pi) * grid.phi_i_count
        low, near = min(int(theta + 1e-9), grid.theta_i_count - 2), int(np.floor(phi))
        a, b = theta - low, phi - near
        one, two = near % grid.phi_i_count, (near + 1) % grid.phi_i_count
        return (1 - a) * ((1 - b) * lobe[low, one] + b * lobe[low, two]) + a * (
            (1 - b) * lobe[low + 1, one] + b * lobe[low + 1, two]
        )

    for i, j, k, m in np.ndindex(grid.shape):
        light, view = grid.light[i, j], grid.view[k, m]
        half = (light + view) / np.linalg.norm(light + view)
        theta_d = np.degrees(np.arccos(np.clip(light @ half, -1, 1)))
        for c in range(3):
            lobes = [
                s * bilinear(D, half) * G[i, j] * G[k, m]
                for s, D, G in zip(p["rho_s"][c], p["D"][0], p["G"][0], strict=True)
            ]
            F = np.interp(theta_d, np.arange(90), p["F"][c])
            values[c, i, j, k, m] = p["rho_d"][c] + F * sum(lobes) / (light[2] * view[2])
    return values


def test_the_paper_counts_2010_numbers():
    assert shared_lobes.parameter_count(UTIA) == 2010


def test_tables_are_those_of_the_formula():
    fit = smooth()
    made = shared_lobes.tabulate(fit).values
    np.testing.assert_allclose(made, slow_table(fit), rtol=1e-5)
    assert np.array_equal(made, made.transpose(0, 3, 4, 1, 2))


def test_parameters_are_what_they_should_be(tmp_path, table, fitted):
    shapes = {name: array.shape for name, array in fitted.parameters.items()}
    assert shapes == {
        "D": (1, 3, 4, 12),
        "G": (1, 3, 4, 12),
        "F": (3, 90),
        "rho_s": (3, 3),
        "rho_d": (3,),
    }
    assert fitted.parameter_count == shared_lobes.parameter_count(GRID)
    for name in "DG":
        lobes = fitted.parameters[name][0]
        assert (lobes.max((1, 2)) == 1).all()
        assert (lobes[:, 0] == lobes[:, 0, :1]).all()  # the normal is one direction
    assert (fitted.parameters["rho_s"] > 0).all()
    fits.save(tmp_path / "silk.npz", fitted)
    back = tabulated(tmp_path / "silk.npz")
    assert np.array_equal(back.values, shared_lobes.tabulate(fitted).values)


def test_three_lobes_beat_one_and_one_a_constant(table, fitted):
    one, made = fit_with(table, lobes=1), shared_lobes.tabulate(fitted)
    for channel, record in enumerate(fitted.records):
        assert record.status == "converged"
        found = relative_objective(table, made, channel)
        assert found == pytest.approx(record.objective, rel=1e-5)
        assert found < one.records[channel].objective < best_constant(table, channel)


@pytest.mark.parametrize("seed", [2, 3])
def test_a_fit_of_its_own_table_recovers_it(seed):
    table = shared_lobes.tabulate(smooth(seed))
    made = shared_lobes.tabulate(fit_with(table))
    for channel in range(3):
        assert relative_objective(table, made, channel) < 1e-6


def test_turned_azimuths_turn_the_fit_and_nothing_else(table, fitted):
    turned = Table(np.roll(table.values, (5, 5), (2, 4)), table.grid)
    other = fit_with(turned)
    for name, array in fitted.parameters.items():
        expected = np.roll(array, 5, axis=-1) if name in "DG" else array
        assert np.array_equal(other.parameters[name], expected), name
    for before, after in zip(fitted.records, other.records, strict=True):
        assert after.objective == pytest.approx(before.objective, rel=1e-9)


def test_permuted_channels_give_permuted_fits_to_the_last_bit(table, fitted):
    order = [2, 0, 1]
    permuted = fit_with(Table(table.values[order], table.grid))
    for name, array in fitted.parameters.items():
        expected = array if len(array) == 1 else array[order]
        assert np.array_equal(permuted.parameters[name], expected), name


def test_a_brighter_table_has_larger_coefficients_and_nothing_else(table, fitted):
    brighter = fit_with(Table(np.where(table.valid, 8 * table.values, -1.0), table.grid))
    for name, array in fitted.parameters.items():
        factor = 8 if name.startswith("rho") else 1
        assert np.array_equal(brighter.parameters[name], factor * array), name


def hard(kind):
    rng, (cos_i, cos_o) = np.random.default_rng(4), GRID.cosines
    along = GRID.light[:, :, None, None] + GRID.view
    along = along / np.maximum(np.linalg.norm(along, axis=-1, keepdims=True), 1e-9)
    values = np.full((3, *GRID.shape), 0.2)
    match kind:
        case "a mirror along one axis":
            values += 1e3 * np.exp(-((along[..., 0] / 0.02) ** 2))
        case "zeros":
            values[:] = 0
        case "one channel of zeros":
            values[1] = 0
        case "one direction":
            values[:] = -1
            values[:, 1, 2, 2, 5] = [0.5, 1.0, 2.0]
        case "negative halves":
            values += rng.normal(0, 0.2, values.shape)
        case "noise":
            values = rng.random(values.shape)
        case "dark at grazing":
            values = values * np.minimum(cos_i, cos_o) ** 3
        case "no light from a ring":
            values[:, 1], values[:, :, :, 1] = -1, -1
    return Table(values, GRID)


HARD = (
    "a mirror along one axis",
    "zeros",
    "one channel of zeros",
    "one direction",
    "negative halves",
    "noise",
    "dark at grazing",
    "no light from a ring",
)


@pytest.mark.parametrize("solver", ["gauss-newton", "awls"])
@pytest.mark.parametrize("kind", HARD)
def test_hard_tables_are_fitted_no_worse_than_by_a_constant(kind, solver):
    table = hard(kind)
    fit = fit_with(table, solver, cap=1000 if solver == "gauss-newton" else 5, starts=2)
    made = shared_lobes.tabulate(fit)
    assert all(np.isfinite(array).all() for array in fit.parameters.values())
    assert np.isfinite(made.values).all()
    for channel in range(3):
        found = relative_objective(table, made, channel)
        assert found <= best_constant(table, channel) + 1e-8
    if kind == "one direction":
        np.testing.assert_allclose(
            made.values[:, 1, 2, 2, 5], table.values[:, 1, 2, 2, 5], rtol=1e-4
        )


def test_NaN_is_refused_in_one_line(table):
    values = table.values.copy()
    values[1, 0, 0, 0, 0] = np.nan
    with pytest.raises(NpfmError, match="green channel has entries that are NaN"):
        fit_with(Table(values, table.grid))


@pytest.mark.parametrize(
    ("grid", "settings", "said"),
    [
        (Directional(2, 4, 3, 4), {}, "light and view in the same directions"),
        (Directional(12, 96, 12, 96), {}, "give a coarser one"),
        (GRID, {"spline": 1}, "reads G at its own nodes"),
    ],
)
def test_what_it_is_not_for_is_told(grid, settings, said):
    flat = np.broadcast_to(0.1, (3, *grid.shape))
    with pytest.raises(NpfmError, match=said):
        fit_with(Table(flat, grid), **settings)


def test_lobes_of_its_own_for_each_channel(table, fitted):
    own = fit_with(table, shared=0, starts=1)
    assert own.parameters["D"].shape == (3, 3, 4, 12)
    assert own.parameter_count == shared_lobes.parameter_count(GRID, shared=0)
    made = shared_lobes.tabulate(own)
    for channel, record in enumerate(own.records):
        found = relative_objective(table, made, channel)
        assert found == pytest.approx(record.objective, rel=1e-5)
