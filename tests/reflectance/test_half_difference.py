"""The MERL grid and its thinner relatives."""

import numpy as np
import pytest

from npfm.reflectance.angles import directions, half_difference
from npfm.reflectance.grids import local_cells
from npfm.reflectance.half_difference import MERL, HalfDifference


def test_the_default_is_merls():
    assert MERL.shape == (90, 90, 180)
    assert MERL.size == 1_458_000
    assert MERL.name == "half-difference 90x90x180"


@pytest.mark.parametrize("k", [0, 1, 17, 44, 89])
def test_theta_h_bins_are_merls(k):
    """Bin k covers [(k/90)^2, ((k+1)/90)^2) x 90 degrees."""
    low, high = np.deg2rad(90 * (np.array([k, k + 1]) / 90) ** 2)
    inside = np.array([low + 1e-9, (low + high) / 2, high - 1e-9])
    assert (MERL.cell(inside, np.zeros(3), np.zeros(3)) == k * 90 * 180).all()
    assert low < MERL.theta_h[k] < high
    assert MERL.cell(np.array([high + 1e-9]), np.zeros(1), np.zeros(1)) == min(k + 1, 89) * 16200


@pytest.mark.parametrize("degrees", [0, 1, 45, 89])
def test_theta_d_and_phi_d_bins_are_one_degree(degrees):
    inside = np.deg2rad(degrees + np.array([1e-7, 0.5, 1 - 1e-7]))
    assert (MERL.cell(np.zeros(3), inside, np.zeros(3)) == degrees * 180).all()
    assert (MERL.cell(np.zeros(3), np.zeros(3), inside) == degrees).all()
    assert MERL.theta_d[degrees] == pytest.approx(np.deg2rad(degrees + 0.5))
    assert MERL.phi_d[degrees] == pytest.approx(np.deg2rad(degrees + 0.5))


def test_upper_ends_fall_into_the_last_bin():
    top = np.array([np.pi / 2])
    last = MERL.cell(top, top, np.array([np.nextafter(np.pi, 0)]))
    assert last == MERL.size - 1


@pytest.mark.parametrize("grid", [MERL, HalfDifference(18, 18, 36), HalfDifference(7, 5, 4)])
def test_the_cell_of_a_centre_is_its_own(grid):
    centres = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d, indexing="ij")
    assert (grid.cell(*centres).ravel() == np.arange(grid.size)).all()


def test_the_cell_of_directions_at_a_centre_is_its_own():
    """Through the angles, so that grid and angles mean the same phi_d."""
    grid = HalfDifference(18, 18, 36)
    centres = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d, indexing="ij")
    angles = half_difference(*directions(*centres))
    assert (grid.cell(*angles).ravel() == np.arange(grid.size)).all()


def test_cosines_are_those_of_the_directions():
    grid = HalfDifference(12, 10, 14)
    centres = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d, indexing="ij")
    light, view = directions(*centres)
    np.testing.assert_allclose(grid.cosines[0], light[..., 2], atol=1e-15)
    np.testing.assert_allclose(grid.cosines[1], view[..., 2], atol=1e-15)
    assert (grid.above_horizon == ((light[..., 2] > 0) & (view[..., 2] > 0))).all()


def test_exchanging_light_and_view_mirrors_phi_d():
    """Bin p and bin n - 1 - p hold the same pair of directions, exchanged."""
    cos_i, cos_o = MERL.cosines
    np.testing.assert_allclose(cos_i[..., ::-1], cos_o, atol=1e-15)


def test_the_share_above_the_horizon_is_that_of_random_angles():
    theta_h, theta_d, phi_d = np.random.default_rng(2).random((3, 400_000))
    light, view = directions(theta_h**2 * np.pi / 2, theta_d * np.pi / 2, phi_d * np.pi)
    share = ((light[:, 2] > 0) & (view[:, 2] > 0)).mean()
    assert MERL.above_horizon.mean() == pytest.approx(share, abs=4 * (0.25 / 400_000) ** 0.5)


def test_grids_are_equal_by_value():
    assert HalfDifference(90, 90, 180) == MERL
    assert hash(HalfDifference(90, 90, 180)) == hash(MERL)
    assert HalfDifference(90, 90, 90) != MERL


def random_pairs(count):
    """Pairs of light and view above the horizon of the z axis, some of them grazing."""
    rng = np.random.default_rng(0)
    light, view = rng.normal(size=(2, count, 3)) * [1, 1, 0.5]
    for direction in (light, view):
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        direction[:, 2] = np.abs(direction[:, 2])
    return light, view


def cells_of(grid, light, view):
    index, share = local_cells(grid, light, view)
    assert share is None
    return index


def test_cells_are_those_of_half_difference():
    light, view = random_pairs(200_000)
    # Rounding may move a pair of directions over the border of a cell.
    same = cells_of(MERL, light, view) == MERL.cell(*half_difference(light, view))
    assert same.mean() > 0.9999


def test_exchanging_light_and_view_gives_the_same_cell():
    light, view = random_pairs(200_000)
    same = cells_of(MERL, light, view) == cells_of(MERL, view, light)
    assert same.mean() > 0.9999
