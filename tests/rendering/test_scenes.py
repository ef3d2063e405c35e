import subprocess
import sys
from collections import Counter

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.reflectance.half_difference import HalfDifference
from npfm.rendering import assembly
from npfm.rendering.effects import EFFECTS, Effect, subdivide, unshadowed
from npfm.rendering.geometry import Sphere
from npfm.rendering.lights.environment import Environment, write
from npfm.rendering.scenes import CAMERA, Scene, place
from npfm.rendering.surfaces import look, towards

SCENES = [("sphere",), ("figure",), ("figure", "sphere"), ("cloth",)]
LIGHT = Environment(np.ones((4, 8, 3)))
CENTRE = np.array([[0.5, 0.5]])


@pytest.mark.parametrize(
    ("objects", "effects", "complaint"),
    [
        (("cube",), (), "unknown object 'cube'"),
        ((), (), "needs one or more"),
        (("sphere", "sphere"), (), "needs one or more"),
        (("sphere",), ("fog",), "unknown effect 'fog' in a scene; choose from antialiasing"),
        (("sphere",), ("visibility", "visibility"), "lists an effect twice"),
    ],
)
def test_a_wrong_scene_is_refused_in_one_line(objects, effects, complaint):
    with pytest.raises(NpfmError, match=complaint) as caught:
        Scene(objects, effects)
    assert "\n" not in str(caught.value)


def test_a_missing_mesh_is_named(tmp_path):
    with pytest.raises(NpfmError, match=r"absent\.ply"):
        place(Scene(("figure",), mesh=tmp_path / "absent.ply"))


@pytest.mark.parametrize("objects", SCENES)
def test_objects_fill_the_picture_and_are_not_cut_off(objects):
    _, coverage, _ = look(CAMERA, place(Scene(objects)), LIGHT, CENTRE, 64)
    rows, columns = np.nonzero(coverage)
    assert min(rows.min(), columns.min(), 63 - rows.max(), 63 - columns.max()) >= 2
    assert rows.max() - rows.min() > 48
    assert coverage.mean() > 0.15


def test_the_sphere_stands_right_of_the_figure_and_does_not_touch_it():
    figure, sphere = place(Scene(("figure", "sphere")))
    assert figure.vertices[:, 0].max() < sphere.centre[0] - sphere.radius
    assert sphere.centre[1] - sphere.radius == pytest.approx(figure.vertices[:, 1].min())


def test_the_cloth_hangs_behind_the_others():
    figure, sphere, cloth = place(Scene(("cloth", "sphere", "figure")))
    assert cloth.vertices[:, 2].max() < min(figure.vertices[:, 2].min(), sphere.centre[2] - 0.42)
    ball, behind = place(Scene(("sphere", "cloth")))
    assert behind.vertices[:, 2].max() < ball.centre[2] - ball.radius
    _, coverage, _ = look(CAMERA, (ball, behind), LIGHT, CENTRE, 32)
    assert coverage.all()


def test_the_cloth_is_not_convex_and_may_shade_itself():
    assert Scene(("cloth",), ("visibility",)).simulated == ("visibility",)


def test_a_mesh_of_the_users_takes_the_place_of_the_figure(data):
    figure, _ = place(Scene(("figure", "sphere"), mesh=data / "meshes" / "happy_vrip_res4.ply"))
    own, _ = place(Scene(("figure", "sphere")))
    assert len(figure.vertices) != len(own.vertices)
    np.testing.assert_allclose(np.ptp(figure.vertices[:, 1]), 2.0)


def test_subdivide_gives_sixteen_even_points():
    points = subdivide(CENTRE)
    assert points.shape == (16, 2)
    np.testing.assert_allclose(np.unique(points[:, 0]), [0.125, 0.375, 0.625, 0.875])
    assert len({tuple(point) for point in points}) == 16


