"""Power iterations and their conversions on tables of both directions."""

from functools import cache

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.evaluation.stability import violations
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples, fold
from npfm.fitting.power_iterations import backscattering
from npfm.fitting.power_iterations.circulant import TOO_NARROW
from npfm.models import beckmann, ggx, power_iteration
from npfm.reflectance import microsurfaces
from npfm.reflectance.anisotropic_slopes import Normals, area, facing, normalised, projected
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.microsurfaces import roughness, turned_scale
from npfm.reflectance.table import INVALID, Table
from npfm.reflectance.tabulated_slopes import at_normals, looked_up, neighbours

MODELS = {"power-iteration": power_iteration, "ggx": ggx, "beckmann": beckmann}
#: Small: 20 736 cells.
GRID = Directional(6, 24, 6, 24)
NAMES = "alpha_x", "alpha_y", "rho"
every_model = pytest.mark.parametrize("name", MODELS)
every_formula = pytest.mark.parametrize("name", ["ggx", "beckmann"])
#: alpha_x, alpha_y and degrees that are resolved by the elevations of the UTIA database.
SURFACES = [(0.05, 0.05, 0), (0.1, 0.4, 30), (0.2, 0.6, 10), (0.6, 0.3, 45), (0.6, 0.6, 0)]


def rise(head_on):
    """Schlick's Fresnel factor of 90 bins, equal where theta_d is no more than 7.5 degrees."""
    F = head_on + (1 - head_on) * (1 - np.cos(np.deg2rad(np.arange(90) + 0.5))) ** 5
    F[:8] = F[0]
    return F


def formula_fit(name, alpha_1, alpha_2, degrees, grid=UTIA):
    """A fit that nobody fitted: a formula, with Schlick's Fresnel factor."""
    found = roughness(turned_scale((alpha_1, alpha_2), np.deg2rad(degrees)))
    F = np.stack([rise(f) for f in (0.04, 0.5, 0.9)])
    parameters = {key: np.array([value]) for key, value in zip(NAMES, found, strict=True)}
    parameters |= {"F": F, "rho_s": np.ones(3)}
    return Fit(name, {k: v.astype(np.float32) for k, v in parameters.items()}, grid)


@cache
def formula_table(*arguments):
    return MODELS[arguments[0]].tabulate(formula_fit(*arguments))


def fitted(name, table, **settings):
    return MODELS[name].fit(table, Objective(), None, 1, **settings)


def noisy(grid, seed=1):
    """Brushed metal with a diffuse part, noise, negative values and gaps."""
    rng = np.random.default_rng(seed)
    values = formula_table("ggx", 0.15, 0.5, 20, grid).values + 0.05
    values = values * (1 + 0.05 * rng.standard_normal(values.shape))
    values += 0.01 * rng.standard_normal(values.shape)
    return Table(np.where(rng.random(values.shape) < 0.05, INVALID, values), grid)


def exchanged(values):
    return values.transpose(0, 3, 4, 1, 2)


@every_formula
@pytest.mark.parametrize("surface", SURFACES)
def test_a_fit_of_a_formula_finds_its_numbers(name, surface):
    """From the table that the database's format has."""
    made, known = fitted(name, formula_table(name, *surface)), formula_fit(name, *surface)
    alpha = [float(made.parameters[key][0]) for key in NAMES]
    expected = [float(known.parameters[key][0]) for key in NAMES]
    assert alpha[:2] == pytest.approx(expected[:2], rel=6e-3)
    assert alpha[2] == pytest.approx(expected[2], abs=0.01)
    assert {record.status for record in made.records} == {"converged"}
    F = made.parameters["rho_s"][:, None] * made.parameters["F"]
    assert F[:, 0] == pytest.approx([0.04, 0.5, 0.9], rel=0.05)


@every_model
def test_a_fit_of_its_own_table_is_exact(name):
    model = MODELS[name]
    first = (
        fitted(name, noisy(GRID)) if name == "power-iteration" else formula_fit(name, 0.2, 0.5, 30)
    )
    again = fitted(name, model.tabulate(first))
    # What is not met is F: it is that of a D whose steps are wider than the highlight.
    most = {"power-iteration": 1e-12, "ggx": 2e-3, "beckmann": 2e-2}[name]
    assert all(record.objective < most for record in again.records)


