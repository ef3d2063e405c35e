"""Smith's G1 by linear algebra, against closed forms and against the paper's nested integrals."""

import numpy as np
import pytest

from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.factors.smith import (
    diffuseness,
    log_derivative,
    masking_shadowing,
    normalisation_vector,
    shadowing_matrix,
)
from npfm.reflectance.half_difference import MERL, HalfDifference


def ggx(theta, roughness):
    """Walter et al. 2007, equation 33."""
    return roughness**2 / (np.pi * np.cos(theta) ** 4 * (roughness**2 + np.tan(theta) ** 2) ** 2)


def ggx_g1(theta, roughness):
    """Walter et al. 2007, equation 34."""
    return 2 / (1 + np.sqrt(1 + (roughness * np.tan(theta)) ** 2))


def paper_g1(normal_distribution, theta, points):
    """Section 4.3 of Bagher et al. 2016 by its letters: 1 / (1 + Lambda) by nested quadrature."""
    x, w = np.polynomial.legendre.leggauss(points)

    def interval(low, high):
        return low + (high - low) * (x + 1) / 2, (high - low) / 2 * w

    def tabulated(angle):
        return np.interp(angle, MERL.theta_h, normal_distribution)

    angle, weight = interval(0, np.pi / 2)
    norm = 2 * np.pi * np.sum(tabulated(angle) * np.cos(angle) * np.sin(angle) * weight)
    mu = 1 / np.tan(theta)
    omega, w_omega = interval(np.arctan(mu), np.pi / 2)
    psi, w_psi = interval(0, np.pi / 2)
    tilt = np.arctan(np.sqrt(np.tan(omega)[:, None] ** 2 + np.tan(psi) ** 2))
    p22 = tabulated(tilt) / norm * np.cos(tilt) ** 4
    p2 = 2 * np.sum(p22 * (np.tan(psi) ** 2 + 1) * w_psi, axis=1)
    integrand = (np.tan(omega) - mu) * (1 + np.tan(omega) ** 2) * p2
    return 1 / (1 + np.sum(integrand * w_omega) / mu)


NORMAL_DISTRIBUTIONS = {
    "ggx": ggx(MERL.theta_h, 0.3),
    "mirror": ggx(MERL.theta_h, 0.02),
    "beckmann": np.exp(-((np.tan(MERL.theta_h) / 0.5) ** 2)) / np.cos(MERL.theta_h) ** 4,
    "flat": np.ones(90),
    "jagged": np.random.default_rng(0).uniform(0.1, 1, 90),
    "ring": np.exp(-(((MERL.theta_h - 0.6) / 0.1) ** 2)),
}


@pytest.mark.parametrize(
    ("roughness", "up_to_80", "up_to_89"),
    # What is left is D being linear between the bins, widest at grazing.
    [(0.3, 6e-5, 1.5e-4), (0.02, 3e-5, 1.1e-3)],
)
def test_ggx_in_closed_form(roughness, up_to_80, up_to_89):
    found = masking_shadowing(ggx(MERL.theta_h, roughness), MERL, G_THETA)
    error = np.abs(found / ggx_g1(G_THETA, roughness) - 1)
    assert error[:80].max() < up_to_80
    assert error[:89].max() < up_to_89


def test_ggx_gets_closer_with_the_bins():
    errors = []
    for bins in (45, 180, 720):
        fine = HalfDifference(bins, 2, 4)
        found = masking_shadowing(ggx(fine.theta_h, 0.3), fine, G_THETA)
        errors.append(np.abs(found / ggx_g1(G_THETA, 0.3) - 1).max())
    assert errors[1] < errors[0] / 12  # second order: 16 at best
    assert errors[2] < errors[1] / 12
    assert errors[2] < 4e-6


