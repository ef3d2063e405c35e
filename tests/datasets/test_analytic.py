"""Analytic reflectance: reciprocity, energy, what the originals say of special directions."""

import numpy as np
import pytest
from scipy.integrate import quad

from npfm.__main__ import main
from npfm.datasets.analytic import FORMULAS, poulin_fournier, ward
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table_files import read_table

#: Those that are the same however the surface is turned.
ISOTROPIC = ("cook-torrance", "hapke-lommel", "ward-isotropic")


def unit(theta, phi):
    theta, phi = np.broadcast_arrays(np.radians(theta), np.radians(phi))
    sine = np.sin(theta)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), np.cos(theta)], axis=-1)


def pairs(count=400, seed=2):
    rng = np.random.default_rng(seed)
    return unit(89 * rng.random((2, count)), 360 * rng.random((2, count)))


def turned(directions, degrees):
    x, y = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return directions @ np.array([[x, y, 0], [-y, x, 0], [0, 0, 1]])


@pytest.mark.parametrize("name", FORMULAS)
def test_values_are_finite_and_not_negative(name):
    values = FORMULAS[name](*pairs())
    assert values.shape == (3, 400)
    assert np.isfinite(values).all() and (values >= 0).all()


@pytest.mark.parametrize("name", FORMULAS)
def test_light_and_view_can_be_exchanged(name):
    light, view = pairs()
    np.testing.assert_allclose(FORMULAS[name](light, view), FORMULAS[name](view, light), rtol=1e-9)


@pytest.mark.parametrize("name", FORMULAS)
def test_turning_the_surface_changes_what_is_anisotropic(name):
    light, view = pairs()
    other = FORMULAS[name](turned(light, 37), turned(view, 37))
    same = np.allclose(FORMULAS[name](light, view), other, rtol=1e-9)
    assert same == (name in ISOTROPIC)


@pytest.mark.parametrize("name", sorted({*FORMULAS} - {"ward", "ward-isotropic"}))
@pytest.mark.parametrize("theta_o", [5, 45, 75])
def test_no_more_light_is_sent_out_than_comes_in(name, theta_o):
    z, phi = np.meshgrid((np.arange(200) + 0.5) / 200, np.arange(100) * 3.6)
    light = unit(np.degrees(np.arccos(np.sqrt(z.ravel()))), phi.ravel())
    view = np.broadcast_to(unit(theta_o, 20), light.shape)
    assert (np.pi * FORMULAS[name](light, view).mean(axis=1) < 1.02).all()


def test_ward_at_the_normal():
    """rho_d / pi + rho_s / (4 pi alpha_x alpha_y)."""
    z = unit([0.0], [0.0])
    np.testing.assert_allclose(ward(z, z), 0.1 / np.pi + 1.2 / (4 * np.pi * 0.2 * 0.02))
    across, along = (ward(unit([10.0], [a]), z)[0, 0] for a in (90, 0))
    assert along > 10 * across


def test_hapke_is_twice_as_bright_towards_the_light():
    """B is 2 at opposition, and S is 1: 4 / (3 pi) / (2 cos)."""
    for theta in (10.0, 50.0):
        d = unit([theta], [30.0])
        expected = 2 * 2 / (3 * np.pi) / (2 * np.cos(np.radians(theta)))
        np.testing.assert_allclose(FORMULAS["hapke-lommel"](d, d), expected, rtol=1e-3)


def test_cylinders_seen_from_above_are_a_plain_integral():
    """Nothing is hidden from the normal: the mean over the profile of f(m) cos^2."""
    z = unit([0.0], [0.0])

    def part(a):
        m = np.cos(a)
        return (0.2 / np.pi + 0.8 * 28 / (8 * np.pi) * m**20) * m**2

    expected = quad(part, -np.pi / 2, np.pi / 2)[0] / 2
    np.testing.assert_allclose(poulin_fournier(z, z), expected, rtol=1e-3)


def test_cylinders_hide_their_neighbours_across_and_not_along():
    """Of a Lambertian cylinder of the same profile, seen from a grazing angle across, a part."""
    z = unit([0.0], [0.0])
    across, along = (poulin_fournier(z, unit([80.0], [a]))[0, 0] for a in (90, 0))
    # Along, the half vector leaves the plane across the cylinders: all normals dim together.
    assert across != pytest.approx(along, rel=0.1)


def test_a_table_has_the_formula_at_the_middles_of_its_cells(tmp_path):
    made = tmp_path / "rough-metal.binary"
    assert main(["material", "--formula", "cook-torrance", "-o", str(made)]) == 0
    table = read_table(made)
    cell = 10, 30, 45
    light, view = directions(MERL.theta_h[10], MERL.theta_d[30], MERL.phi_d[45])
    expected = FORMULAS["cook-torrance"](light[None], view[None])[:, 0]
    np.testing.assert_allclose(table.values[(slice(None), *cell)], expected, rtol=1e-6)


def test_a_formula_that_is_no_isotropic_one_is_told_in_one_line(capsys, tmp_path):
    for name, hint in (("cook-torance", "cook-torrance"), ("ward", "ward-isotropic")):
        assert main(["material", "--formula", name, "-o", str(tmp_path / "a.binary")]) == 1
        told = capsys.readouterr().err
        assert f"no isotropic formula '{name}'" in told and hint in told
        assert told.count("\n") == 1