def test_power_iterations_find_their_own_distribution_to_rounding():
    first = fitted("power-iteration", noisy(GRID))
    again = fitted("power-iteration", power_iteration.tabulate(first))
    np.testing.assert_allclose(again.parameters["D"], first.parameters["D"], rtol=1e-4, atol=1e-7)


@every_model
def test_values_are_those_of_equations_1_to_3(name):
    """Cell by cell, with G1 by sums over facets, a thousand elevations of them."""
    fit = fitted(name, noisy(GRID))
    table, p = MODELS[name].tabulate(fit), {k: v.astype(float) for k, v in fit.parameters.items()}
    fine = Normals(1000, 24)
    if name == "power-iteration":
        D = p["D"][0] / area(at_normals(p["D"][0], Normals(90, 24)), Normals(90, 24))
        facets = at_normals(D, fine)
    else:
        scale = np.array([[p["alpha_x"][0] ** 2, 0], [0, p["alpha_y"][0] ** 2]])
        scale[0, 1] = scale[1, 0] = p["rho"][0] * p["alpha_x"][0] * p["alpha_y"][0]
        density = getattr(microsurfaces, f"anisotropic_{name}")
        facets = density(fine.directions, scale)

    rng = np.random.default_rng(7)
    for _ in range(20):
        a, c = rng.integers(0, 6, 2)
        b, d = rng.integers(0, 24, 2)
        i, o = GRID.light[a, b], GRID.view[c, d]
        h = (i + o) / np.linalg.norm(i + o)
        G1 = []
        for k in (i, o):
            facing_it = np.abs(fine.directions @ k) * facets * fine.solid_angle[:, None]
            G1.append(k[2] / ((facing_it.sum() + k[2]) / 2))
        G = G1[0] * G1[1] / (G1[0] + G1[1] - G1[0] * G1[1])
        at_h = (
            looked_up(D, *neighbours(h[None], D.shape))
            if name == "power-iteration"
            else density(h, scale)
        )
        bin_d = int(np.rad2deg(np.arccos(min(h @ i, 1))) + 1e-6)
        F = p["rho_s"] * p["F"][:, 0 if bin_d <= 7 else bin_d]
        expected = F * at_h * G / (4 * i[2] * o[2])
        np.testing.assert_allclose(table.values[:, a, b, c, d], expected, rtol=2e-2)


@every_model
def test_tables_are_reciprocal_valid_and_not_negative(name):
    values = MODELS[name].tabulate(fitted(name, noisy(GRID))).values
    assert np.array_equal(values, exchanged(values))
    assert np.isfinite(values).all()
    assert (values >= 0).all()


@every_model
def test_turning_a_table_by_whole_bins_turns_its_fit_and_nothing_else(name):
    table = noisy(GRID)
    turned = Table(np.roll(table.values, (5, 5), axis=(2, 4)), GRID)
    before, after = fitted(name, table), fitted(name, turned)
    made, remade = (MODELS[name].tabulate(fit).values for fit in (before, after))
    np.testing.assert_allclose(remade, np.roll(made, (5, 5), axis=(2, 4)), rtol=1e-4)
    for key in ("F", "rho_s"):
        np.testing.assert_allclose(after.parameters[key], before.parameters[key], rtol=1e-5)
    assert [r.status for r in after.records] == [r.status for r in before.records]


@every_model
def test_permuted_channels_give_permuted_fits(name):
    table, order = noisy(GRID), [2, 0, 1]
    before, after = fitted(name, table), fitted(name, Table(table.values[order], GRID))
    for key, array in before.parameters.items():
        shared = key in ("D", *NAMES)
        assert np.array_equal(after.parameters[key], array if shared else array[order]), key


@every_model
def test_numbers_that_are_stored(tmp_path, name):
    fit, count = fitted(name, noisy(GRID)), MODELS[name].parameter_count
    assert fit.parameter_count == count(GRID) == 273 + (11 * 24 if name == "power-iteration" else 3)
    assert count(UTIA) == 273 + (11 * 48 if name == "power-iteration" else 3)
    fits.save(tmp_path / "fit.npz", fit)
    back = fits.tabulate(tmp_path / "fit.npz", fits.load(tmp_path / "fit.npz"), MODELS[name])
    assert np.array_equal(back.values, MODELS[name].tabulate(fit).values)


