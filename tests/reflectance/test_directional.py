"""The directional grid against loops over its angles."""

from itertools import product

import numpy as np
import pytest

from npfm.reflectance import directional
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.table import Table

GRIDS = [UTIA, Directional(4, 8, 3, 12), Directional(2, 1, 3, 2)]


def random_directions(count, seed=1):
    light, view = np.random.default_rng(seed).normal(size=(2, count, 3))
    for direction in (light, view):
        direction[:, 2] = np.abs(direction[:, 2])
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return light, view


def angles(direction):
    """theta and phi in degrees, phi in [0, 360)."""
    x, y, z = direction
    return np.degrees(np.arccos(z)), np.degrees(np.arctan2(y, x)) % 360


def neighbours(angle, step, count):
    low = min(int(angle // step), count)
    return [(low, 1 - (angle / step - low)), (low + 1, angle / step - low)]


def read(values, light, view):
    """Sixteen nodes, linear and periodic, extrapolated beyond the last theta and cut at 0."""
    theta_i, phi_i, theta_o, phi_o = values.shape[1:]
    places = [
        neighbours(angles(light)[0], 90 / theta_i, theta_i - 2),
        neighbours(angles(light)[1], 360 / phi_i, phi_i),
        neighbours(angles(view)[0], 90 / theta_o, theta_o - 2),
        neighbours(angles(view)[1], 360 / phi_o, phi_o),
    ]
    total = np.zeros(3)
    for (a, p), (b, q), (c, r), (d, s) in product(*places):
        total += p * q * r * s * np.maximum(values[:, a, b % phi_i, c, d % phi_o], 0)
    return np.maximum(total, 0)


def in_rows(grid, values, light, view):
    """What a transport matrix sees, row by row."""
    normal, tangent = (np.broadcast_to(axis, view.shape) for axis in np.eye(3)[[2, 0]])
    axes = grid.axes(normal, view, tangent)
    along = [np.stack([(d * axis).sum(axis=1) for axis in axes], axis=1) for d in (light, view)]
    index, share = grid.columns(*along, np.arange(len(view)))
    assert index.min() >= 0
    assert index.max() < grid.column_count
    assert share.min() >= -1e-12
    np.testing.assert_allclose(share.sum(axis=1), 1)
    return (grid.column_values(values)[:, index] * share).sum(axis=-1)


@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_values_are_linear_in_four_angles_and_periodic_and_never_negative(grid):
    values = np.random.default_rng(5).random((3, *grid.shape)) - 0.1
    light, view = random_directions(400)
    expected = np.transpose([read(values, *pair) for pair in zip(light, view, strict=True)])
    assert (expected == 0).any()
    found = Table(values, grid).lookup(light, view)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("grid", GRIDS, ids=str)
def test_a_matrix_sees_the_same_up_to_the_last_elevation_and_where_nothing_is_cut(grid):
    light, view = random_directions(400)
    rough = np.random.default_rng(5).random((3, *grid.shape))
    smooth = 1 + 0.1 * rough
    up_to = [
        np.arccos(d[:, 2]) < last
        for d, last in ((light, grid.theta_i[-1]), (view, grid.theta_o[-1]))
    ]
    inside = np.logical_and(*up_to)
    assert inside.sum() > 20
    for values, where in ((rough, inside), (smooth, slice(None))):
        expected = Table(values, grid).lookup(light, view)
        found = in_rows(grid, values, light, view)
        np.testing.assert_allclose(found[:, where], expected[:, where], rtol=1e-12)


def test_beyond_the_last_elevation_a_matrix_is_at_its_own_elevations_what_a_lookup_is():
    values = np.random.default_rng(7).random((3, *UTIA.shape))
    theta = np.radians(75 + 15 * np.arange(directional.BEYOND) / directional.BEYOND)
    light, view = (
        directional.directions(np.resize(theta, 60), np.resize(UTIA.phi_i[::k], 60)) for k in (1, 5)
    )
    expected = Table(values, UTIA).lookup(light, view)
    np.testing.assert_allclose(in_rows(UTIA, values, light, view), expected, atol=1e-9)


@pytest.mark.parametrize("grid", [UTIA, Directional(3, 8, 4, 6)])
def test_its_own_directions_have_the_values_of_their_cells(grid):
    values = np.random.default_rng(2).random((3, *grid.shape))
    light, view = np.broadcast_arrays(grid.light[:, :, None, None], grid.view)
    found = Table(values, grid).lookup(light.reshape(-1, 3), view.reshape(-1, 3))
    # Straight down, every azimuth is the same direction, that of the first.
    same = np.broadcast_to(values[:, :, :1], values.shape).copy()
    same[:, 1:] = values[:, 1:]
    same[:, :, :, 0] = same[:, :, :, 0, :1]
    np.testing.assert_allclose(found.reshape(values.shape), same, atol=1e-9)


def test_the_directions_are_those_of_the_utia_database():
    assert UTIA.shape == (6, 48, 6, 48)
    assert UTIA.size == 288**2
    for theta in (UTIA.theta_i, UTIA.theta_o):
        np.testing.assert_allclose(np.degrees(theta), [0, 15, 30, 45, 60, 75])
    for phi in (UTIA.phi_i, UTIA.phi_o):
        np.testing.assert_allclose(np.degrees(phi), np.arange(0, 360, 7.5))
    assert UTIA.above_horizon.all()


def test_azimuths_run_from_the_tangent_to_normal_x_tangent():
    grid = Directional(2, 4, 1, 1)
    values = np.zeros((3, *grid.shape))
    values[:, 1, :, 0, 0] = [1, 2, 3, 4]
    ahead = np.array([[1.0, 0, 1], [0, 1, 1], [-1, 0, 1], [0, -1, 1]]) / np.sqrt(2)
    found = Table(values, grid).lookup(ahead, np.array([[0.0, 0, 1]] * 4))
    np.testing.assert_allclose(found, [[1, 2, 3, 4]] * 3)


def test_there_are_no_azimuths_without_a_tangent():
    with pytest.raises(ValueError, match="tangent"):
        UTIA.axes(np.eye(3), np.eye(3), None)
