import sys

import numpy as np
import pytest
import trimesh

from npfm.rendering import meshes
from npfm.rendering.camera import Camera
from npfm.rendering.geometry import OFFSET, Mesh, Sphere, nearest
from npfm.rendering.mesh_files import load_mesh

CENTRE, RADIUS = (0.3, -0.2, 0.1), 0.8


def ball(subdivisions=4):
    mesh = trimesh.creation.icosphere(subdivisions, RADIUS)
    return Mesh(mesh.vertices + CENTRE, mesh.faces, mesh.vertices / RADIUS)


def rays(count, rng):
    """From points of a sphere of radius 5 towards the unit ball; half of them hit."""
    origins, targets = rng.normal(size=(2, count, 3))
    origins *= 5 / np.linalg.norm(origins, axis=1, keepdims=True)
    directions = 0.6 * targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def test_sphere_is_hit_at_the_smaller_root_of_its_quadratic():
    rng = np.random.default_rng(0)
    origins, directions = rays(300, rng)
    hits = Sphere(CENTRE, RADIUS).nearest(origins, directions)
    for origin, direction, distance in zip(origins, directions, hits.distance, strict=True):
        from_centre = origin - CENTRE
        roots = np.roots([1, 2 * direction @ from_centre, from_centre @ from_centre - RADIUS**2])
        expected = roots.real.min() if np.isreal(roots).all() else np.inf
        assert distance == pytest.approx(expected, rel=1e-9)
    assert 50 < np.isfinite(hits.distance).sum() < 250


def test_sphere_behind_the_origin_is_not_hit():
    origin, direction = np.array([[0.0, 0, 3]]), np.array([[0.0, 0, 1]])
    sphere = Sphere((0, 0, 0), 1)
    assert np.isinf(sphere.nearest(origin, direction).distance)
    assert not sphere.occluded(origin, direction)


def test_mesh_agrees_with_the_sphere_that_it_approximates():
    origins, directions = rays(5000, np.random.default_rng(1))
    exact = Sphere(CENTRE, RADIUS).nearest(origins, directions)
    found = ball().nearest(origins, directions)
    hit = np.isfinite(exact.distance)
    assert (hit == np.isfinite(found.distance)).mean() > 0.995
    # Away from the rim, where a facet moves the hit by more than its own depth.
    steep = np.einsum("ij,ij->i", exact.shading, directions) < -0.3
    clear = hit & np.isfinite(found.distance) & steep
    assert clear.sum() > 1000
    np.testing.assert_allclose(found.distance[clear], exact.distance[clear], atol=6e-3)
    np.testing.assert_allclose(found.shading[clear], exact.shading[clear], atol=6e-3)
    cosine = np.einsum("ij,ij->i", found.geometric[clear], exact.geometric[clear])
    assert cosine.min() > np.cos(np.radians(4))
    np.testing.assert_allclose(np.linalg.norm(found.shading[clear], axis=1), 1)


@pytest.mark.parametrize("shape", [Sphere(CENTRE, RADIUS), ball()], ids=["sphere", "mesh"])
def test_occluded_is_the_same_as_hit(shape):
    origins, directions = rays(5000, np.random.default_rng(2))
    hit = np.isfinite(shape.nearest(origins, directions).distance)
    np.testing.assert_array_equal(shape.occluded(origins, directions), hit)


def test_nearest_takes_the_closest_object_with_its_normals():
    front, back = Sphere((0, 0, 2), 0.5), Sphere((0, 0, 0), 1)
    origins = np.array([[0.0, 0, 9], [0.8, 0, 9], [3, 0, 9]])
    directions = np.array([[0.0, 0, -1]] * 3)
    for objects in ((front, back), (back, front)):
        hits = nearest(objects, origins, directions)
        np.testing.assert_allclose(hits.distance, [6.5, 8.4, np.inf])
        np.testing.assert_allclose(hits.shading[:2], [[0, 0, 1], [0.8, 0, 0.6]], atol=1e-12)
        np.testing.assert_allclose(hits.geometric[:2], hits.shading[:2])


def test_shadow_rays_start_clear_of_the_mesh_itself():
    mesh = ball(5)
    points = mesh.vertices[mesh.faces].mean(axis=1)
    corners = [mesh.vertices[mesh.faces[:, k]] for k in range(3)]
    normals = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    directions = np.random.default_rng(3).normal(size=points.shape)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    outwards = np.einsum("ij,ij->i", directions, normals)
    occluded = mesh.occluded(points + OFFSET * normals, directions)
    assert not occluded[outwards > 0].any()
    assert occluded[outwards < -0.15].all()


