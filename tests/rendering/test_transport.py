import tracemalloc

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance.angles import half_difference
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering import assembly
from npfm.rendering.assembly import build
from npfm.rendering.geometry import nearest
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import CAMERA, Scene, place
from npfm.rendering.surfaces import look
from npfm.rendering.transport import load, over_backdrop, reflected, render, save

SPHERE = Scene(("sphere",))
BOTH = Scene(("figure", "sphere"))
WHITE = Environment(np.ones((8, 16, 3)))
SMALL = HalfDifference(18, 18, 36)


def uniform(grid=MERL, value=1 / np.pi):
    return Table(np.full((3, *grid.shape), value), grid)


def glossy(grid=MERL):
    """A lobe of 0.2 rad that depends on all three angles, on a coloured base."""
    theta_h, theta_d, phi_d = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d, indexing="ij")
    lobe = 4 * np.exp(-((theta_h / 0.2) ** 2)) * (1 + 0.5 * np.cos(2 * phi_d)) * (1 + theta_d)
    return Table(np.array([0.3, 0.2, 0.1])[:, None, None, None] + lobe, grid)


def noise_light(rows=8, seed=2):
    return Environment(np.random.default_rng(seed).random((rows, 2 * rows, 3)) ** 3)


def colours(transport, table):
    return render(transport, table)[..., :3]


@pytest.mark.parametrize("objects", [("sphere",), ("figure", "sphere")])
@pytest.mark.parametrize("effects", [(), ("antialiasing",)])
def test_white_furnace(objects, effects):
    transport = build(Scene(objects, effects), WHITE, MERL, 20, 4096, 0)
    values = colours(transport, uniform())[transport.foreground]
    assert len(values) > 50
    assert values.mean() == pytest.approx(1, abs=0.002)
    np.testing.assert_allclose(values, 1, atol=0.01)
    # Little is lost in cells that tables leave empty because their centre is below the horizon.
    table = Table(np.where(MERL.above_horizon, uniform().values, -1))
    left = colours(transport, table)[transport.foreground]
    np.testing.assert_allclose(left, values, rtol=5e-3)
    assert left.mean() > 0.9998 * values.mean()


def test_visibility_changes_nothing_on_a_convex_object():
    light = noise_light()
    free = build(SPHERE, light, SMALL, 16, 512, 3)
    shadowed = build(Scene(("sphere",), ("visibility",)), light, SMALL, 16, 512, 3)
    for name, value in vars(free).items():
        np.testing.assert_array_equal(value, getattr(shadowed, name))


def test_visibility_darkens_the_figure_and_brightens_nothing():
    free = build(BOTH, WHITE, SMALL, 32, 256, 3)
    shadowed = build(Scene(BOTH.objects, ("visibility",)), WHITE, SMALL, 32, 256, 3)
    before, after = (colours(t, uniform(SMALL))[t.foreground] for t in (free, shadowed))
    assert (after <= before * 1.00001).all()
    assert 0.6 < after.mean() < 0.95
    assert after.min() > 0


def test_a_convex_mesh_casts_no_shadow_on_itself(tmp_path):
    import trimesh

    path = tmp_path / "ball.ply"
    trimesh.creation.icosphere(5).export(path)
    scene = Scene(("figure",), ("visibility",), path)
    transport = build(scene, WHITE, SMALL, 32, 512, 0)
    values = colours(transport, uniform(SMALL))[transport.foreground]
    # Light between the horizons of a facet and of the smooth surface is all that may be lost.
    assert values.mean() > 0.99
    assert np.quantile(values, 0.02) > 0.97


def octants(radiance):
    """A light that is constant in each octant: radiance[x > 0, y > 0, z > 0]."""
    radiance = radiance.astype(int) if radiance.dtype == bool else radiance
    z = np.repeat([1, 0, 0, 1], 2)
    x = np.repeat([0, 0, 1, 1], 2)
    upper, lower = (radiance[x, y, z] for y in (1, 0))
    return Environment(np.stack([upper] * 2 + [lower] * 2))


