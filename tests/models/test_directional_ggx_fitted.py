"""GGX with a diffuse part on tables of both directions."""

from dataclasses import replace

import numpy as np
import pytest

from npfm.datasets import synthetic_anisotropic
from npfm.evaluation.stability import violations
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.models import ggx, ggx_fitted
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.microsurfaces import roughness, turned_scale
from npfm.reflectance.table import INVALID, Table

GRID = Directional(6, 24, 6, 24)
NAMES = "alpha_x", "alpha_y", "rho"


def known(alpha, degrees, grid=GRID, f0=0.2):
    """A fit that nobody fitted."""
    found = roughness(turned_scale(alpha, np.deg2rad(degrees)))
    p = dict(zip(NAMES, found, strict=True)) | {"f0": f0}
    parameters = {key: np.array([value]) for key, value in p.items()}
    parameters |= {"rho_d": np.array([0.1, 0.02, 0.3]), "rho_s": np.array([0.5, 1.0, 0.2])}
    single = {key: value.astype(np.float32) for key, value in parameters.items()}
    return Fit("ggx-fitted", single, grid)


def fitted(table):
    return ggx_fitted.fit(table, Objective(), None, 1)


@pytest.mark.parametrize(
    ("alpha", "degrees"), [((0.08, 0.5), 0), ((0.1, 0.4), 70), ((0.3, 0.3), 0), ((0.2, 0.6), 135)]
)
def test_its_own_numbers_are_found_again(alpha, degrees):
    first = known(alpha, degrees)
    again = fitted(ggx_fitted.tabulate(first))
    for key, array in first.parameters.items():
        np.testing.assert_allclose(again.parameters[key], array, rtol=2e-3, atol=2e-3, err_msg=key)
    assert all(record.objective < ggx_fitted.OWN_TABLE for record in again.records)
    assert {record.status for record in again.records} == {"converged"}


def test_its_lobe_is_that_of_ggx():
    first = known((0.2, 0.5), 30, f0=1.0)
    bare = replace(first, parameters=first.parameters | {"rho_d": np.zeros(3, np.float32)})
    shape = {key: first.parameters[key] for key in NAMES}
    other = Fit("ggx", shape | {"F": np.ones((3, 90)), "rho_s": first.parameters["rho_s"]}, GRID)
    values, expected = ggx_fitted.tabulate(bare).values, ggx.tabulate(other).values
    np.testing.assert_allclose(values, expected, rtol=1e-6)


def test_brushed_steel_is_found_through_noise_and_gaps():
    """It is narrower than the steps of its table."""
    made = fitted(synthetic_anisotropic.load("brushed-steel", 1))
    found = [float(made.parameters[key][0]) for key in NAMES]
    assert found[:2] == pytest.approx([0.05, 0.5], rel=0.02)
    assert found[2] == pytest.approx(0, abs=0.01)


def test_tables_are_reciprocal_and_turn_with_their_fits():
    table = ggx_fitted.tabulate(known((0.1, 0.4), 20))
    assert np.array_equal(table.values, table.values.transpose(0, 3, 4, 1, 2))
    rng = np.random.default_rng(1)
    noisy = Table(table.values * (1 + 0.1 * rng.standard_normal(table.values.shape)), GRID)
    turned = Table(np.roll(noisy.values, (6, 6), axis=(2, 4)), GRID)
    made, remade = (ggx_fitted.tabulate(fitted(t)).values for t in (noisy, turned))
    np.testing.assert_allclose(remade, np.roll(made, (6, 6), axis=(2, 4)), rtol=0.02)


def test_ten_numbers(tmp_path):
    assert ggx_fitted.parameter_count(UTIA) == 10
    fit = known((0.1, 0.4), 20)
    assert fit.parameter_count == 10
    fits.save(tmp_path / "fit.npz", fit)
    back = fits.tabulate(tmp_path / "fit.npz", fits.load(tmp_path / "fit.npz"), ggx_fitted)
    assert np.array_equal(back.values, ggx_fitted.tabulate(fit).values)


@pytest.mark.parametrize("factors", [(2, 2), (1, 0.5)])
def test_edited_slopes(factors):
    first = known((0.1, 0.4), 20)
    edited = ggx_fitted.rougher(first, factors)
    for key, factor in zip(NAMES[:2], factors, strict=True):
        np.testing.assert_allclose(edited.parameters[key], factor * first.parameters[key])
    unchanged = first.parameters.keys() - set(NAMES[:2])
    assert all(np.array_equal(edited.parameters[k], first.parameters[k]) for k in unchanged)


def hard_tables():
    rng = np.random.default_rng(3)
    exact = ggx_fitted.tabulate(known((0.2, 0.5), 20)).values[1]
    one = np.full(GRID.shape, INVALID)
    one[2, 3, 1, 4] = 0.5
    half = exact.copy()
    half[:, :12] *= -1
    return {
        "a mirror along one axis": np.where(exact > 0.8 * exact.max(), 1e3, 0.0),
        "black": np.zeros(GRID.shape),
        "white": np.full(GRID.shape, 1 / np.pi),
        "one sample": one,
        "half of it negative": half,
        "noise": rng.random(GRID.shape),
        "dark": exact * 1e-30,
    }


@pytest.mark.parametrize("case", hard_tables())
def test_hard_tables(case):
    table = Table(np.stack([hard_tables()[case]] * 3), GRID)
    assert violations(table, fitted(table), ggx_fitted) == []