def test_unshadowed_sees_the_other_object_only_where_it_stands():
    objects = (Sphere((0, 0, 0), 1), Sphere((3, 0, 0), 1))
    points = np.array([[1.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    lights = np.array([[1.0, 0, 0], [0.6, 0.8, 0], [0, 1, 0]])
    np.testing.assert_array_equal(unshadowed(objects, points, points, lights), [False, True, True])


def test_every_effect_changes_something():
    for effect in EFFECTS.values():
        assert effect.film or effect.reaches or effect.bounces


def test_partly_covered_pixels_share_their_light():
    surface, coverage, backdrop = look(
        CAMERA, place(Scene(("sphere",))), LIGHT, subdivide(CENTRE), 16
    )
    np.testing.assert_allclose(coverage[..., None] + backdrop, 1)
    assert set(np.unique(coverage * 16) % 1) == {0}
    assert ((coverage > 0) & (coverage < 1)).sum() > 10
    np.testing.assert_allclose(
        np.bincount(surface.pixel, minlength=256).reshape(16, 16) / 16, coverage
    )
    assert (np.diff(surface.pixel) >= 0).all()


def test_normals_are_turned_to_the_viewer_as_little_as_needed():
    rng = np.random.default_rng(0)
    normal, view = rng.normal(size=(2, 500, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    view /= np.linalg.norm(view, axis=1, keepdims=True)
    turned = towards(normal, view, 0.02)
    cosine = np.einsum("ij,ij->i", normal, view)
    np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 1)
    np.testing.assert_allclose(
        np.einsum("ij,ij->i", turned, view), np.maximum(cosine, 0.02), atol=1e-12
    )
    np.testing.assert_array_equal(turned[cosine > 0.02], normal[cosine > 0.02])
    # In the plane of normal and view: the three span no volume.
    volume = np.einsum("ij,ij->i", np.cross(normal, view), turned)
    np.testing.assert_allclose(volume, 0, atol=1e-12)


BLOCKED = """
import sys
for name in ("embreex", "trimesh"):
    sys.modules[name] = None
import numpy as np
from npfm.__main__ import main
from npfm.rendering.assembly import build
from npfm.reflectance.half_difference import HalfDifference
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene
light = Environment(np.ones((4, 8, 3)))
options = "--objects sphere --resolution 4 --samples 4"
assert main(f"scene --light {sys.argv[1]} {options} -o {sys.argv[2]}".split()) == 0
grid = HalfDifference(9, 9, 18)
for effects in ((), ("antialiasing",), ("visibility", "antialiasing")):
    assert build(Scene(("sphere",), effects), light, grid, 8, 32, 0).foreground.any()
"""


def test_sphere_scenes_need_no_ray_library(tmp_path):
    files = str(tmp_path / "light.exr"), str(tmp_path / "scene")
    write(files[0], LIGHT)
    subprocess.run([sys.executable, "-W", "error", "-c", BLOCKED, *files], check=True)


def built(objects, effects, counts=None):
    grid = HalfDifference(9, 9, 18)
    return assembly.build(Scene(objects, effects), LIGHT, grid, 8, 64, 0, counts=counts)


@pytest.mark.parametrize("objects", SCENES)
@pytest.mark.parametrize("effects", [(), ("antialiasing",), ("visibility",)])
def test_a_scene_runs_no_code_of_an_effect_that_it_is_without(objects, effects, monkeypatch):
    def forbidden(*arguments):
        raise AssertionError("an effect ran that the scene does not ask for")

    simulated = Scene(objects, effects).simulated
    for name in set(EFFECTS) - set(simulated):
        effect = EFFECTS[name]
        broken = Effect(effect.film and forbidden, effect.reaches and forbidden)
        monkeypatch.setitem(EFFECTS, name, broken)
    counts = Counter()
    assert built(objects, effects, counts).foreground.any()
    assert (counts["rays"] > 0) == ("visibility" in simulated)


def test_effects_are_composed_in_any_order():
    both = ("visibility", "antialiasing")
    one, other = (built(("figure", "sphere"), names) for names in (both, both[::-1]))
    for name, array in vars(one).items():
        np.testing.assert_array_equal(array, vars(other)[name])


def test_visibility_of_a_lone_sphere_is_refused_with_a_warning_of_one_line(tmp_path, capsys):
    write(tmp_path / "light.exr", LIGHT)
    call = f"scene --light {tmp_path}/light.exr --resolution 4 --samples 64"
    call += f" --effects visibility antialiasing -o {tmp_path}/scene --objects"
    assert main([*call.split(), "sphere"]) == 0
    refused = "effect 'visibility' changes nothing on a lone sphere and is left out"
    warning, _ = capsys.readouterr().err.splitlines()
    assert warning == f"npfm scene: warning: {refused}; take it off the list"
    assert main([*call.split(), "sphere", "figure"]) == 0
    assert "warning" not in capsys.readouterr().err


def test_shadow_rays_are_counted_if_asked_for():
    counts = Counter(rays=5)
    without = built(("figure", "sphere"), ())
    shadowed = built(("figure", "sphere"), ("visibility",), counts)
    # An entry stands for one or more samples, and each sample is asked about once.
    assert counts["rays"] - 5 >= without.indices.size > shadowed.indices.size
    unasked = Counter()
    built(("figure", "sphere"), (), unasked)
    assert not unasked