@pytest.mark.parametrize("name", NORMAL_DISTRIBUTIONS)
def test_the_papers_integrals_to_high_order(name):
    D = NORMAL_DISTRIBUTIONS[name]
    theta = G_THETA[[5, 30, 60, 80, 87]]
    expected = [paper_g1(D, angle, 250) for angle in theta]
    np.testing.assert_allclose(masking_shadowing(D, MERL, theta), expected, rtol=2e-3)


@pytest.mark.parametrize(("name", "within"), [("beckmann", 3e-4), ("ggx", 2e-3), ("mirror", 2e-2)])
def test_the_papers_15_points(name, within):
    """The error is that of 15 points; the paper calls it sufficient."""
    D = NORMAL_DISTRIBUTIONS[name]
    expected = [paper_g1(D, angle, 15) for angle in G_THETA]
    np.testing.assert_allclose(masking_shadowing(D, MERL, G_THETA), expected, rtol=within)


@pytest.mark.parametrize("name", NORMAL_DISTRIBUTIONS)
def test_falls_from_one_and_stays_positive(name):
    found = masking_shadowing(NORMAL_DISTRIBUTIONS[name], MERL, G_THETA)
    assert (np.diff(found) <= 1e-13).all()
    assert found[0] == pytest.approx(1, abs=1e-3)
    assert found.max() <= 1 + 1e-13
    assert found.min() > 0


def test_the_scale_of_d_does_not_matter():
    D = NORMAL_DISTRIBUTIONS["beckmann"]
    np.testing.assert_allclose(
        masking_shadowing(1e-7 * D, MERL, G_THETA), masking_shadowing(D, MERL, G_THETA), rtol=1e-13
    )


def test_closed_form_of_the_azimuth_integral():
    """Rows of the matrix against a plain sum over azimuth and theta_h."""
    small = HalfDifference(6, 2, 4)
    theta_o = 1.1
    row = shadowing_matrix(small, (theta_o,))[0] * np.cos(theta_o)
    theta = (np.arange(3000) + 0.5) / 3000 * np.pi / 2
    azimuth = (np.arange(900) + 0.5) / 900 * 2 * np.pi
    cosine = np.cos(theta_o) * np.cos(theta)[:, None] + np.sin(theta_o) * np.sin(theta)[
        :, None
    ] * np.cos(azimuth)
    ring = np.maximum(cosine, 0).mean(1) * 2 * np.pi * np.sin(theta) * (np.pi / 2 / 3000)
    for k, unit in enumerate(np.eye(6)):
        expected = np.sum(ring * np.interp(theta, small.theta_h, unit))
        assert row[k] == pytest.approx(expected, rel=1e-4)


def test_normalisation_of_a_flat_distribution_is_pi():
    assert normalisation_vector(MERL).sum() == pytest.approx(np.pi, rel=1e-12)
    assert diffuseness(np.ones(90), MERL) == pytest.approx(np.pi, rel=1e-12)


def test_diffuseness_grows_with_roughness():
    """Equation 19; for GGX scaled to maximum 1 it is pi roughness^2."""
    roughness = np.array([0.1, 0.3, 0.6])
    D = np.array([ggx(MERL.theta_h, r) / ggx(0.0, r) for r in roughness])
    np.testing.assert_allclose(diffuseness(D, MERL), np.pi * roughness**2, rtol=3e-3)


@pytest.mark.parametrize("name", ["ggx", "jagged", "ring"])
def test_log_derivative_against_differences(name):
    D, step = NORMAL_DISTRIBUTIONS[name], 1e-5

    def log_g(log_d):
        G = masking_shadowing(np.exp(log_d), MERL, G_THETA)
        return np.log(G / G.max())

    found = log_derivative(D, MERL, G_THETA)
    for k in (0, 3, 30, 60, 89):
        unit = np.eye(90)[k] * step
        expected = (log_g(np.log(D) + unit) - log_g(np.log(D) - unit)) / (2 * step)
        np.testing.assert_allclose(found[:, k], expected, atol=1e-8)