def test_turning_the_light_about_the_view_axis_turns_the_picture():
    radiance = np.random.default_rng(1).random((2, 2, 2, 3))
    pictures = []
    for turned in (radiance, np.rot90(radiance, axes=(0, 1))):
        light = octants(turned)
        corner = np.array([1, 1, -1]) / np.sqrt(3)
        np.testing.assert_array_equal(light.lookup(corner), turned[1, 1, 0])
        transport = build(SPHERE, light, SMALL, 20, 4096, 0)
        pictures.append(colours(transport, glossy(SMALL)))
    # From x towards y in the light is counter-clockwise in the picture.
    first, second = (p[transport.foreground] for p in (np.rot90(pictures[0]), pictures[1]))
    np.testing.assert_allclose(first, second, rtol=0.05)
    assert np.abs(first / second - 1).mean() < 0.01
    assert np.abs(pictures[0] - pictures[1]).max() > 0.3


def test_radially_symmetric_light_gives_a_symmetric_picture():
    radiance = np.zeros((2, 2, 2, 3))
    radiance[..., 0, :], radiance[..., 1, :] = 3.0, 0.5
    transport = build(SPHERE, octants(radiance), SMALL, 20, 4096, 0)
    picture = colours(transport, glossy(SMALL))
    for image in (np.rot90(picture), picture[::-1], picture[:, ::-1]):
        np.testing.assert_allclose(image, picture, rtol=0.05)


def quadrature(point, view, normal, light, table):
    """Radiance of a point by a plain lattice of directions over the whole sphere."""
    rows = 360
    theta = (np.arange(rows) + 0.5) * np.pi / rows
    phi = (np.arange(2 * rows) + 0.5) * np.pi / rows
    total = np.zeros(3)
    for polar in theta:
        x, z = np.sin(polar) * np.cos(phi), np.sin(polar) * np.sin(phi)
        direction = np.stack([x, np.full(2 * rows, np.cos(polar)), z], axis=-1)
        cosine = direction @ normal
        direction, cosine = direction[cosine > 0], cosine[cosine > 0]
        cell = table.grid.cell(*half_difference(direction, view, normal))
        reflected = table.values.reshape(3, -1)[:, cell] * light.lookup(direction).T * cosine
        total += reflected.sum(axis=1) * np.sin(polar) * (np.pi / rows) ** 2
    return total


def test_pixels_agree_with_a_slow_quadrature():
    light, table, resolution = noise_light(), glossy(), 15
    transport = build(SPHERE, light, MERL, resolution, 16384, 0)
    picture = colours(transport, table)
    for row, column in [(7, 7), (3, 9), (12, 8)]:
        pixel = np.array([row * resolution + column])
        direction = CAMERA.directions(pixel, np.array([[0.5, 0.5]]), resolution)[:, 0]
        hit = nearest(place(SPHERE), CAMERA.position[None], direction)
        point = CAMERA.position + hit.distance[0] * direction[0]
        expected = quadrature(point, -direction[0], hit.shading[0], light, table)
        np.testing.assert_allclose(picture[row, column], expected, rtol=0.01)


def test_antialiasing_leaves_the_interior_as_it_is():
    light = Environment(np.repeat(np.linspace(1, 2, 32), 64).reshape(32, 64, 1) * np.ones(3))
    plain = build(SPHERE, light, SMALL, 24, 2048, 0)
    smooth = build(Scene(("sphere",), ("antialiasing",)), light, SMALL, 24, 2048, 0)
    y, x = np.mgrid[-11.5:12, -11.5:12]
    inside = np.hypot(x, y) < 8
    pictures = [colours(t, uniform(SMALL))[inside] for t in (plain, smooth)]
    np.testing.assert_allclose(*pictures, rtol=0.01)
    assert set(np.unique(plain.coverage)) == {0, 1}
    assert len(np.unique(smooth.coverage)) > 4
    assert (smooth.coverage[plain.coverage == 1] > 0).all()