def test_figure_is_faces_outwards_and_shadows_itself():
    mesh = meshes.figure()
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert 5_000 < len(mesh.vertices) < 15_000
    for part in (meshes._knot(100, 12), meshes._pedestal(20, 30)):
        assert trimesh.Trimesh(part.vertices, part.faces, process=False).volume > 0
    np.testing.assert_array_equal(mesh.vertices, meshes.figure().vertices)
    proper = solid.area_faces > 1e-8
    normals = solid.face_normals[proper]
    shadowed = mesh.occluded(solid.triangles_center[proper] + 1e-4 * normals, normals)
    assert 0.1 < shadowed.mean() < 0.5


def test_a_face_seen_from_behind_turns_its_normals():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    tilted = np.full((3, 3), [0.6, 0, 0.8])
    face = Mesh(corners, np.array([[0, 1, 2]]), tilted)
    origins = np.array([[0.2, 0.2, 1], [0.2, 0.2, -1]])
    directions = np.array([[0.0, 0, -1], [0, 0, 1]])
    hits = face.nearest(origins, directions)
    np.testing.assert_allclose(hits.geometric, [[0, 0, 1], [0, 0, -1]])
    np.testing.assert_allclose(hits.shading, [[0.6, 0, 0.8], [-0.6, 0, -0.8]])
    wrong_way_round = Mesh(corners, np.array([[0, 2, 1]]), tilted)
    assert hits.along is None
    turned = wrong_way_round.nearest(origins, directions)
    for found, expected in zip(turned[:3], hits[:3], strict=True):
        np.testing.assert_allclose(found, expected)


def test_standing_puts_the_bounding_box_on_its_foot():
    wide = Mesh(np.array([[0.0, 1, 2], [6, 3, 3], [1, 2, 7]]), np.array([[0, 1, 2]]), np.eye(3))
    tall = Mesh(wide.vertices * [0.01, 1, 0.01], wide.faces, wide.normals)
    for mesh, extent in ((wide, [0.9, 0.3, 0.75]), (tall, [0.06, 2.0, 0.05])):
        vertices = meshes.standing(mesh, height=2.0, width=0.9, foot=(0.5, -1, 0.25)).vertices
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        np.testing.assert_allclose(high - low, extent)
        np.testing.assert_allclose((low + high)[[0, 2]] / 2, [0.5, 0.25])
        assert low[1] == pytest.approx(-1)


def test_load_mesh_of_the_buddha(data):
    mesh = load_mesh(data / "meshes" / "happy_vrip_res4.ply")
    assert len(mesh.faces) > 10_000
    middle = mesh.vertices.mean(axis=0)
    origins, directions = rays(20_000, np.random.default_rng(4))
    hits = mesh.nearest(0.1 * origins + middle, directions)
    hit = np.isfinite(hits.distance)
    assert hit.sum() > 1000
    # Some of its faces lie back to back, and the normals at their vertices are zero.
    assert (np.linalg.norm(mesh.normals, axis=1) < 0.5).any()
    np.testing.assert_allclose(np.linalg.norm(hits.shading[hit], axis=1), 1, atol=1e-6)


def test_cancelling_normals_give_way_to_that_of_the_face():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    flat = Mesh(corners, np.array([[0, 1, 2]]), np.zeros((3, 3)))
    hits = flat.nearest(np.array([[0.2, 0.2, 1]]), np.array([[0.0, 0, -1]]))
    np.testing.assert_allclose(hits.shading, [[0, 0, 1]])


def test_camera_sees_right_on_the_right_and_up_at_the_top():
    camera = Camera(distance=4.0, field=np.radians(30))
    pixels, centre = np.array([0, 2, 12, 24]), np.array([[0.5, 0.5]])
    left_top, top, middle, right_bottom = camera.directions(pixels, centre, 5)[:, 0]
    np.testing.assert_allclose(middle, [0, 0, -1], atol=1e-15)
    np.testing.assert_allclose(left_top, right_bottom * [-1, -1, 1])
    assert right_bottom[0] > 0 > right_bottom[1]
    assert top[1] > 0 == pytest.approx(top[0])
    corner = camera.directions(np.array([2]), np.array([[0.5, 0.0]]), 5)[0, 0]
    assert np.degrees(np.arccos(-corner[2])) == pytest.approx(15)


def test_embree_is_not_needed_to_make_a_mesh(monkeypatch):
    monkeypatch.setitem(sys.modules, "embreex", None)
    monkeypatch.setitem(sys.modules, "embreex.rtcore_scene", None)
    mesh = ball(1)
    with pytest.raises(ImportError):
        mesh.nearest(np.zeros((1, 3)), np.ones((1, 3)))
