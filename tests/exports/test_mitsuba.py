"""Our materials in Mitsuba 3, against our own look-ups, strategies and pictures."""

import os
import subprocess
import sys

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.exports.mitsuba import engine, register
from npfm.reflectance.factored import Angles
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.merl import write_binary
from npfm.reflectance.table import Table
from npfm.rendering.assembly import build
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.shading import Shading
from npfm.rendering.transport import render

mi = pytest.importorskip("mitsuba", reason="needs pip install npfm[mitsuba]")
dr = pytest.importorskip("drjit")

COMPILES = bool(os.environ.get(engine.VARIABLE) or engine.llvm())
VARIANTS = [engine.INTERPRETED, *([engine.COMPILED, "llvm_ad_mono"] if COMPILES else [])]
#: The fastest that this machine has.
FASTEST = engine.COMPILED if COMPILES else engine.INTERPRETED
LIGHT = Environment(np.ones((4, 8, 3)))


@pytest.fixture(params=VARIANTS)
def variant(request):
    register(request.param)
    return request.param


def glossy():
    """A lobe of 0.15 rad, of another colour at grazing light, on a base."""
    h, d, p = np.meshgrid(MERL.theta_h, MERL.theta_d, MERL.phi_d, indexing="ij")
    lobe = np.exp(-((h / 0.15) ** 2)) * (1 + 0.3 * np.cos(2 * p))
    fresnel = np.array([0.3, 0.1, 0.05])[:, None, None, None] + (1 - np.cos(d)) ** 5
    return Table(0.05 + 4 * fresnel * lobe)


def hemisphere(rng, count):
    z = np.sqrt(rng.random(count))
    phi, level = rng.uniform(-np.pi, np.pi, count), np.sqrt(1 - z**2)
    return np.stack([level * np.cos(phi), level * np.sin(phi), z], axis=-1)