def test_the_conversions_keep_the_fresnel_factor_of_the_power_iterations():
    """But for one number, the same in all channels."""
    table = noisy(GRID)
    free = fitted("power-iteration", table)
    for name in ("ggx", "beckmann"):
        made = fitted(name, table)
        assert np.array_equal(made.parameters["F"], free.parameters["F"])
        ratio = made.parameters["rho_s"] / free.parameters["rho_s"]
        np.testing.assert_allclose(ratio, ratio[0], rtol=1e-6)


def test_settings_reach_the_fit():
    table = noisy(GRID)
    made = {
        (kernel, way): fitted("power-iteration", table, kernel=kernel, fresnel=way)
        for kernel in power_iteration.SETTINGS["kernel"]
        for way in power_iteration.SETTINGS["fresnel"]
    }
    assert len({fit.parameters["D"].tobytes() for fit in made.values()}) == 2
    assert len({fit.parameters["F"].tobytes() for fit in made.values()}) == len(made)
    for kernel in power_iteration.SETTINGS["kernel"]:
        objective = {
            way: made[kernel, way].records[0].objective for (k, way) in made if k == kernel
        }
        assert min(objective, key=objective.get) == "least-squares"


def hard_tables(grid):
    """Values of a channel, and what the status of the fit has to begin with."""
    rng = np.random.default_rng(3)
    exact = formula_table("ggx", 0.2, 0.5, 20, grid).values[1]
    mirror = np.where(formula_table("ggx", 0.001, 0.5, 0, grid).values[1] > 1e-2, 1.0, 0.0)
    one = np.full(grid.shape, INVALID)
    one[2, 3, 1, 4] = 0.5
    half = exact.copy()
    half[:, :12] *= -1
    no_backscatter = exact.copy()
    for a in range(6):
        no_backscatter[a, np.arange(24), a, np.arange(24)] = INVALID
    across = np.full(grid.shape, INVALID)
    for j in range(24):
        across[:, j, :, (j + 12) % 24] = exact[:, j, :, (j + 12) % 24]
    bright = exact.copy()
    bright[0, 0, 0, 0] = 1e30
    return {
        "a mirror along one axis": mirror,
        "black": np.zeros(grid.shape),
        "white": np.full(grid.shape, 1 / np.pi),
        "one sample": one,
        "half of it negative": half,
        "nothing backscattered": no_backscatter,
        "only the plane of reflection": across,
        "one value that is wrong": bright,
        "noise": rng.random(grid.shape),
        "dark": exact * 1e-30,
    }


@every_model
@pytest.mark.parametrize("case", hard_tables(GRID))
def test_hard_tables(name, case):
    table = Table(np.stack([hard_tables(GRID)[case]] * 3), GRID)
    made = fitted(name, table)
    assert violations(table, made, MODELS[name]) == []
    if case == "a mirror along one axis":
        assert made.records[0].status == TOO_NARROW
    if case in ("black", "one sample", "white", "only the plane of reflection"):
        assert made.records[0].status.startswith("degenerate: ")
    if case in ("nothing backscattered", "dark", "noise", "half of it negative"):
        assert made.records[0].status == "converged"


def test_what_was_not_backscattered_is_read_off_what_is_nearest():
    """Every other elevation of D is then of light and view two steps apart."""
    table = formula_table("ggx", 0.3, 0.5, 0, GRID)
    values, azimuth = table.values.copy(), np.arange(24)
    for a in range(6):
        values[:, a, azimuth, a, azimuth] = INVALID
    gaps, whole = fitted("ggx", Table(values, GRID)), fitted("ggx", table)
    for key in NAMES[:2]:
        np.testing.assert_allclose(gaps.parameters[key], whole.parameters[key], rtol=0.06)


@every_model
def test_a_nan_is_refused(name):
    values = noisy(GRID).values.copy()
    values[1, 2, 3, 4, 5] = np.nan
    with pytest.raises(NpfmError, match="the green channel has entries that are NaN"):
        fitted(name, Table(values, GRID))


