"""Measurements of the RGL database, against Mitsuba's own evaluation and formulas."""

import numpy as np
import pytest
from bsdf import fields, of_brdf, tensor_file

from npfm.errors import NpfmError
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.rgl import is_isotropic, read_bsdf, tabulate
from npfm.reflectance.table import INVALID

REAL = ("aurora_white_rgb", "chm_orange_rgb", "ilm_solo_m_68_rgb", "vch_silk_blue_rgb")
#: Azimuths of the light by what they stand for.
AZIMUTHS = {
    "isotropic": (0.0,),
    "isotropic of two": (-np.pi, np.pi),
    "all": np.linspace(-np.pi, np.pi, 5),
    "half": np.linspace(-np.pi, 0, 4),
    "quarter": np.linspace(-np.pi, -np.pi / 2, 3),
}


def directions(rng, n):
    """Unit vectors above the horizon, evenly over the hemisphere."""
    z, phi = rng.uniform(0.02, 1, n), rng.uniform(-np.pi, np.pi, n)
    level = np.sqrt(1 - z**2)
    return np.stack([level * np.cos(phi), level * np.sin(phi), z], axis=-1)


def by_mitsuba(path, light, view):
    """BRDF (3, n) by the plugin ``measured``, which gives f cos(theta_o)."""
    mi = pytest.importorskip("mitsuba", reason="needs pip install npfm[mitsuba]")
    mi.set_variant("scalar_rgb")
    bsdf, context = mi.load_dict({"type": "measured", "filename": str(path)}), mi.BSDFContext()
    found = []
    for i, o in zip(light, view, strict=True):
        at = mi.SurfaceInteraction3f()
        at.wi = i
        found.append(np.array(bsdf.eval(context, at, o)) / o[2])
    return np.array(found).T


def saved(folder, arrays):
    path = folder / "made.bsdf"
    path.write_bytes(tensor_file(arrays))
    return path


def isotropic(arrays):
    """Fields of a material that neither turning nor mirroring changes."""
    mirrored = {name: a + a[..., ::-1, :] for name, a in arrays.items() if a.ndim > 1}
    turned = {name: mirrored[name] * 0 + mirrored[name][:1] for name in ("vndf", "rgb")}
    return arrays | mirrored | turned | {"sigma": mirrored["sigma"] * 0 + mirrored["sigma"][:1]}


@pytest.mark.parametrize("scaled", [0, 1])
@pytest.mark.parametrize("azimuths", AZIMUTHS)
def test_it_is_evaluated_as_mitsuba_does(tmp_path, azimuths, scaled):
    """Of isotropic materials the plugin leaves open whether they are mirrored."""
    rng = np.random.default_rng(5)
    arrays = fields(rng, phi_i=AZIMUTHS[azimuths], scaled=scaled)
    path = saved(tmp_path, isotropic(arrays) if len(arrays["phi_i"]) < 3 else arrays)
    light, view = directions(rng, 400), directions(rng, 400)
    ours = read_bsdf(path).brdf(light, view)
    np.testing.assert_allclose(ours, by_mitsuba(path, light, view), rtol=2e-4)
    assert is_isotropic(path) == azimuths.startswith("isotropic")


@pytest.mark.parametrize("name", REAL)
def test_the_real_ones_are_evaluated_as_mitsuba_does(data, name):
    path = data / "rgl" / f"{name}.bsdf"
    rng = np.random.default_rng(6)
    light, view = directions(rng, 1500), directions(rng, 1500)
    ours = read_bsdf(path).brdf(light, view)
    known = ours[0] != INVALID
    assert 0.7 < known.mean() < 0.9
    theirs = np.maximum(by_mitsuba(path, light, view), 0)
    mirrored = read_bsdf(path).brdf(light * [1, -1, 1], view * [1, -1, 1])
    nearer = np.where(np.abs(mirrored - theirs) < np.abs(ours - theirs), mirrored, ours)
    np.testing.assert_allclose(nearer[:, known], theirs[:, known], rtol=1e-3, atol=1e-6)
    assert np.median(np.abs(ours - theirs)[:, known] / theirs[:, known].clip(1e-9)) < 1e-5


@pytest.mark.parametrize("name", REAL)
def test_what_the_real_ones_did_not_measure_is_missing(data, name):
    """No light can stand at the horizon, and the last light of these files stood at 80 degrees."""
    measured = read_bsdf(data / "rgl" / f"{name}.bsdf")
    assert 79 < np.degrees(measured.highest) < 81
    table = tabulate(measured, MERL)
    theta_i = np.degrees(np.arccos(np.clip(MERL.cosines[0], -1, 1)))
    assert not table.valid[:, theta_i > 81].any()
    assert not table.valid[:, ~MERL.above_horizon].any()
    near = (np.minimum(*MERL.cosines) > 0.6) & table.valid[0]
    assert near.sum() > 0.97 * (np.minimum(*MERL.cosines) > 0.6).sum()
    assert np.array_equal(table.valid[0], table.valid[1])


