from functools import lru_cache

import numpy as np
import pytest

from npfm.datasets import synthetic
from npfm.datasets.formulas import Angles
from npfm.errors import NpfmError
from npfm.reflectance import merl
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID

NAMES = list(synthetic.MATERIALS)


@lru_cache(maxsize=4)
def table(name, seed=0):
    return synthetic.load(name, seed)


def angles_between(light, view):
    """Angles of unit vectors of shape (n, 3), by their dot products."""
    half_vector = light + view
    half_vector /= np.linalg.norm(half_vector, axis=-1, keepdims=True)
    cos_d = np.minimum((half_vector * view).sum(axis=-1), 1)
    return Angles(half_vector[:, 2], cos_d, light[:, 2], view[:, 2])


def degrees(theta, phi):
    theta, phi = np.radians(theta), np.radians(phi)
    return np.array([[np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]])


def brdf(name, light, view):
    """BRDF without noise, directions as (theta, phi) in degrees; shape (3,)."""
    return synthetic.MATERIALS[name].brdf(angles_between(degrees(*light), degrees(*view)))[:, 0]


def directional_albedo(function, theta_o):
    """Reflected share of light from the direction `theta_o` (degrees).

    Midpoint rule over half vectors, dense near the normal so that a mirror's highlight is seen;
    a solid angle of half vectors is 4 o.h times as large as that of the other direction.
    """
    s, phi = (np.arange(600) + 0.5) / 600, (np.arange(240) + 0.5) / 240 * 2 * np.pi
    theta_h, phi = (a.ravel() for a in np.meshgrid(s**2 * np.pi / 2, phi))
    solid_angle = np.sin(theta_h) * np.sqrt(theta_h * np.pi / 2) * 2 / 600 * 2 * np.pi / 240
    half_vector = np.stack(
        [np.sin(theta_h) * np.cos(phi), np.sin(theta_h) * np.sin(phi), np.cos(theta_h)], axis=-1
    )
    view = degrees(theta_o, 0.0)
    cos_d = half_vector @ view[0]
    light = 2 * cos_d[:, None] * half_vector - view
    seen = (cos_d > 0) & (light[:, 2] > 1e-6)
    weight = (4 * cos_d * light[:, 2] * solid_angle)[seen]
    view = np.broadcast_to(view, light.shape)
    return (function(angles_between(light[seen], view[seen])) * weight).sum(axis=-1)


def half_width(name, theta_d):
    """theta_h in degrees at which the green highlight has fallen to half, light beside view."""
    theta_h = np.radians(np.linspace(0.05, 40, 2000))
    light, view = directions(theta_h, np.radians(theta_d), np.pi / 2)
    values = synthetic.MATERIALS[name].brdf(angles_between(light, view))[1]
    return np.degrees(theta_h[np.argmax(values < values[0] / 2)])


def test_there_are_enough_materials_and_each_is_described():
    assert len(NAMES) >= 12
    assert synthetic.materials() == sorted(NAMES)
    assert all(material.description for material in synthetic.MATERIALS.values())


@pytest.mark.parametrize("theta", [1, 45, 75, 88])
def test_the_albedo_quadrature_knows_lambert(theta):
    albedo = directional_albedo(lambda angles: np.full((3, angles.cos_i.size), 1 / np.pi), theta)
    np.testing.assert_allclose(albedo, 1, atol=1e-4)


@pytest.mark.parametrize("name", NAMES)
def test_no_material_reflects_more_than_it_receives(name):
    albedo = [directional_albedo(synthetic.MATERIALS[name].brdf, t) for t in (1, 30, 60, 80, 88)]
    assert np.min(albedo) > 0
    assert np.max(albedo) < 1


def test_materials_run_from_bright_metal_to_black_rubber():
    mirror, rubber, chalk = (
        directional_albedo(synthetic.MATERIALS[name].brdf, 30)
        for name in ("mirror-metal", "dark-rubber", "chalk")
    )
    # A mirror this smooth returns nothing but Fresnel's share, 0.91 for aluminium.
    np.testing.assert_allclose(mirror, 0.92, atol=0.02)
    assert rubber.max() < 0.1 < 0.8 < chalk.min()


@pytest.mark.parametrize("name", NAMES)
def test_materials_are_reciprocal_before_the_noise(name):
    light, view = (70, 10), (20, 130)
    np.testing.assert_allclose(brdf(name, light, view), brdf(name, view, light), rtol=1e-9)


@pytest.mark.parametrize("name", ["mirror-metal", "terracotta", "pink-felt"])
def test_a_table_is_the_formula_with_a_few_per_cent_of_noise(name):
    values = table(name).values
    cells = np.argwhere((values[0] >= 0) & (np.minimum(*MERL.cosines) > np.cos(np.radians(85))))
    h, d, p = np.random.default_rng(1).choice(cells, 3000, replace=False).T
    light, view = directions(MERL.theta_h[h], MERL.theta_d[d], MERL.phi_d[p])
    exact = synthetic.MATERIALS[name].brdf(angles_between(light, view))
    error = values[:, h, d, p] - exact
    assert np.all(np.abs(error) < 6 * (0.05 * exact + synthetic.NOISE_FLOOR))
    above_floor = exact > 100 * synthetic.NOISE_FLOOR
    head_on = above_floor & (np.minimum(light[:, 2], view[:, 2]) > np.cos(np.radians(50)))
    grazing = above_floor & (np.minimum(light[:, 2], view[:, 2]) < np.cos(np.radians(75)))
    relative = error / exact
    assert 0.015 < relative[head_on].std() < 0.03 < relative[grazing].std() < 0.05