def pairs(count=300):
    """Views and lights: half of them near the mirror direction, down to thousandths of a degree."""
    rng = np.random.default_rng(7)
    view, light = hemisphere(rng, count), hemisphere(rng, count)
    near = view[::2] * [-1, -1, 1] + 10 ** rng.uniform(-4, -1, (count // 2, 1)) * rng.normal(
        size=(count // 2, 3)
    )
    light[::2] = near / np.linalg.norm(near, axis=1, keepdims=True)
    above = light[:, 2] > 0.01
    return view[above].astype(np.float32), light[above].astype(np.float32)


def each(function, *arguments):
    """A function of Mitsuba's vectors and numbers, at arrays of them: (n,) or (n, channels)."""
    kinds = {1: mi.Float, 2: mi.Point2f, 3: mi.Vector3f}
    arguments = [np.asarray(a, dtype=np.float32).reshape(len(a), -1) for a in arguments]
    if dr.is_jit_v(mi.Float):
        made = [kinds[a.shape[1]](np.ascontiguousarray(a.T).squeeze()) for a in arguments]
        return np.array(function(*made), dtype=float).T
    rows = zip(*(a.tolist() for a in arguments), strict=True)
    return np.array([np.array(function(*(kinds[len(a)](*a) for a in row))) for row in rows])


def twins(table):
    """Each strategy that Mitsuba runs, with what runs it."""
    from npfm.exports.mitsuba import plugin, samplers

    D = np.exp(-((MERL.theta_h / 0.15) ** 2)) + 1e-3
    parameters = {name: [{"D": D[None]}] for name in samplers.TWINS}
    parameters["factored"] = [factors(kind) for kind in ((1, 1), (1, 0), (0, 1))]
    lobes = {"n": [[6.0, 150]], "rho_d": [0.05], "rho_s": [[0.1, 0.5]]}
    parameters["lafortune"] = [lobes | {"C_xy": [[-0.9, -1.02]], "C_z": [[0.95, 0.9]]}]
    parameters["blinn-phong"] = [lobes | {"F_0": [[0.1, 0.9]]}]
    for name, fits in parameters.items():
        for arrays in fits:
            given = Given(
                plugin.ANY_LIGHT, MERL, table, {k: np.array(v) for k, v in arrays.items()}
            )
            [strategy] = registry.make([name], given)
            yield name, strategy, samplers.twin(name, strategy, 0.0)


def factors(kind):
    """Factors of three terms, none of them like another, by the half vector or by the light."""
    rng, n, m = np.random.default_rng(11), 80, 36
    place, turn = np.arange(n) / n, np.cos((np.arange(m) + 0.5) / m * 2 * np.pi)
    u = np.exp(-((place - np.array([0.0, 0.2, 0.3])[:, None, None]) ** 2) / 0.01)[None]
    v = 1 + np.array([0.0, 0.6, -0.6])[:, None, None] * turn[None, None]
    view, tints = rng.random((1, 3, 5, 1)), (np.ones((3, 5, 1)), np.ones((3, n)), np.ones((3, m)))
    names = ("kind", "F_o", "u", "v", "rho_d", "rho_s", "tint_o", "tint_u", "tint_v")
    u = u * Angles(*map(bool, kind), (5, 1, n, m)).bands
    u = u / u.sum(-1, keepdims=True)
    arrays = ([kind], view, u, v[None], np.full(3, 0.1), np.full(3, 0.6), *tints)
    return dict(zip(names, arrays, strict=True))


def test_a_table_is_looked_up_as_we_do_it(variant):
    from npfm.exports.mitsuba.reflectance import Reflectance

    table = Table(np.random.default_rng(3).uniform(0.1, 1, (3, *MERL.shape)))
    view, light = pairs()
    found = each(Reflectance(table).brdf, view, light).reshape(len(view), -1)
    expected = table.lookup(light.astype(float), view.astype(float)).T
    if "mono" in variant:
        expected = expected @ [[0.2126], [0.7152], [0.0722]]
    # In float32 a few fall on the other side of the edge of a cell.
    assert np.isclose(found, expected, rtol=1e-5).all(axis=1).mean() > 0.95


def test_strategies_have_the_same_density_and_the_same_samples(variant):
    view, light = pairs(200)
    at = Shading(normal=np.tile([0.0, 0, 1], (len(view), 1)), view=view.astype(float))
    u = np.random.default_rng(4).random((len(view), 2)).astype(np.float32)
    for name, strategy, twin in twins(glossy()):
        density = strategy.pdf(light[:, None].astype(float), at)[:, 0]
        found = each(twin.pdf, view, light).ravel()
        assert np.isclose(found, density, rtol=2e-3).mean() > 0.98, name
        drawn = each(twin.sample, view, u[:, 1], u)
        expected = strategy.sample(u[:, None].astype(float), at)[:, 0]
        # The cosine and frames of lobes have the unit square another way round.
        if name in ("normal-distribution", "per-view", "factored"):
            assert (np.abs(drawn - expected).max(axis=1) < 1e-3).mean() > 0.98, name
        else:
            own = each(twin.pdf, view, drawn).ravel() > 0
            assert (own == (drawn[:, 2] > 0)).all(), name


@pytest.mark.parametrize("theta_o", [0.0, 30.0, 80.0])
def test_samples_follow_the_density_by_chi_square(theta_o, monkeypatch):
    if not COMPILES:
        return  # mi.chi2 is for compiled variants; the test before has the samples themselves.
    register(engine.COMPILED)
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    from npfm.exports.mitsuba import plugin, samplers

    # Of a material that reflects to everywhere: samples without light are not counted.
    bright = Table(np.ones((3, *MERL.shape)))
    level = float(np.sin(np.radians(theta_o)))
    wi = [0.6 * level, 0.8 * level, float(np.cos(np.radians(theta_o)))]
    for name, strategy, _ in twins(glossy()):
        chosen = samplers.twin(name, strategy, 0.05)
        mi.register_bsdf("probe", lambda _, chosen=chosen: plugin.bsdf(bright, chosen))
        functions = BSDFAdapter("probe", "", wi=wi)
        test = ChiSquareTest(SphericalDomain(), *functions, sample_dim=3, ires=64, res=61)
        assert test.run(test_count=27, quiet=True), (name, test.messages)


def test_a_white_furnace_stays_white(variant):
    from npfm.exports.mitsuba import plugin

    white = Table(np.full((3, *MERL.shape), 1 / np.pi))
    u = np.random.default_rng(5).random((4000, 3))
    for name in ("cosine", "per-view"):
        bsdf = plugin.bsdf(white, plugin.sampler(white, name))

        def reflected(view, choice, point, bsdf=bsdf):
            si = dr.zeros(mi.SurfaceInteraction3f)
            si.wi = view
            return bsdf.sample(mi.BSDFContext(), si, choice, point, True)[1]

        for theta in (0.0, 50.0, 85.0):
            view = [[np.sin(np.radians(theta)), 0, np.cos(np.radians(theta))]] * len(u)
            albedo = each(reflected, view, u[:, 0], u[:, 1:]).mean()
            assert albedo == pytest.approx(1, abs=0.002), (name, theta)


def test_nothing_is_reflected_below_the_horizon(variant):
    from npfm.exports.mitsuba import plugin

    table = glossy()
    bsdf = plugin.bsdf(table, plugin.sampler(table, "cosine"))
    si = dr.zeros(mi.SurfaceInteraction3f)
    for view, light in ((0.6, -0.6), (-0.6, 0.6), (-0.6, -0.6)):
        si.wi = mi.Vector3f(0.8, 0, view)
        value, density = bsdf.eval_pdf(mi.BSDFContext(), si, mi.Vector3f(0, 0.8, light), True)
        assert not np.any(np.array(value)) and not np.any(np.array(density))


def smooth(direction):
    x, y, z = np.moveaxis(direction, -1, 0)
    warm = np.exp(12 * (0.48 * x + 0.6 * y + 0.64 * z - 1))
    return np.stack([0.2 + 3 * warm, 0.2 + 0.1 * y + 2 * warm, 0.3 + warm], axis=-1)


def test_direct_light_is_that_of_our_pictures():
    """T @ table, against paths of one reflection through the same points of the pixels."""
    from npfm.rendering.lights.environment import tabulate

    register(FASTEST)
    from npfm.exports.mitsuba import plugin, shapes

    scene, table = Scene(("figure", "sphere"), ("visibility", "antialiasing")), glossy()
    light, size = Environment(tabulate(smooth, 64, 2)), 14
    bsdf = plugin.bsdf(table, plugin.sampler(table))
    objects = {f"o{k}": shapes.shape(item, bsdf) for k, item in enumerate(place(scene))}
    world = mi.load_dict({"type": "scene", "light": shapes.light(light), **objects})
    path = mi.load_dict({"type": "path", "max_depth": 2})
    numbers = mi.load_dict({"type": "independent"})
    matrix = build(scene, light, MERL, size, 4096, 1)
    seen = np.flatnonzero(matrix.foreground)
    rays = CAMERA.directions(seen, camera_offsets(scene), size)
    trials = np.tile(rays.reshape(-1, 3), (40 if COMPILES else 2, 1))

    def radiance(direction):
        ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(0, 0, CAMERA.distance), direction))
        return path.sample(world, numbers, ray, None, True)[0]

    numbers.seed(5, len(trials) if COMPILES else 1)
    found = each(radiance, trials).reshape(-1, len(seen), rays.shape[1], 3)
    mean, trials = found.mean(axis=(0, 2)), len(found) * rays.shape[1]
    error = found.std(axis=(0, 2)) / np.sqrt(trials)
    picture = render(matrix, table)[..., :3].reshape(-1, 3)[seen]
    assert len(seen) > 30
    assert (np.abs(picture - mean) <= 3 * error + 0.01 * mean).mean() > 0.95
    noise = np.sqrt(np.mean(error**2) / len(seen)) / mean.mean()
    assert picture.mean() / mean.mean() == pytest.approx(1, abs=0.004 + 3 * noise)


