"""Formulas against quadrature and known limits, tables against formulas."""

from functools import lru_cache

import numpy as np
import pytest

from npfm.datasets import anisotropic_formulas as formulas
from npfm.datasets import formulas as isotropic
from npfm.datasets import synthetic_anisotropic as synthetic
from npfm.datasets.anisotropic_formulas import Pairs
from npfm.errors import NpfmError
from npfm.reflectance import utia
from npfm.reflectance.directional import UTIA, Directional, directions
from npfm.reflectance.table import INVALID

NAMES = list(synthetic.MATERIALS)
LOBES = (formulas.ggx_lobe, formulas.beckmann_lobe, formulas.ward_lobe)


def lattice(elevations=300, azimuths=360):
    """Directions that share the hemisphere evenly."""
    z, phi = np.meshgrid(
        (np.arange(elevations) + 0.5) / elevations,
        (np.arange(azimuths) + 0.5) / azimuths * 2 * np.pi,
    )
    return directions(np.arccos(z.ravel()), phi.ravel())


def degrees(theta, phi):
    return directions(np.radians(theta), np.radians(phi))


def albedo(brdf, theta, phi, light=None):
    """Reflected share of light from (theta, phi) in degrees."""
    light = lattice() if light is None else light
    view = np.broadcast_to(degrees(theta, phi), light.shape)
    return (brdf(Pairs(light, view)) * light[:, 2]).mean(axis=-1) * 2 * np.pi


@lru_cache
def table(name, seed=0):
    return synthetic.load(name, seed)


def pairs(count=200, seed=4):
    rng = np.random.default_rng(seed)
    theta = np.arccos(rng.random((2, count)))
    phi = rng.random((2, count)) * 2 * np.pi
    return Pairs(*(directions(t, p) for t, p in zip(theta, phi, strict=True)))


def test_there_are_enough_materials_and_each_is_described():
    assert len(NAMES) >= 10
    assert synthetic.materials() == sorted(NAMES)
    assert all(material.description for material in synthetic.MATERIALS.values())


@pytest.mark.parametrize("name", NAMES)
def test_materials_are_reciprocal_and_reflect_less_than_they_receive(name):
    brdf = synthetic.MATERIALS[name].brdf
    some = pairs()
    np.testing.assert_allclose(brdf(some), brdf(Pairs(some.view, some.light)), rtol=1e-9)
    shares = [albedo(brdf, *d) for d in ((1, 0), (45, 0), (45, 60), (45, 90), (75, 30), (85, 100))]
    assert np.min(shares) > 0
    assert np.max(shares) < 1


@pytest.mark.parametrize("lobe", ["ggx_lobe", "beckmann_lobe"])
@pytest.mark.parametrize("alpha", [0.2, 0.6])
def test_as_rough_along_as_across_is_isotropic(lobe, alpha):
    some = pairs()
    cos_h, cos_i, cos_o = some.half[:, 2], some.light[:, 2], some.view[:, 2]
    angles = isotropic.Angles(cos_h, some.cos_d, cos_i, cos_o)
    expected = getattr(isotropic, lobe)(angles, alpha, 0.7)
    found = getattr(formulas, lobe)(some, alpha, alpha, 0.7)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize("lobe", LOBES)
def test_exchanging_roughness_is_a_quarter_of_a_turn(lobe):
    some = pairs()
    np.testing.assert_allclose(
        lobe(some.turned(90), 0.2, 0.5, 1.0), lobe(some, 0.5, 0.2, 1.0), rtol=1e-9
    )


def test_turning_runs_from_x_to_y():
    """A brushing along y is lit along it as one along x is along x."""
    along_x, along_y = (
        Pairs(degrees(40, 0)[None], degrees(10, 180)[None]),
        Pairs(degrees(40, 90)[None], degrees(10, 270)[None]),
    )
    here = formulas.ggx_lobe(along_x, 0.1, 0.5, 1.0)
    assert formulas.ggx_lobe(along_y.turned(90), 0.1, 0.5, 1.0) == pytest.approx(here)
    assert formulas.ggx_lobe(along_y, 0.1, 0.5, 1.0) > 3 * here


@pytest.mark.parametrize("lobe", ["ggx", "beckmann"])
def test_facets_cover_the_surface_and_what_is_seen_of_them_too(lobe):
    """Equations 4 and 3 of Dupuy et al. 2015: the normalisation of D, and Smith's G1."""
    half = lattice(600, 720)
    masking = getattr(isotropic, f"{lobe}_shadowing")
    # With light and view along the half vector, D is all there is but G and the cosines.
    seen = masking(formulas._cosine(half, 0.2, 0.5), 1.0)
    alone = getattr(formulas, f"{lobe}_lobe")(Pairs(half, half), 0.2, 0.5, 1.0)
    density = alone * 4 * half[:, 2] ** 2 / seen**2
    assert (density * half[:, 2]).mean() * 2 * np.pi == pytest.approx(1, abs=2e-3)
    for view in (degrees(30, 0), degrees(60, 0), degrees(60, 70)):
        area = (density * np.maximum(half @ view, 0)).mean() * 2 * np.pi
        assert masking(formulas._cosine(view[None], 0.2, 0.5), 1.0) == pytest.approx(
            view[2] / area, rel=5e-3
        )


