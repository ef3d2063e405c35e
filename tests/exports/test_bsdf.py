"""Measured materials, as the real Mitsuba reads them, against our tables and pictures."""

import contextlib
import io
import os

import numpy as np
import pytest
from glossy import glossy

from npfm.__main__ import main
from npfm.exports import bsdf, bsdf_spectral
from npfm.exports.mitsuba import engine
from npfm.reflectance.angles import directions
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import write_binary
from npfm.reflectance.rgl import read_bsdf
from npfm.reflectance.rgl import tabulate as tabulate_rgl
from npfm.reflectance.table import Table
from npfm.reflectance.warps import Warp, between, forward
from npfm.rendering.assembly import build
from npfm.rendering.lights.environment import Environment, tabulate
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.transport import render

mi = pytest.importorskip("mitsuba", reason="needs pip install npfm[mitsuba]")
dr = pytest.importorskip("drjit")
if not (os.environ.get(engine.VARIABLE) or engine.llvm()):
    pytest.skip("Mitsuba evaluates many directions only with LLVM", allow_module_level=True)


@pytest.fixture(autouse=True)
def variant():
    engine.start(engine.COMPILED)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A function that returns the path of a table and that of its material."""
    folder = tmp_path_factory.mktemp("bsdf")

    def write(name, table, *options):
        table_path, path = folder / f"{name}.binary", folder / f"{name}.bsdf"
        if not path.exists():
            write_binary(table_path, table)
            call = ["export", table_path, "--to", "bsdf", "-o", path, *options]
            assert main(list(map(str, call))) == 0
        return path

    return write


def fields(path):
    from mitsuba.python import tensor_io

    with contextlib.redirect_stdout(io.StringIO()):
        return tensor_io.read(str(path))


def material(path):
    return mi.load_dict({"type": "measured", "filename": str(path)})


def seen(view, count):
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.Vector3f(*np.atleast_2d(view).T.astype(np.float32))
    return si


def errors(path, table, most=80):
    """Relative errors at centres of cells with both directions within so many degrees."""
    rng = np.random.default_rng(1)
    h, d, p = (rng.integers(0, n, 60_000) for n in MERL.shape)
    light, view = directions(MERL.theta_h[h], MERL.theta_d[d], MERL.phi_d[p])
    within = np.minimum(light[:, 2], view[:, 2]) > np.cos(np.radians(most))
    light, view = light[within], view[within]
    toward = mi.Vector3f(*light.T.astype(np.float32))
    found = np.array(material(path).eval(mi.BSDFContext(), seen(view, len(view)), toward))
    expected = table.values[:, h[within], d[within], p[within]]
    return np.abs(found / light[:, 2] / expected - 1)


def weights(path, theta, count=40_000):
    """Weights of samples of a view, in green: their mean is the directional albedo."""
    u = np.random.default_rng(2).random((3, count)).astype(np.float32)
    view = [np.sin(np.radians(theta)), 0, np.cos(np.radians(theta))]
    found = material(path).sample(
        mi.BSDFContext(), seen(view, count), mi.Float(u[0]), mi.Point2f(*u[1:])
    )
    return np.array(found[1])[1]


def albedo(table, theta, steps=400):
    """Directional albedo in green by quadrature of the table."""
    z, phi = (np.arange(steps) + 0.5) / steps, (np.arange(2 * steps) + 0.5) / steps * np.pi
    z, phi = (x.ravel() for x in np.meshgrid(z, phi))
    level = np.sqrt(1 - z**2)
    light = np.stack([level * np.cos(phi), level * np.sin(phi), z], axis=-1)
    view = np.array([[np.sin(np.radians(theta)), 0, np.cos(np.radians(theta))]])
    return 2 * np.pi * np.mean(table.lookup(light, np.repeat(view, len(light), 0))[1] * z)


def test_the_warp_is_that_of_mitsuba():
    density = np.random.default_rng(3).random((7, 9)) ** 4
    density[2, 3:5] = density[4, :2] = 0
    places, found = forward(density, 12)
    theirs = mi.MarginalContinuous2D0(density.astype(np.float32))
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(0, 1, 12)]))
    at, value = theirs.sample(mi.Point2f(*np.stack([x, y]).astype(np.float32)))
    inside = (x > 0) & (x < 1) & (y > 0) & (y < 1)
    np.testing.assert_allclose(places.reshape(-1, 2)[inside], np.array(at).T[inside], atol=2e-5)
    np.testing.assert_allclose(found.ravel()[inside], np.array(value)[inside], rtol=5e-3, atol=1e-3)


def test_the_warp_goes_back_by_its_inverse():
    density = np.random.default_rng(3).random((7, 9)) ** 4
    places, _ = forward(density, 12)
    x, y = places.reshape(-1, 2).T
    back = Warp.of(density[None]).inverse(between(np.zeros(1), x), x, y)
    expected = np.meshgrid(*2 * [np.linspace(0, 1, 12)])
    np.testing.assert_allclose(back, [a.ravel() for a in expected], atol=1e-9)


def test_our_own_reader_finds_the_table_again(written):
    table = glossy()
    found = tabulate_rgl(read_bsdf(written("glossy", table)), MERL)
    within = np.minimum(*MERL.cosines) > np.cos(np.radians(80))
    errors = np.abs(found.values[:, within] / table.values[:, within] - 1)
    assert found.valid[:, within].all()
    assert np.median(errors) < 0.005 and np.percentile(errors, 90) < 0.04


def test_the_file_has_the_fields_of_a_measured_one(written, data):
    ours = fields(written("glossy", glossy()))
    theirs = fields(data / "rgl" / "vch_silk_blue_rgb.bsdf")
    for name, array in ours.items():
        assert array.dtype == theirs[name].dtype and array.ndim == theirs[name].ndim, name
    assert set(theirs) - set(ours) == {"version", "valid"}  # which no reader asks for
    assert b"glossy" in ours["description"].tobytes()
    assert ours["rgb"].shape == (1, bsdf.VIEWS, 3, bsdf.SIZE, bsdf.SIZE)


def test_mitsuba_finds_the_values_of_the_table(written):
    table = glossy()
    found = errors(written("glossy", table), table)
    assert np.median(found) < 0.004 and np.percentile(found, 90) < 0.04
    small = written("small", table, "--views", "8", "--size", "32")
    coarse = errors(small, table)
    assert np.median(found) < np.median(coarse) < 0.015
    assert small.stat().st_size < 300_000


def test_a_narrow_lobe_keeps_its_highlight(written):
    table = glossy(0.03)
    found = errors(written("narrow", table), table)
    assert np.median(found) < 0.004 and np.percentile(found, 90) < 0.06


@pytest.mark.parametrize("theta", [0.0, 40.0, 75.0])
def test_a_furnace_reflects_what_ours_does_and_without_noise(written, theta):
    table = glossy()
    found = weights(written("glossy", table), theta)
    assert found.mean() == pytest.approx(albedo(table, theta), rel=0.02)
    # By the cosine alone it is 0.2 to 1.5.
    assert found.std() < 0.12 * found.mean()


def test_white_is_white(written):
    white = Table(np.where(MERL.above_horizon, 1 / np.pi, -1) * np.ones((3, 1, 1, 1)))
    for theta in (0.0, 60.0, 85.0):
        assert weights(written("white", white), theta).mean() == pytest.approx(1, abs=0.005)


def test_a_black_material_is_black(written):
    black = Table(np.where(MERL.above_horizon, 0.0, -1) * np.ones((3, 1, 1, 1)))
    path = written("black", black)
    assert np.isfinite(fields(path)["luminance"]).all()
    assert not weights(path, 30.0).any()


def seen_colours(spectra, wavelengths):
    """Linear sRGB (n, 3) in D65 of spectra (n, w)."""
    cie = np.array(mi.cie1931_xyz(mi.Float(*wavelengths.astype(np.float32)[None])))
    lit = cie.reshape(3, -1) * np.array(mi.cie_d65(mi.Float(*wavelengths.astype(np.float32)[None])))
    to_srgb = np.array(mi.xyz_to_srgb(mi.Color3f([1, 0, 0], [0, 1, 0], [0, 0, 1])))
    return spectra @ (lit / lit[1].sum()).T @ to_srgb.T


def test_spectra_have_the_colours_of_the_table(tmp_path):
    table = glossy()
    write_binary(tmp_path / "a.binary", table)
    path = tmp_path / "a.bsdf"
    assert main(["export", f"{tmp_path}/a.binary", "--to", "bsdf-spectral", "-o", str(path)]) == 0
    mi.set_variant("llvm_ad_spectral")
    made, wavelengths = material(path), np.arange(360, 831, 5.0)
    rng = np.random.default_rng(6)
    light, view = directions(*(rng.uniform(0.05, x, 40) for x in (0.6, 0.6, 3.1)))
    found = []
    for wavelength in wavelengths:
        si = seen(view, len(view))
        si.wavelengths = mi.Spectrum(float(wavelength))
        toward = mi.Vector3f(*light.T.astype(np.float32))
        found.append(np.array(made.eval(mi.BSDFContext(), si, toward))[0])
    colours = seen_colours(np.array(found).T, wavelengths) / light[:, 2:]
    expected = table.lookup(light, view).T
    assert np.median(np.abs(colours / expected - 1)) < 0.02
    assert (np.abs(colours / expected - 1) < 0.15).all()
    white = seen_colours(np.ones((1, wavelengths.size)), wavelengths)
    np.testing.assert_allclose(white, 1, rtol=2e-3)


def test_primaries_are_red_green_and_blue():
    mi.set_variant("llvm_ad_spectral")
    wavelengths = np.arange(360, 831, 1.0)
    primaries = bsdf_spectral.PRIMARIES
    curves = [np.interp(wavelengths, bsdf_spectral.WAVELENGTHS, curve) for curve in primaries]
    np.testing.assert_allclose(seen_colours(np.stack(curves), wavelengths), np.eye(3), atol=2e-3)
    assert (primaries >= -1e-12).all() and (primaries <= 1).all()
    np.testing.assert_allclose(primaries.sum(axis=0), 1)


def smooth(direction):
    x, y, z = np.moveaxis(direction, -1, 0)
    warm = np.exp(12 * (0.48 * x + 0.6 * y + 0.64 * z - 1))
    return np.stack([0.2 + 3 * warm, 0.2 + 0.1 * y + 2 * warm, 0.3 + warm], axis=-1)


def test_a_sphere_looks_as_ours(written):
    from npfm.exports.mitsuba import shapes

    table, scene, size = glossy(), Scene(("sphere",), ()), 20
    light = Environment(tabulate(smooth, 64, 2))
    matrix = build(scene, light, MERL, size, 4096, 1)
    picture = render(matrix, table)[..., :3].reshape(-1, 3)
    [ball] = place(scene)
    made = shapes.shape(ball, material(written("glossy", table)))
    world = mi.load_dict({"type": "scene", "light": shapes.light(light), "ball": made})
    path = mi.load_dict({"type": "path", "max_depth": 2})
    numbers = mi.load_dict({"type": "independent"})
    pixels = np.flatnonzero(matrix.foreground)
    rays = CAMERA.directions(pixels, camera_offsets(scene), size)[:, 0]
    trials = np.repeat(rays, 3000, axis=0)
    numbers.seed(5, len(trials))
    origin = mi.Point3f(0, 0, CAMERA.distance)
    ray = mi.RayDifferential3f(mi.Ray3f(origin, mi.Vector3f(*trials.T.astype(np.float32))))
    found = np.array(path.sample(world, numbers, ray, None, True)[0]).T
    mean = found.reshape(len(pixels), -1, 3).mean(axis=1)
    differences = np.abs(mean / picture[pixels] - 1)
    assert np.median(differences) < 0.01 and np.percentile(differences, 90) < 0.04
    assert mean.mean() / picture[pixels].mean() == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("setting", [("--views", "3"), ("--size", "1000")])
def test_sizes_beyond_sense_are_refused(tmp_path, capsys, setting):
    write_binary(tmp_path / "a.binary", glossy())
    call = ["export", f"{tmp_path}/a.binary", "--to", "bsdf", "-o", f"{tmp_path}/a.bsdf", *setting]
    assert main(call) == 1
    assert "give a number from 4" in capsys.readouterr().err
    assert not (tmp_path / "a.bsdf").exists()


def test_a_file_of_another_program_is_left_alone(tmp_path, data, capsys):
    theirs = data / "rgl" / "vch_silk_blue_rgb.bsdf"
    assert not bsdf.KIND.ours(theirs)