def test_a_mirror_shows_the_scene_behind_the_camera_upright():
    # Red behind the camera and up, green to the right, blue behind and to the left.
    radiance = np.zeros((2, 2, 2, 3))
    radiance[:, 1, 1], radiance[0, 0, 1], radiance[1, :, 0] = [1, 0, 0], [0, 0, 1], [0, 1, 0]
    mirror = np.zeros((3, *MERL.shape))
    mirror[:, :4] = 100.0
    transport = build(SPHERE, octants(radiance), MERL, 24, 2048, 0)
    picture = colours(transport, Table(mirror))
    assert picture[8, 10].argmax() == 0 and picture[8, 14].argmax() == 0
    assert picture[15, 9].argmax() == 2
    assert picture[12, 20].argmax() == 1
    assert picture[15, 15].max() == 0
    assert picture[12, 3].max() < 0.01 * picture[12, 20].max()


def test_the_light_is_seen_past_the_objects():
    # Even around the corners, where three pixels look, and nowhere else.
    light = Environment(np.kron(noise_light(4).radiance, np.ones((8, 8, 1))))
    picture = render(build(SPHERE, light, SMALL, 16, 64, 0), uniform(SMALL))
    assert picture.dtype == np.float32 and picture.shape == (16, 16, 4)
    direction = CAMERA.directions(np.array([0, 15, 255]), np.array([[0.5, 0.5]]), 16)[:, 0]
    expected = np.column_stack([light.lookup(direction), np.zeros(3)])
    np.testing.assert_allclose(picture[[0, 0, 15], [0, 15, 15]], expected, rtol=1e-6)
    assert picture[8, 8, 3] == 1


def test_a_picture_is_what_objects_reflect_over_the_light_behind():
    transport = build(Scene(("sphere",), ("antialiasing",)), noise_light(), SMALL, 16, 64, 0)
    alone = reflected(transport, uniform(SMALL))
    assert not alone[transport.coverage == 0].any()
    picture = render(transport, uniform(SMALL))
    np.testing.assert_array_equal(picture, over_backdrop(transport, alone))
    covered = transport.foreground
    np.testing.assert_array_equal(picture[covered], np.insert(alone[covered], 3, 1, axis=1))
    np.testing.assert_array_equal(picture[..., 3], transport.coverage)


def test_rows_are_sorted_without_duplicates_and_reproducible():
    one, same, other = (build(BOTH, noise_light(), SMALL, 16, 512, seed) for seed in (1, 1, 2))
    for name, value in vars(one).items():
        np.testing.assert_array_equal(value, getattr(same, name))
    assert not np.array_equal(one.weights[:, :100], other.weights[:, :100])
    assert one.indptr.dtype == np.int64 and one.indptr[-1] == len(one.indices)
    assert one.indices.dtype == np.int32 and one.weights.dtype == np.float32
    for first, last in zip(one.indptr, one.indptr[1:], strict=False):
        assert (np.diff(one.indices[first:last]) > 0).all()
    assert (np.diff(one.indptr)[~(one.coverage > 0).ravel()] == 0).all()


def test_blocks_do_not_matter(monkeypatch):
    whole = build(BOTH, noise_light(), SMALL, 12, 64, 1)
    monkeypatch.setattr(assembly, "BLOCK", 500)
    pieces = build(BOTH, noise_light(), SMALL, 12, 64, 1)
    np.testing.assert_array_equal(whole.indices, pieces.indices)
    np.testing.assert_allclose(whole.weights, pieces.weights, rtol=1e-6)


def test_points_that_mirror_a_lamp_get_more_samples():
    radiance = np.full((32, 64, 3), 0.01)
    radiance[8, 44] = 1000.0
    lamp = Environment(radiance)
    surface, _, _ = look(CAMERA, place(SPHERE), lamp, np.array([[0.5, 0.5]]), 32)
    multiples = assembly._multiples(surface, lamp, MERL)
    assert multiples.max() >= 16 and multiples.min() == 1
    assert multiples.mean() < 2
    most = surface[multiples.argmax()]
    mirrored = 2 * (most.view @ most.normal) * most.normal - most.view
    towards_lamp = lamp.sample(np.array([[0.5, 0.5]]))[0]
    assert np.degrees(np.arccos(mirrored @ towards_lamp)) < 8
    np.testing.assert_array_equal(assembly._multiples(surface, WHITE, MERL), 1)