def test_light_and_view_in_different_directions_are_refused():
    grid = Directional(6, 24, 3, 24)
    with pytest.raises(NpfmError, match="light and view in different directions"):
        fitted("ggx", Table(np.ones((3, *grid.shape)), grid))


@pytest.mark.parametrize("counts", [(1, 1), (1, 8), (2, 3), (3, 4)])
@every_model
def test_coarse_tables(name, counts):
    grid = Directional(*counts, *counts)
    table = Table(0.1 + np.random.default_rng(1).random((3, *grid.shape)), grid)
    made = fitted(name, table)
    assert violations(table, made, MODELS[name]) == []


@pytest.mark.parametrize(
    ("name", "key", "value"),
    [
        ("ggx", "alpha_x", [0.0]),
        ("beckmann", "alpha_y", [-0.1]),
        ("ggx", "rho", [1.0]),
        ("power-iteration", "D", np.ones((1, 3, 3))),
        ("power-iteration", "D", np.zeros((1, 11, 24))),
        ("power-iteration", "D", np.full((1, 11, 24), -1)),
    ],
)
def test_parameters_of_no_surface_are_refused(tmp_path, name, key, value):
    fit = fitted(name, noisy(GRID))
    broken = Fit(name, fit.parameters | {key: np.array(value, dtype=np.float32)}, GRID)
    fits.save(tmp_path / "fit.npz", broken)
    with pytest.raises(NpfmError, match=r"fit\.npz: its arrays"):
        fits.tabulate(tmp_path / "fit.npz", fits.load(tmp_path / "fit.npz"), MODELS[name])


@every_model
@pytest.mark.parametrize("factors", [(1, 1), (2, 2), (1.5, 0.8)])
def test_edited_slopes(name, factors):
    first = fitted(name, formula_table("ggx", 0.2, 0.4, 30, GRID))
    edited = MODELS[name].rougher(first, factors)
    if name == "power-iteration":
        np.testing.assert_allclose(edited.parameters["D"].max(), 1)
        if factors == (1, 1):
            np.testing.assert_allclose(edited.parameters["D"], first.parameters["D"], rtol=1e-5)
    else:
        for key, factor in zip(NAMES[:2], factors, strict=True):
            np.testing.assert_allclose(edited.parameters[key], factor * first.parameters[key])
        assert edited.parameters["rho"] == first.parameters["rho"]
    for key in ("F", "rho_s"):
        assert np.array_equal(edited.parameters[key], first.parameters[key])
    assert np.isfinite(MODELS[name].tabulate(edited).values).all()


def test_folding_leaves_the_objective_as_it_is():
    """Sample by sample, nothing folded, for a table that is reciprocal."""
    measured, made = noisy(GRID), formula_table("ggx", 0.2, 0.5, 10, GRID)
    for channel in range(3):
        samples = channel_samples(measured, channel, Objective())
        folded = fold(samples)
        whole = np.sum(samples.weight * (made.values[channel] / samples.scale - samples.value) ** 2)
        error = folded.weight * (made.values[channel] / samples.scale - folded.value) ** 2
        assert folded.floor + error.sum() == pytest.approx(whole, rel=1e-12)
        assert folded.floor > 0


def test_a_distribution_is_that_of_a_dense_matrix():
    """The equations of a table, one by one, in a loop."""
    table = noisy(Directional(3, 6, 3, 6))
    samples = fold(channel_samples(table, 0, Objective()))
    D, status, _ = backscattering.distribution([samples] * 3, "consistent")
    at = backscattering.normals(table.grid)
    facets = normalised(at_normals(D, at), at)
    S = projected(facing(at, tuple(table.grid.theta_o.tolist())), facets)
    assert status == "converged"
    cosine, ratios = np.cos(table.grid.theta_i), []
    for low in range(3):
        for high in (low, low + 1):
            for j in range(6):
                if high == 3 or low == high == 0 or not samples.weight[low, j, high, j] > 0:
                    continue
                A = (cosine[low] * S[high, j] + cosine[high] * S[low, j]) / 2
                ratios.append(4 * samples.value[low, j, high, j] * A / D[low + high, j])
    assert np.ptp(ratios) < 1e-6 * np.mean(ratios)
    assert len(ratios) >= 20