def glow(light, view):
    """A BRDF that is not reciprocal: it knows the elevation of the light alone."""
    return np.array([[0.1], [0.2], [0.3]]) + np.array([[0.3], [0.2], [0.1]]) * light[:, 2] ** 2


@pytest.fixture(scope="module")
def glowing(tmp_path_factory):
    return read_bsdf(saved(tmp_path_factory.mktemp("glow"), of_brdf(glow, 19, 129)))


def test_the_light_of_a_table_is_that_of_the_file(glowing):
    grid = HalfDifference(18, 18, 36)
    table = tabulate(glowing, grid)
    cos_i, cos_o = grid.cosines
    known = table.valid[0] & (np.minimum(cos_i, cos_o) > np.cos(np.radians(70)))
    assert known.sum() > 0.9 * (np.minimum(cos_i, cos_o) > np.cos(np.radians(70))).sum()
    wanted = glow(np.stack([cos_i[known]] * 3, axis=-1), None)
    np.testing.assert_allclose(table.values[:, known], wanted, rtol=0.02)


def test_a_directional_table_has_the_pairs_of_its_grid(tmp_path):
    rng = np.random.default_rng(8)
    measured = read_bsdf(saved(tmp_path, fields(rng, phi_i=AZIMUTHS["all"])))
    grid = Directional(3, 8, 4, 6)
    table = tabulate(measured, grid)
    for cell in rng.integers(0, grid.shape, (20, 4)):
        i, p, o, q = cell
        pair = measured.brdf(grid.light[i, p][None], grid.view[o, q][None])
        np.testing.assert_array_equal(table.values[:, i, p, o, q], pair[:, 0])
    assert table.valid.all()


def test_the_horizon_and_what_lies_below_are_missing(tmp_path):
    measured = read_bsdf(saved(tmp_path, fields(np.random.default_rng(1))))
    up, level, down = np.array([[0.6, 0, 0.8]]), np.array([[1.0, 0, 0]]), np.array([[0.6, 0, -0.8]])
    assert (measured.brdf(up, up) > 0).all()
    for other in (level, down):
        assert (measured.brdf(up, other) == INVALID).all()
        assert (measured.brdf(other, up) == INVALID).all()
    # Of the last degree files have no more than a margin.
    view, light = at(88.9)
    assert (measured.brdf(light, view) > 0).all()
    view, light = at(89.1)
    assert (measured.brdf(light, view) == INVALID).all()
    assert measured.brdf(np.empty((0, 3)), np.empty((0, 3))).shape == (3, 0)


def at(degrees):
    """A light so far from the normal, in degrees, and a view straight down."""
    theta = np.radians(degrees)
    return np.array([[np.sin(theta), 0, np.cos(theta)]]), np.array([[0.0, 0, 1]])


def test_elevations_that_were_not_measured_are_missing(tmp_path):
    arrays = fields(np.random.default_rng(1), elevations=4)
    read = read_bsdf(saved(tmp_path, arrays))
    assert (read.brdf(*at(80)) > 0).all()
    # The elevation at the horizon is that before once more: no light stood there.
    arrays["rgb"][:, -1] = arrays["rgb"][:, -2]
    read = read_bsdf(saved(tmp_path, arrays))
    assert (read.brdf(*at(59.9)) > 0).all()
    assert (read.brdf(*at(60.1)) == INVALID).all()
    # Where the measurement ends before the horizon, or begins after the normal.
    arrays["theta_i"] = np.radians([10, 20, 40, 50]).astype("<f4")
    read = read_bsdf(saved(tmp_path, arrays))
    assert (read.brdf(*at(49.9)) > 0).all()
    assert (read.brdf(*at(50.1)) == INVALID).all()
    assert (read.brdf(*at(9.9)) == INVALID).all()