def test_light_that_no_highlight_shows_is_no_obstacle():
    # Light straight from behind the sphere: its reflection is nowhere to be seen.
    radiance = np.zeros((64, 128, 3))
    radiance[32, 64] = 1.0
    transport = build(SPHERE, Environment(radiance), SMALL, 8, 64, 0)
    np.testing.assert_array_equal(colours(transport, glossy(SMALL))[transport.foreground], 0)


def test_too_few_samples_are_refused():
    with pytest.raises(NpfmError, match=r"16 samples a pixel are too few.*use 32"):
        build(Scene(("sphere",), ("antialiasing",)), WHITE, SMALL, 8, 16, 0)


def test_a_picture_without_an_object_is_refused():
    with pytest.raises(NpfmError, match="1 x 1 pixels"):
        build(BOTH, WHITE, SMALL, 1, 8, 0)


def test_render_refuses_a_table_on_another_grid():
    transport = build(SPHERE, WHITE, SMALL, 8, 8, 0)
    with pytest.raises(NpfmError, match=r"90x90x180.*built for half-difference 18x18x36"):
        render(transport, uniform())


def test_negative_entries_reflect_nothing():
    transport = build(SPHERE, noise_light(), SMALL, 8, 64, 0)
    values = glossy(SMALL).values
    values[:, 9:] = -1
    cut = np.where(values < 0, 0, values)
    np.testing.assert_array_equal(
        render(transport, Table(values, SMALL)), render(transport, Table(cut, SMALL))
    )


def test_save_and_load(tmp_path):
    transport = build(BOTH, noise_light(), SMALL, 16, 256, 1)
    folder = tmp_path / "made" / "scene"
    for _ in range(2):  # the second time over the first
        save(folder, transport)
    assert [path.name for path in folder.parent.iterdir()] == ["scene"]
    loaded = load(folder)
    assert loaded.grid == SMALL
    for name, value in transport.arrays.items():
        read = loaded.arrays[name]
        assert read.dtype == value.dtype
        assert isinstance(read, np.memmap) or name.startswith("grid")
        np.testing.assert_array_equal(read, value)
    table = glossy(SMALL)
    np.testing.assert_array_equal(render(loaded, table), render(transport, table))


def test_rendering_does_not_copy_what_is_mapped(tmp_path):
    save(tmp_path / "scene", build(SPHERE, noise_light(), SMALL, 24, 2048, 1))
    loaded, table = load(tmp_path / "scene"), glossy(SMALL)
    tracemalloc.start()
    render(loaded, table)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < loaded.indices.nbytes / 2


def test_load_names_a_damaged_folder(tmp_path):
    save(tmp_path / "scene", build(SPHERE, WHITE, SMALL, 8, 8, 0))
    (tmp_path / "scene" / "weights.npy").write_bytes(b"short")
    for folder in (tmp_path / "scene", tmp_path / "absent"):
        with pytest.raises(NpfmError, match=f"{folder}: not a transport matrix.*build it again"):
            load(folder)


def test_a_folder_that_names_no_kind_of_grid_is_on_half_difference(tmp_path):
    save(tmp_path / "scene", build(SPHERE, WHITE, SMALL, 8, 8, 0))
    (tmp_path / "scene" / "grid_kind.npy").unlink()
    assert load(tmp_path / "scene").grid == SMALL
    # It is a scene for all that, which another may replace.
    save(tmp_path / "scene", build(SPHERE, WHITE, SMALL, 8, 8, 0))
    assert (tmp_path / "scene" / "grid_kind.npy").exists()


def test_a_folder_on_an_unknown_kind_of_grid_is_refused(tmp_path):
    save(tmp_path / "scene", build(SPHERE, WHITE, SMALL, 8, 8, 0))
    np.save(tmp_path / "scene" / "grid_kind.npy", np.array("spherical"))
    with pytest.raises(NpfmError, match=r"not a transport.*unknown kind of grid 'spherical'"):
        load(tmp_path / "scene")
