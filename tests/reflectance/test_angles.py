"""Half and difference angles against MERL's reader, written out as published."""

import numpy as np
import pytest

from npfm.reflectance.angles import directions, half_difference


def random_pairs(count):
    """Light and view directions above the horizon, shape (count, 3) each."""
    z = np.random.default_rng(5).uniform(0.01, 1, (2, count))
    azimuth = np.random.default_rng(6).uniform(-np.pi, np.pi, (2, count))
    radius = np.sqrt(1 - z**2)
    return np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)


def rotated(vector, axis, angle):
    """Rodrigues' rotation, as `rotate_vector` of BRDFRead.cpp."""
    turned = vector * np.cos(angle) + axis * (vector @ axis) * (1 - np.cos(angle))
    return turned + np.cross(axis, vector) * np.sin(angle)


def merl_reader(light, view):
    """`std_coords_to_half_diff_coords` of BRDFRead.cpp, with phi_d brought into [0, pi)."""
    half = (light + view) / 2
    half /= np.linalg.norm(half)
    theta_half, phi_half = np.arccos(half[2]), np.arctan2(half[1], half[0])
    turned = rotated(light, np.array([0.0, 0.0, 1.0]), -phi_half)
    difference = rotated(turned, np.array([0.0, 1.0, 0.0]), -theta_half)
    theta_diff = np.arccos(np.clip(difference[2], -1, 1))
    phi_diff = np.arctan2(difference[1], difference[0])
    return theta_half, theta_diff, phi_diff + np.pi if phi_diff < 0 else phi_diff


def around(angle, other):
    """Distance of two angles modulo pi."""
    return np.abs(np.mod(angle - other + np.pi / 2, np.pi) - np.pi / 2)


def test_agrees_with_the_merl_reader():
    light, view = random_pairs(500)
    theta_h, theta_d, phi_d = half_difference(light, view)
    expected = np.array([merl_reader(i, o) for i, o in zip(light, view, strict=True)]).T
    np.testing.assert_allclose(theta_h, expected[0], atol=1e-10)
    np.testing.assert_allclose(theta_d, expected[1], atol=1e-10)
    assert around(phi_d, expected[2]).max() < 1e-10


def test_angles_come_back_from_their_directions():
    rng = np.random.default_rng(1)
    theta_h, theta_d = rng.uniform(0.05, 1.5, (2, 1000))
    phi_d = rng.uniform(0, np.pi, 1000)
    back = half_difference(*directions(theta_h, theta_d, phi_d))
    np.testing.assert_allclose(back[0], theta_h, atol=1e-12)
    np.testing.assert_allclose(back[1], theta_d, atol=1e-12)
    assert around(back[2], phi_d).max() < 1e-12


def test_small_angles_keep_their_relative_accuracy():
    """Half the MERL grid lies within 23 degrees of the normal, its first bin within 0.01."""
    tiny = np.array([1e-8, 1e-6, 1e-4])
    theta_h, _, _ = half_difference(*directions(tiny, 0.3, 0.7))
    np.testing.assert_allclose(theta_h, tiny, rtol=1e-6)
    _, theta_d, _ = half_difference(*directions(0.3, tiny, 0.7))
    np.testing.assert_allclose(theta_d, tiny, rtol=1e-6)


def test_directions_are_unit_vectors_about_the_half_vector():
    theta_h, theta_d, phi_d = np.meshgrid([0.1, 1.2], [0.2, 1.4], [0.3, 2.5], indexing="ij")
    light, view = directions(theta_h, theta_d, phi_d)
    np.testing.assert_allclose(np.linalg.norm(light, axis=-1), 1, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(view, axis=-1), 1, atol=1e-15)
    half = (light + view) / np.linalg.norm(light + view, axis=-1, keepdims=True)
    np.testing.assert_allclose(np.arccos(half[..., 2]), theta_h, atol=1e-12)
    np.testing.assert_allclose(np.einsum("...i,...i", half, light), np.cos(theta_d), atol=1e-14)


def test_exchanging_light_and_view_changes_no_angle():
    light, view = random_pairs(500)
    forward, backward = half_difference(light, view), half_difference(view, light)
    np.testing.assert_allclose(forward[0], backward[0], atol=1e-12)
    np.testing.assert_allclose(forward[1], backward[1], atol=1e-12)
    assert around(forward[2], backward[2]).max() < 1e-12


def test_turning_phi_d_by_pi_exchanges_light_and_view():
    light, view = directions(0.4, 0.9, 1.1)
    other_light, other_view = directions(0.4, 0.9, 1.1 + np.pi)
    np.testing.assert_allclose(other_light, view, atol=1e-15)
    np.testing.assert_allclose(other_view, light, atol=1e-15)


def test_rotation_about_the_normal_changes_no_angle():
    light, view = random_pairs(200)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    for before, after in zip(
        half_difference(light, view), half_difference(light @ turn.T, view @ turn.T), strict=True
    ):
        np.testing.assert_allclose(after, before, atol=1e-11)


def test_the_frame_of_any_normal_will_do():
    light, view = random_pairs(200)
    turn = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    tilted = half_difference(light @ turn.T, view @ turn.T, turn[:, 2])
    for before, after in zip(half_difference(light, view), tilted, strict=True):
        np.testing.assert_allclose(after, before, atol=1e-10)


@pytest.mark.parametrize("theta", [0.0, 0.5, 1.5])
def test_the_edges_stay_in_range(theta):
    """Light at the view, and the half vector at the normal, where phi_d means nothing."""
    vector = np.array([np.sin(theta), 0.0, np.cos(theta)])
    theta_h, theta_d, phi_d = half_difference(vector, vector)
    assert theta_h == pytest.approx(theta, abs=1e-15)
    assert theta_d == 0
    assert 0 <= phi_d < np.pi
    theta_h, theta_d, phi_d = half_difference(vector, vector * [-1, -1, 1])
    assert theta_h == pytest.approx(0, abs=1e-15)
    assert theta_d == pytest.approx(theta)
    assert 0 <= phi_d < np.pi


def test_shapes_broadcast():
    light, view = directions(np.zeros((4, 1)), np.ones(5), 0.3)
    assert light.shape == view.shape == (4, 5, 3)
    assert half_difference(light, view[0, 0])[0].shape == (4, 5)