def test_values_beside_a_node_that_stands_for_none_are_missing(tmp_path):
    arrays = of_brdf(glow, 5, 33)
    arrays["rgb"][..., 16, 4] = 0
    read = read_bsdf(saved(tmp_path, arrays))
    # Row 16 is the azimuth of the light, column 4 a half vector at (4 / 32)^2 of 90 degrees.
    near, far = (np.radians(90 * (column / 32) ** 2) for column in (4.5, 6))
    for theta, missing in ((near, True), (far, False)):
        light, half = np.array([[0.0, 0, 1]]), np.array([[np.sin(theta), 0, np.cos(theta)]])
        view = 2 * half[:, 2:] * half - light
        assert (read.brdf(light, view) == INVALID).all() == missing
    # Where one channel is black it is a measurement.
    arrays = of_brdf(glow, 5, 33)
    arrays["rgb"][:, :, 0] = 0
    found = read_bsdf(saved(tmp_path, arrays)).brdf(*at(30))
    assert found[0] == 0
    assert (found[1:] > 0).all()


def test_colours_outside_of_the_gamut_are_black_not_missing(tmp_path):
    arrays = fields(np.random.default_rng(1))
    arrays["rgb"][:, :, 2] *= -1
    found = read_bsdf(saved(tmp_path, arrays)).brdf(*at(30))
    assert found[2] == 0
    assert (found[:2] > 0).all()


def test_rows_without_density_are_missing_not_nan(tmp_path):
    arrays = fields(np.random.default_rng(1))
    arrays["vndf"][..., 3:8, :] = 0
    rng = np.random.default_rng(2)
    found = read_bsdf(saved(tmp_path, arrays)).brdf(directions(rng, 500), directions(rng, 500))
    assert np.isfinite(found).all()
    assert 0.1 < (found[0] == INVALID).mean() < 0.9


def nan(array):
    array = array.copy()
    array.ravel()[0] = np.nan
    return array


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("rgb", None, "has no field 'rgb'"),
        ("vndf", None, "has no field 'vndf'"),
        ("rgb", lambda a: a.astype("<f4")[0], "'rgb' is 4 x 3 x 9 x 9 of float32"),
        ("rgb", lambda a: a[:, :, :2], "'rgb' is 1 x 4 x 2 x 9 x 9"),
        ("rgb", lambda a: a[:, :3], "'rgb' is 1 x 3 x 3 x 9 x 9"),
        ("vndf", lambda a: a[:, :, :1], "'vndf' is 1 x 4 x 1 x 10"),
        ("vndf", lambda a: a[:, :, :0], "'vndf' is 1 x 4 x 0 x 10"),
        ("ndf", lambda a: a[:, :1], "'ndf' is 4 x 1"),
        ("sigma", lambda a: a.view("<u4"), "'sigma' is 3 x 8 of uint32"),
        ("jacobian", lambda a: a[:0], "'jacobian' is 0 of uint8"),
        ("theta_i", lambda a: a[:0], "does not belong to"),
        ("theta_i", lambda a: a[::-1], "are no ascending angles"),
        ("theta_i", lambda a: a * 2, "are no ascending angles"),
        ("theta_i", lambda a: a - 0.1, "are no ascending angles"),
        ("theta_i", nan, "'theta_i' holds a NaN"),
        ("rgb", nan, "'rgb' holds a NaN"),
        ("vndf", nan, "'vndf' holds a NaN"),
        ("rgb", lambda a: a * 0, "all values are 0"),
        ("vndf", lambda a: a * 0, "'vndf' is 0 for a whole direction of the light"),
        ("vndf", lambda a: -a, "values that no density has"),
        ("sigma", lambda a: a * 0, "values that no density has"),
        ("ndf", lambda a: -a, "values that no density has"),
    ],
)
def test_what_is_no_measurement_is_told_in_one_line(tmp_path, name, change, said):
    arrays = fields(np.random.default_rng(1))
    if change is None:
        del arrays[name]
    else:
        arrays[name] = change(arrays[name])
    path = saved(tmp_path, arrays)
    with pytest.raises(NpfmError, match=r"made\.bsdf: ") as error:
        read_bsdf(path)
    assert said in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("phi_i", [np.linspace(-3, 3, 5), np.linspace(-np.pi, 1, 5), [1, 2, 3]])
def test_azimuths_that_stand_for_no_symmetry_are_refused(tmp_path, phi_i):
    path = saved(tmp_path, fields(np.random.default_rng(1), phi_i=phi_i))
    with pytest.raises(NpfmError, match=r"'phi_i' goes from .* known are -180 to 180"):
        read_bsdf(path)


def test_spectra_are_refused_by_name(tmp_path):
    arrays = fields(np.random.default_rng(1))
    arrays["spectra"] = arrays.pop("rgb")
    arrays["wavelengths"] = np.array([400, 500, 600], "<f4")
    said = r"made\.bsdf: has spectra, which are not read; take the file .* ends in _rgb\.bsdf"
    for read in (read_bsdf, is_isotropic):
        with pytest.raises(NpfmError, match=said):
            read(saved(tmp_path, arrays))