def bounced(table, sampler=None, objects=("figure", "sphere"), paths=64, seed=1):
    from npfm.exports.mitsuba import interreflection, plugin

    chosen = plugin.sampler(table, sampler or "cosine")
    light = Environment(np.ones((8, 16, 3)))
    paths = paths if COMPILES else 4
    return interreflection.bounced(Scene(objects), light, table, chosen, 16, paths, seed)


def test_white_objects_in_an_even_light_vanish_when_light_bounces():
    register(FASTEST)
    white = Table(np.full((3, *MERL.shape), 1 / np.pi))
    scene, light = Scene(("figure", "sphere"), ("visibility",)), Environment(np.ones((8, 16, 3)))
    matrix = build(scene, light, MERL, 16, 256, 1)
    direct = render(matrix, white)[..., :3]
    found = bounced(white)
    assert direct[matrix.foreground].mean() < 0.95
    both = (direct + found.radiance)[matrix.foreground]
    noise = np.sqrt(np.mean(found.error[matrix.foreground] ** 2) / len(both))
    assert both.mean() == pytest.approx(1, abs=0.003 + 3 * noise)
    assert not found.radiance[matrix.coverage == 0].any()


def test_light_does_not_bounce_off_what_is_convex():
    register(FASTEST)
    assert not bounced(glossy(), objects=("sphere",)).radiance.any()


def test_paths_depend_on_the_seed_and_on_the_material_that_they_are_sampled_by():
    register(FASTEST)
    table = glossy()
    first = bounced(table).radiance
    np.testing.assert_array_equal(first, bounced(table).radiance)
    np.testing.assert_array_equal(first, bounced(Table(table.values.copy())).radiance)
    assert (first != bounced(table, seed=2).radiance).any()
    brighter = bounced(Table(2 * table.values)).radiance
    # At least two reflections, at most eight: 4 to 256 times as much.
    assert 4 < brighter.sum() / first.sum() < 64


