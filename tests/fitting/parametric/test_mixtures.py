"""Lobes fitted by two criteria: their own are found again, and each is the better by its own."""

import numpy as np
import pytest
from scipy.optimize import minimize

from npfm.errors import NpfmError
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, solid_angles
from npfm.fitting.parametric import blinn_phong, lafortune, mixtures
from npfm.fitting.parametric.lobes import Directions
from npfm.reflectance.half_difference import HalfDifference

GRID = HalfDifference(18, 18, 36)
CRITERIA = ("kullback-leibler", "least-squares")
LAFORTUNE = {
    "rho_d": np.array([0.05, 0.1, 0.2]),
    "rho_s": np.array([[0.2, 3.0], [0.3, 2.0], [0.1, 1.0]]),
    "n": np.array([[6.0, 150.0]]),
    "C_xy": np.array([[-1.0, -1.0]]),
    "C_z": np.array([[0.8, 1.0]]),
}
PHONG = {
    "rho_d": LAFORTUNE["rho_d"],
    "rho_s": np.array([[0.5], [0.4], [0.3]]),
    "n": np.array([[40.0]]),
    "F_0": np.array([[0.2]]),
}


def made(form, parameters):
    stored = {key: value.astype(np.float32) for key, value in parameters.items()}
    return mixtures.tabulate(form, Fit("some", stored, GRID))


def fitted(form, table, lobes, criterion):
    return mixtures.fit("some", form, lobes, criterion, table, Objective())


@pytest.mark.parametrize("criterion", CRITERIA)
@pytest.mark.parametrize(
    ("form", "parameters"),
    [(lafortune.FORM, LAFORTUNE), (blinn_phong.FORM, PHONG)],
    ids=["lafortune", "blinn-phong"],
)
def test_lobes_are_found_again(form, parameters, criterion):
    fit = fitted(form, made(form, parameters), parameters["rho_s"].shape[1], criterion)
    for key, value in parameters.items():
        np.testing.assert_allclose(fit.parameters[key], value, rtol=1e-3, err_msg=key)


def light(table):
    """Reflected light, and how often each pair of directions is seen."""
    cos_i, cos_o = table.grid.cosines
    limit = np.cos(np.deg2rad(89))
    counts = (cos_i > limit) & (cos_o > limit) & (table.values >= 0).all(axis=0)
    weight = (solid_angles(table.grid) * cos_o)[counts]
    return (table.values * cos_i).mean(axis=0)[counts], weight


def test_each_criterion_is_best_by_its_own(table):
    fits = {c: fitted(lafortune.FORM, table, 2, c) for c in CRITERIA}
    measured, weight = light(table)
    squares, divergence = {}, {}
    for criterion, fit in fits.items():
        shown = mixtures.tabulate(lafortune.FORM, fit)
        model, _ = light(type(table)(np.where(table.valid, shown.values, -1), table.grid))
        squares[criterion] = weight @ (model - measured) ** 2
        divergence[criterion] = weight @ (measured * np.log(measured / model) - measured + model)
    assert squares["least-squares"] < squares["kullback-leibler"]
    assert divergence["kullback-leibler"] < divergence["least-squares"]


def test_coefficients_of_least_divergence_are_those_of_a_plain_search():
    rng = np.random.default_rng(3)
    columns, weight = rng.random((3, 200)) ** 3, rng.random(200)
    value = np.array([0.5, 0.0, 2.0]) @ columns * np.exp(0.3 * rng.standard_normal(200))
    found = mixtures._least_divergence(columns, value, weight)

    def divergence(c):
        model = np.maximum(c @ columns, 1e-12)
        return weight @ (value * np.log(np.maximum(value, 1e-300) / model) - value + model)

    plain = minimize(divergence, np.ones(3), bounds=[(0, None)] * 3, tol=1e-12)
    assert divergence(found) <= plain.fun * (1 + 1e-4)


def test_a_divergence_is_the_sum_of_the_squares_of_its_residuals():
    at = Directions(*np.full((4, 3), 0.5))
    seen = mixtures._Seen(at, np.array([1.0, 2.0, 0.5]), np.array([1.0, 0.0, 3.0]), 1.0, True)
    model = np.array([2.0, 0.5, 3.0])
    expected = (np.log(1 / 2) - 1 + 2) + 2 * 0.5
    residuals = seen.residuals(model)
    assert np.sum(residuals**2) / 2 == pytest.approx(expected)
    assert residuals[0] > 0 and residuals[2] == 0


@pytest.mark.parametrize("divergence", [True, False])
def test_a_lobe_between_the_samples_is_left_out(divergence):
    at = Directions(*np.full((4, 50), 0.5))
    value = 1 + 0.1 * np.random.default_rng(4).random(50)
    seen = mixtures._Seen(at, np.full(50, 0.02), value, 1.0, divergence)
    tail = 1e-90 * np.linspace(1, 2, 50)[None]
    found = seen.coefficients(tail)
    assert found[1] == 0
    assert found[0] == pytest.approx(value.mean(), rel=1e-3)


@pytest.mark.parametrize("lobes", [0, 5, -1])
def test_a_number_of_lobes_that_nobody_fits_is_refused(table, lobes):
    with pytest.raises(NpfmError, match="from 1 to 4"):
        fitted(lafortune.FORM, table, lobes, "least-squares")


@pytest.mark.parametrize("divergence", [True, False])
def test_a_lobe_that_no_sample_sees_has_no_coefficient(divergence):
    value = np.linspace(1, 2, 50)
    seen = mixtures._Seen(None, np.full(50, 0.02), value, 1.0, divergence)
    rising, unseen = np.linspace(0, 1, 50), 1e-99 * np.linspace(1, 0, 50)
    found = seen.coefficients(np.stack([rising, unseen]))
    np.testing.assert_allclose(found, [1, 1, 0], atol=1e-3)
