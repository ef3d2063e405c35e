"""The format of factors: what is stored, where, and what it evaluates to."""

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance.factored import NAMES, Angles, Factors, read, reflectance


def some(half=True, improved=True, shape=(4, 1, 6, 5), terms=(2, 3), seed=3):
    rng = np.random.default_rng(seed)
    J, K = terms
    u = rng.random((J, K, shape[2]))
    tints = (
        rng.random((3, *shape[:2])) + 0.5,
        rng.random((3, shape[2])) + 0.5,
        rng.random((3, shape[3])) + 0.5,
    )
    return Factors(
        Angles(half, improved, shape),
        rng.random((J, *shape[:2])),
        u / u.sum(axis=-1, keepdims=True),
        rng.random((J, K, shape[3])),
        rng.random(3) * improved,
        rng.random(3),
        tints,
    )


def pairs(count=200, seed=1):
    rng = np.random.default_rng(seed)
    vectors = rng.standard_normal((2, count, 3))
    vectors[..., 2] = np.abs(vectors[..., 2]) + 0.1
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


@pytest.mark.parametrize("half", [True, False])
@pytest.mark.parametrize("improved", [True, False])
@pytest.mark.parametrize("m", [1, 4])
def test_reflectance_is_the_sum_term_by_term(half, improved, m):
    factors = some(half, improved, (4, m, 6, 5))
    angles = factors.angles
    for light, view in zip(*pairs(40), strict=True):
        h = (light + view) / np.linalg.norm(light + view)
        p = h if half else light
        theta_o, phi_o = np.arccos(view[2]), np.arctan2(view[1], view[0]) % (2 * np.pi)
        azimuth = np.arctan2(p[1], p[0]) - (phi_o if m == 1 else 0)
        warped = np.sqrt if half and improved else np.asarray
        theta, turn_p = np.arccos(p[2]), (np.arange(-1, 6) + 0.5) / 5 * 2 * np.pi

        def of_p(u, v, theta=theta, azimuth=azimuth, warped=warped, turn_p=turn_p):
            around = np.concatenate([v[-1:], v, v[:1]])
            along = np.interp(warped(theta), warped(angles.theta_p), u)
            return along * np.interp(azimuth % (2 * np.pi), turn_p, around)

        def of_view(table, theta_o=theta_o, phi_o=phi_o):
            columns = np.concatenate([table, table[:, :1]], axis=1)
            turn = np.linspace(0, 2 * np.pi, m + 1)
            row = [np.interp(phi_o, turn, column) for column in columns]
            return np.interp(theta_o, angles.theta_o, row)

        area = -np.diff(np.cos(angles.edges)) * 2 * np.pi / 5
        total = sum(
            of_view(factors.F_o[j]) * of_p(factors.u[j, q] / area, factors.v[j, q])
            for j in range(2)
            for q in range(3)
        )
        total /= light[2] * (4 * light @ h if half and improved else 1)
        found = reflectance(factors, light[None], view[None])[:, 0]
        for channel in range(3):
            tint = of_view(factors.tints[0][channel])
            tint *= of_p(factors.tints[1][channel], factors.tints[2][channel])
            expected = factors.rho_d[channel] + factors.rho_s[channel] * tint * total
            assert found[channel] == pytest.approx(expected, rel=1e-9)


def test_bins_are_those_of_merl_only_for_half_vectors_of_the_improved_recipe():
    for half in (True, False):
        for improved in (True, False):
            edges = Angles(half, improved, (4, 1, 9, 5)).edges
            steps = np.diff(np.sqrt(edges) if half and improved else edges)
            np.testing.assert_allclose(steps, steps[0])
            assert edges[-1] == pytest.approx(np.pi / 2)


def test_every_angle_has_a_bin():
    angles = Angles(True, True, (4, 1, 7, 5))
    theta = np.r_[0.0, angles.theta_p, np.pi / 2]
    k, _ = angles.bin_of(theta, np.zeros(9))
    assert k.tolist() == [0, *range(7), 6]
    below = np.nextafter(2 * np.pi, 0)
    _, b = angles.bin_of(np.zeros(4), np.array([-1e-12, 0.0, below, 2 * np.pi]))
    assert b.tolist() == [4, 0, 4, 0]


def test_factors_come_back_from_their_arrays():
    factors = some(False, True, (3, 4, 6, 5))
    back = read(factors.arrays())
    assert back.angles == factors.angles
    for name, array in factors.arrays().items():
        assert np.array_equal(back.arrays()[name], array)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_no_factorisation_is_told_in_one_line(name):
    arrays = some().arrays()
    for damaged in ({}, {name: np.zeros((7, 2, 2, 2, 2, 2))}, {name: arrays[name][:0]}):
        rest = {key: value for key, value in arrays.items() if key != name}
        with pytest.raises(NpfmError, match="npfm factor"):
            read(rest | damaged)
