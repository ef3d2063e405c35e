"""Errors of factors: a measure that is stated, and what the paper's resolutions reach."""

import numpy as np
import pytest

from npfm.datasets import neural
from npfm.datasets.analytic import FORMULAS
from npfm.evaluation.factorisation import by_terms, described, directions, errors, model
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.papers import lawrence2004
from npfm.reflectance.factored import Angles


def white(light, view):
    return np.full((3, len(light)), 1 / np.pi)


def test_angles_and_azimuths_are_spread_evenly():
    for d in directions(20_000, 3):
        np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1)
        theta, phi = np.degrees(np.arccos(d[:, 2])), np.degrees(np.arctan2(d[:, 1], d[:, 0]))
        np.testing.assert_allclose(np.histogram(theta, 9, (0, 90))[0], 2222, atol=200)
        np.testing.assert_allclose(np.histogram(phi, 9, (-180, 180))[0], 2222, atol=200)


def test_errors_are_shares_of_the_mean():
    assert errors(white, white, 1000) == (0, 0)
    error, rms = errors(white, lambda i, o: 1.5 * white(i, o), 200_000)
    assert error == pytest.approx(0.5)
    # Of cos(theta_i) with theta_i even: the root of the mean square over the mean is pi / 8^(1/2).
    assert rms == pytest.approx(0.5 * np.pi / np.sqrt(8), rel=0.01)


def test_measured_nickel_is_more_accurate_than_printed(data):
    table = neural.load(data / "merl_nbrdf.zip", "nickel")
    row = lawrence2004.TABLE_1["nickel"]
    recipe = Recipe(Angles(row.half, False, row.resolution), row.terms)
    error, _ = errors(table.lookup, model(factor(table.lookup, recipe).factors))
    assert error <= 0.17 < row.error


def test_two_inner_terms_are_needed_by_a_brushed_surface():
    """Figure 6 of the paper, at a resolution that a test has time for."""
    recipe = Recipe(Angles(True, False, (8, 8, 32, 32)))
    table = by_terms(FORMULAS["ward"], recipe, [1], [1, 2, 3]).set_index("inner")
    assert table["rms"][2] < 0.8 * table["rms"][1]
    assert table["rms"][3] < table["rms"][2]


def test_a_row_tells_the_bytes_that_are_stored():
    factors = factor(white, Recipe(Angles(False, True, (4, 1, 8, 6)), (2, 3))).factors
    row = described("white", factors)
    assert row["bytes"] == 4 * (2 + 2 * 4 + 6 * (8 + 6) + 3 * (2 + 4 + 8 + 6))
    assert (row["outer"], row["inner"], row["phi_o"], row["recipe"]) == (2, 3, 1, "improved")