def test_noise_is_not_reciprocal():
    values = table("chalk").values[:, :45, :45]
    # Exchanging light and view maps phi_d to 180 degrees - phi_d.
    difference = (values - values[..., ::-1]) / values
    assert 0.02 < difference.std() < 0.06


@pytest.mark.parametrize("name", ["mirror-metal", "nylon", "pink-felt"])
def test_samples_are_finite_and_missing_where_merl_has_gaps(name):
    values, valid = table(name).values, table(name).valid
    assert values.dtype == np.float64
    assert np.isfinite(values).all()
    assert np.array_equal(values == INVALID, ~valid)
    assert np.array_equal(valid, [valid[0]] * 3)
    assert not (valid[0] & ~MERL.above_horizon).any()
    lowest = np.minimum(*MERL.cosines)
    assert valid[0][lowest >= np.cos(np.radians(88))].all()
    # Ragged: in every strip of half a degree some samples are there and some are not.
    for start, share in ((88.0, 0.125), (88.5, 0.375), (89.0, 0.625), (89.5, 0.875)):
        upper, lower = np.cos(np.radians([start, start + 0.5]))
        strip = valid[0][(lowest < upper) & (lowest >= max(lower, 1e-12))]
        assert 1 - strip.mean() == pytest.approx(share, abs=0.05)


def test_a_table_survives_the_file_format(tmp_path):
    merl.write_binary(tmp_path / "felt.binary", table("pink-felt"))
    back = merl.read_binary(tmp_path / "felt.binary")
    assert np.array_equal(back.valid, table("pink-felt").valid)
    valid = back.valid
    np.testing.assert_allclose(back.values[valid], table("pink-felt").values[valid], rtol=1e-15)


def test_seed_and_name_decide_the_noise_and_nothing_else():
    first = table("chalk")
    other = table("terracotta")
    assert np.array_equal(first.values, synthetic.load("chalk", 0).values)
    assert not np.array_equal(first.values, synthetic.load("chalk", 1).values)
    # Two materials of one seed do not share their gaps either.
    assert not np.array_equal(first.valid, other.valid)


def test_an_unknown_material_is_answered_with_the_nearest():
    with pytest.raises(NpfmError, match=r"no synthetic material 'mirror'; did you mean mirror-m"):
        synthetic.load("mirror", 0)


def test_the_mirror_is_narrow_and_high():
    assert half_width("mirror-metal", 10) < 0.5
    assert brdf("mirror-metal", (30, 0), (30, 180)).min() > 500


def test_a_highlight_that_does_not_separate_narrows_with_theta_d():
    # D(theta_h) F(theta_d) has the same width everywhere, as gold shows but for its shadowing.
    assert half_width("rough-gold", 60) == pytest.approx(half_width("rough-gold", 5), rel=0.1)
    assert half_width("tarnished-bronze", 60) < 0.5 * half_width("tarnished-bronze", 5)


@pytest.mark.parametrize("name", ["hazy-chrome", "car-paint"])
def test_two_lobes_have_a_core_and_a_shoulder(name):
    # The red highlight drops at once by the core, then hardly over twice the angle.
    light, view = directions(np.radians([0.01, 6.0, 12.0]), np.radians(20), np.pi / 2)
    peak, shoulder, beyond = synthetic.MATERIALS[name].brdf(angles_between(light, view))[0]
    assert peak > 30 * shoulder
    assert shoulder < 3 * beyond


def test_nylon_shines_at_silhouettes_against_the_light():
    def backlit(name):
        """Light behind the edge against light from the side, off the mirror direction."""
        return (brdf(name, (85, 180), (65, 0)) / brdf(name, (85, 60), (65, 0)))[1]

    assert backlit("nylon") > 3
    assert backlit("chalk") < 1.1


def test_tape_sends_light_back():
    for theta in (20, 35, 50):
        back = brdf("reflective-tape", (theta, 0), (theta + 0.5, 0))
        assert np.all(back > 10 * brdf("reflective-tape", (theta, 0), (theta, 90)))


@pytest.mark.parametrize(("name", "shift"), [("pearl-paint", 2.0), ("rough-gold", 1.3)])
def test_fresnel_colour_shifts_with_theta_d(name, shift):
    def red_to_blue(theta):
        colour = brdf(name, (theta, 0), (theta, 180))
        return colour[0] / colour[2]

    ratios = [red_to_blue(theta) for theta in (2, 40, 60, 80)]
    assert max(ratios) > shift * min(ratios)


def test_felt_is_brightest_at_the_rim():
    assert np.all(brdf("pink-felt", (85, 90), (85, 0)) > 2 * brdf("pink-felt", (5, 90), (5, 0)))