def test_a_scene_names_files(variant, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_binary(tmp_path / "gloss.binary", glossy())
    wi = mi.Vector3f(0.0, 0.6, 0.8)
    for extra in ({}, {"sampling": "cosine"}, {"cosine": 0.5}):
        bsdf = mi.load_dict({"type": "npfm", "filename": "gloss.binary", **extra})
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi = wi
        value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(0.0, -0.6, 0.8))
        assert np.array(value).max() > 0
    for extra, said in (
        ({"sampling": "mirror"}, "no sampler 'mirror'"),
        ({"sampling": "normal-distribution"}, "needs the parameters of a material"),
        ({"filename": "none.binary"}, "none.binary"),
        ({"cosine": 1.5}, "a share"),
    ):
        with pytest.raises(Exception, match=said):
            mi.load_dict({"type": "npfm", "filename": "gloss.binary", **extra})


def test_only_tables_by_half_and_difference_angles():
    register(engine.INTERPRETED)
    from npfm.exports.mitsuba.reflectance import Reflectance

    class Other(HalfDifference):
        pass

    Reflectance(Table(np.ones((3, 4, 5, 6)), Other(4, 5, 6)))
    with pytest.raises(NpfmError, match="not on a sheet"):
        Reflectance(Table(np.ones((3, 4, 5, 6)), type("Sheet", (), {"name": "a sheet"})()))


def test_the_newest_library_that_is_known_to_work_is_taken(tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "PLACES", (f"{tmp_path}/libLLVM*.so*",))
    for name in ("libLLVM-15.so.1", "libLLVM.so", "libLLVM-C.so"):
        (tmp_path / name).touch()
    assert engine.llvm() is None
    (tmp_path / "libLLVM.so.19.1").touch()
    (tmp_path / "libLLVM.so.20.1").touch()
    assert engine.llvm() == str(tmp_path / "libLLVM.so.20.1")


@pytest.mark.parametrize("variant", ["scalar_spectral", "none"])
def test_variants_that_tables_are_not_for(variant):
    with pytest.raises(NpfmError, match=r"variant 'none'|no wavelengths") as caught:
        engine.start(variant)
    assert "\n" not in str(caught.value)
    engine.start(engine.INTERPRETED)


WITHOUT = """
import sys
sys.modules["mitsuba"] = None
from npfm.__main__ import main
sys.exit(main(sys.argv[1:]))
"""


def test_without_mitsuba_only_light_that_bounces_is_missing(tmp_path):
    light = f"light --generate grove --height 8 -o {tmp_path}/l.exr"
    scene = f"--light {tmp_path}/l.exr --objects figure --resolution 8"
    table = f"{tmp_path}/chalk.binary"
    said = {}
    for call in (
        f"material --synthetic chalk -o {table}",
        light,
        f"scene {scene} --samples 16 -o {tmp_path}/s",
        f"render {tmp_path}/s {table} -o {tmp_path}/a.exr",
        f"interreflect {table} {scene} -o {tmp_path}/b.exr",
    ):
        words = [sys.executable, "-c", WITHOUT, *call.split()]
        said[call.split()[0]] = subprocess.run(words, capture_output=True, text=True)
    *others, last = said.values()
    assert [run.returncode for run in others] == [0, 0, 0, 0]
    assert last.returncode == 1 and last.stderr.count("\n") == 1
    assert "pip install 'npfm[mitsuba]'" in last.stderr


def test_a_picture_with_light_that_bounces_is_the_sum(tmp_path, capsys):
    from npfm.storage.pictures import read_exr

    scene = f"--light {tmp_path}/l.exr --objects figure --resolution 8"
    table = f"{tmp_path}/chalk.binary"
    for call in (
        f"material --synthetic chalk -o {table}",
        f"light --generate grove --height 8 -o {tmp_path}/l.exr",
        f"scene {scene} --samples 16 -o {tmp_path}/s",
        f"interreflect {table} {scene} --paths 2 -o {tmp_path}/b.exr",
        f"render {tmp_path}/s {table} -o {tmp_path}/direct.exr",
        f"render {tmp_path}/s {table} --bounced {tmp_path}/b.exr -o {tmp_path}/a.exr",
    ):
        assert main(call.split()) == 0, call
    direct, both, light = (read_exr(tmp_path / f"{name}.exr") for name in ("direct", "a", "b"))
    assert light.any()
    np.testing.assert_allclose(both[..., :3], direct[..., :3] + light, rtol=1e-6)
    np.testing.assert_array_equal(both[..., 3], direct[..., 3])
    capsys.readouterr()
    call = f"scene {scene} --samples 16 --effects interreflection -o {tmp_path}/t"
    assert main(call.split()) == 1
    assert "no part of a matrix" in capsys.readouterr().err
    small = f"interreflect {table} {scene[:-1]}4 --paths 2 -o {tmp_path}/small.exr"
    assert main(small.split()) == 0
    call = f"render {tmp_path}/s {table} --bounced {tmp_path}/small.exr -o {tmp_path}/x.exr"
    assert main(call.split()) == 1
    assert "4 x 4 pixels, and the scene has 8 x 8" in capsys.readouterr().err