def test_wards_albedo_is_bounded_and_nearly_one_head_on():
    head_on = albedo(lambda p: formulas.ward_lobe(p, 0.08, 0.12, 1.0), 5, 20)
    assert head_on == pytest.approx(1, abs=0.03)
    for theta in (60, 80, 88):
        assert albedo(lambda p: formulas.ward_lobe(p, 0.15, 0.5, 1.0), theta, 50) < 1


def test_fibres_send_light_to_a_cone():
    """Brightest where the light is as far from the fibre on one side as the view on the other."""
    tilt = np.radians(12)
    axis = np.array([np.cos(tilt), 0, np.sin(tilt)])
    light = lattice()
    view = np.broadcast_to(degrees(20, 10), light.shape)
    values = formulas.fibre_lobe(Pairs(light, view), tilt, np.radians(3), 1.0)
    on_cone = np.abs(np.arcsin(light @ axis) + np.arcsin(view @ axis)) < np.radians(0.5)
    assert values[on_cone].min() > 0.9 * np.median(values[on_cone])
    assert values[~on_cone].max() <= values[on_cone].max() * 1.01


@pytest.mark.parametrize("name", NAMES)
def test_a_table_is_the_formula_with_noise_and_gaps_at_grazing_angles(name):
    values = table(name).values
    assert values.shape == (3, 6, 48, 6, 48)
    assert np.isfinite(values).all()
    exact = synthetic.tabulate(synthetic.MATERIALS[name], UTIA)
    missing = values == INVALID
    assert not missing[:, :-1].any()
    assert not missing[:, :, :, :-1].any()
    assert missing[:, -1, :, -1].mean() == pytest.approx(synthetic.MISSING, abs=0.02)
    assert np.array_equal(missing[0], missing[1])
    cosines = np.cos(UTIA.theta_i)[:, None, None, None] * np.cos(UTIA.theta_o)[:, None]
    error = np.where(missing, 0, values - exact)
    floor = synthetic.NOISE_FLOOR / cosines
    assert np.all(np.abs(error) < 6 * (synthetic.NOISE * exact + floor))
    assert (error / (synthetic.NOISE * exact + floor)).std() > 0.5


def test_some_measurements_have_negative_values_at_grazing_angles():
    values = table("brushed-steel").values
    negative = (values < 0) & (values != INVALID)
    assert negative[:, -1].mean() > 0.02
    assert negative[:, -1].mean() > 2 * negative[:, 0].mean()


def test_a_table_survives_the_file_format(tmp_path):
    utia.write_bin(tmp_path / "silk.bin", table("shot-silk"))
    again = utia.read_bin(tmp_path / "silk.bin")
    np.testing.assert_array_equal(again.values, table("shot-silk").values)


def test_seed_and_name_decide_the_noise_and_nothing_else():
    first, other = table("satin"), table("twill")
    assert np.array_equal(first.values, synthetic.load("satin", 0).values)
    assert not np.array_equal(first.values, synthetic.load("satin", 1).values)
    assert not np.array_equal(first.valid, other.valid)


def test_a_finer_measurement_has_the_same_values_where_both_are():
    fine = synthetic.tabulate(synthetic.MATERIALS["satin"], Directional(12, 96, 12, 96))
    usual = synthetic.tabulate(synthetic.MATERIALS["satin"], UTIA)
    np.testing.assert_allclose(fine[:, ::2, ::2, ::2, ::2], usual, rtol=1e-12)


def test_an_unknown_material_is_answered_with_the_nearest():
    with pytest.raises(NpfmError, match="material 'brushed-stel'; did you mean brushed-steel"):
        synthetic.load("brushed-stel", 0)


def test_highlights_stretch_across_the_brushing():
    """The half vector may lean ten times as far across it for the same loss."""
    brdf = synthetic.MATERIALS["brushed-steel"].brdf

    def reflected(theta, phi):
        return brdf(Pairs(degrees(theta, phi)[None], degrees(0, 0)[None]))[1, 0]

    assert reflected(30, 90) > 20 * reflected(30, 0)
    assert reflected(30, 90) > 0.5 * reflected(1, 90)


def test_silk_changes_colour_with_the_side_it_is_lit_from():
    brdf = synthetic.MATERIALS["shot-silk"].brdf
    warp, weft = (brdf(Pairs(degrees(50, phi)[None], degrees(0, 0)[None]))[:, 0] for phi in (90, 0))
    assert warp[0] > 2 * warp[2]
    assert weft[2] > 2 * weft[0]


def test_the_albedo_of_satin_depends_on_azimuth():
    brdf = synthetic.MATERIALS["satin"].brdf
    along, across = (
        brdf(Pairs(degrees(60, phi)[None], degrees(0, 0)[None]))[:, 0] for phi in (0, 90)
    )
    assert np.all(across > 1.3 * along)


def test_half_a_turn_does_not_bring_wood_back():
    some = pairs()
    brdf = synthetic.MATERIALS["finished-wood"].brdf
    assert np.abs(np.log(brdf(some.turned(180)) / brdf(some))).max() > 0.5
