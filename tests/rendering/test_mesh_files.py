"""Meshes from files of every kind, whole, damaged, and not what they seem."""

import logging
import struct

import numpy as np
import pytest
import trimesh

from npfm.errors import NpfmError
from npfm.rendering import meshes
from npfm.rendering.camera import Camera
from npfm.rendering.mesh_files import load_mesh

HEADER = (
    "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
    "property double z\n{}element face {}\nproperty list uchar int vertex_indices\nend_header\n"
)
NORMALS = "property float nx\nproperty float ny\nproperty float nz\n"


def ply_text(vertices, faces, normals=None):
    """An ASCII file with each number in full."""
    rows = vertices if normals is None else np.hstack([vertices, normals])
    lines = [" ".join(repr(float(x)) for x in row) for row in rows]
    lines += [" ".join(map(str, [len(face), *face])) for face in faces]
    header = HEADER.format(len(vertices), "" if normals is None else NORMALS, len(faces))
    return header + "\n".join(lines) + "\n"


BALL = trimesh.creation.icosphere(2)


def loaded(folder, content, name="figure.ply"):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return load_mesh(path)


def picture(mesh, resolution=24):
    """What a camera sees of a mesh on its foot: distances and normals, 0 where there is none."""
    figure = meshes.standing(mesh, height=2.0, width=0.95, foot=(0.1, -1.0, 0.0))
    camera = Camera(distance=4.0, field=np.radians(40))
    pixels, centre = np.arange(resolution**2), np.array([[0.5, 0.5]])
    directions = camera.directions(pixels, centre, resolution)[:, 0]
    origins = np.broadcast_to([0.0, 0.0, 4.0], directions.shape)
    hits = figure.nearest(origins, directions)
    hit = np.isfinite(hits.distance)
    assert hit.sum() > 20
    parts = np.concatenate([hits.distance[:, None], hits.geometric, hits.shading], axis=1)
    return np.where(hit[:, None], parts, 0)


def refused(folder, content, said, name="figure.ply"):
    with pytest.raises(NpfmError, match=said) as caught:
        loaded(folder, content, name)
    assert str(caught.value).startswith(f"{folder / name}: ")
    assert "\n" not in str(caught.value)


def test_a_ply_is_kept_as_it_is(tmp_path):
    mesh = loaded(tmp_path, ply_text(BALL.vertices, BALL.faces))
    np.testing.assert_array_equal(mesh.vertices, BALL.vertices)
    np.testing.assert_array_equal(mesh.faces, BALL.faces)
    np.testing.assert_allclose(mesh.normals, BALL.vertices, atol=0.01)


@pytest.mark.parametrize(
    "scale", [1e-300, 1e-30, 1e-7, 1e-6, 1.0, 1e6, 1e30, 1e300], ids="{:g}".format
)
def test_the_unit_of_a_file_does_not_matter(tmp_path, scale):
    expected = picture(loaded(tmp_path, ply_text(BALL.vertices, BALL.faces)))
    scaled = picture(loaded(tmp_path, ply_text(BALL.vertices * scale, BALL.faces)))
    np.testing.assert_allclose(scaled, expected, atol=1e-5)


def test_a_place_far_from_the_origin_does_not_matter(tmp_path):
    expected = picture(loaded(tmp_path, ply_text(BALL.vertices, BALL.faces)))
    moved = picture(loaded(tmp_path, ply_text(BALL.vertices + 1e6, BALL.faces)))
    np.testing.assert_allclose(moved, expected, atol=1e-5)


@pytest.mark.parametrize("stray", [[9.0, 9, 9], [0.3, 0, 0], [1e9, 0, 0], [np.nan, 0, np.inf]])
@pytest.mark.parametrize("first", [False, True])
def test_a_vertex_that_no_face_uses_does_not_matter(tmp_path, stray, first):
    expected = picture(loaded(tmp_path, ply_text(BALL.vertices, BALL.faces)))
    vertices = np.vstack([[stray], BALL.vertices] if first else [BALL.vertices, [stray]])
    mesh = loaded(tmp_path, ply_text(vertices, BALL.faces + int(first)))
    np.testing.assert_array_equal(picture(mesh), expected)


def test_faces_without_an_area_do_not_matter(tmp_path):
    expected = picture(loaded(tmp_path, ply_text(BALL.vertices, BALL.faces)))
    far = [[9.0, 9, 9], [8, 8, 8], [7, 7, 7]]
    vertices, n = np.vstack([BALL.vertices, far]), len(BALL.vertices)
    faces = [*BALL.faces.tolist(), [0, 0, 1], [n, n, n], [n, n + 1, n + 2], [3, 4]]
    np.testing.assert_array_equal(picture(loaded(tmp_path, ply_text(vertices, faces))), expected)


@pytest.mark.parametrize("extension", ["ply", "stl", "stl_ascii", "obj", "off", "glb"])
def test_every_format_gives_the_same_smooth_ball(tmp_path, extension):
    expected = picture(loaded(tmp_path, ply_text(BALL.vertices, BALL.faces)))
    content = BALL.export(file_type=extension)
    mesh = loaded(tmp_path, content, f"ball.{extension.removesuffix('_ascii')}")
    # STL has three vertices for each face; the normals are those of their place all the same.
    np.testing.assert_allclose(picture(mesh), expected, atol=1e-5)


def test_all_parts_of_a_gltf_scene_are_where_the_scene_has_them(tmp_path):
    scene = trimesh.Scene([BALL])
    scene.add_geometry(BALL, transform=trimesh.transformations.translation_matrix([5, 0, 0]))
    mesh = loaded(tmp_path, scene.export(file_type="glb"), "two.glb")
    assert len(mesh.faces) == 2 * len(BALL.faces)
    np.testing.assert_allclose(mesh.vertices.max(axis=0), [6, 1, 1], atol=1e-6)


def test_normals_of_the_file_are_taken_in_unit_length(tmp_path):
    given = np.random.default_rng(0).normal(size=BALL.vertices.shape)
    mesh = loaded(tmp_path, ply_text(BALL.vertices, BALL.faces, given))
    length = np.linalg.norm(given, axis=1, keepdims=True)
    np.testing.assert_allclose(mesh.normals, given / length, rtol=1e-12)


def test_normals_of_an_obj_are_taken(tmp_path):
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 2 0 0\nf 1//1 2//1 3//1\n"
    assert loaded(tmp_path, text, "a.obj").normals.tolist() == [[1, 0, 0]] * 3


@pytest.mark.parametrize("bad", [np.nan, np.inf, 0.0, 1e308])
def test_normals_that_are_none_are_averaged_from_the_faces(tmp_path, bad):
    plain = loaded(tmp_path, ply_text(BALL.vertices, BALL.faces))
    normals = BALL.vertices.copy()
    normals[::2] = bad
    mesh = loaded(tmp_path, ply_text(BALL.vertices, BALL.faces, normals))
    np.testing.assert_array_equal(mesh.normals[::2], plain.normals[::2])
    np.testing.assert_allclose(mesh.normals[1::2], BALL.vertices[1::2], atol=1e-12)


def test_averaged_normals_are_those_of_trimesh(tmp_path):
    mesh = trimesh.creation.torus(1.0, 0.4)
    found = loaded(tmp_path, ply_text(mesh.vertices, mesh.faces))
    np.testing.assert_allclose(found.normals, mesh.vertex_normals, atol=1e-9)


def test_a_flat_mesh_stands(tmp_path):
    flat = loaded(tmp_path, ply_text([[0, 0, 0], [2, 0, 0], [0, 0, 4]], [[0, 1, 2]]))
    stood = meshes.standing(flat, height=2.0, width=1.0, foot=(0.0, -1.0, 0.0))
    np.testing.assert_allclose(np.ptp(stood.vertices, axis=0), [0.5, 0, 1])
    np.testing.assert_allclose(stood.vertices[:, 1], -1)


CORNERS = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]
STL_FACE = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)


def stl(count, *faces):
    return bytes(80) + struct.pack("<I", count) + b"".join(faces)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("hello", "not a readable mesh"),
        ("", "is an empty file, not a mesh"),
        ("<!doctype html><p>", "looks like an HTML page, not a mesh; download the file itself"),
        ("version https://git-lfs.example/spec/v1\n", "looks like a git-lfs pointer"),
        (b"PK\3\4", "looks like a zip archive, not a mesh; unpack it"),
        (b"\x1f\x8b\x08", "looks like a gzip archive"),
        (ply_text([[0, 0, 0]], []), "without faces"),
        (ply_text([], []), "without faces"),
        (ply_text(CORNERS, [[0, 1]]), "without faces"),
        (ply_text(CORNERS, [[0, 1, 9]]), "a face names vertex 9, and there are 0 to 2"),
        (ply_text(CORNERS, [[0, 1, 3]]), "a face names vertex 3, and there are 0 to 2"),
        (ply_text(CORNERS, [[0, 1, -1]]), "a face names vertex -1"),
        (ply_text(CORNERS, [[0, 1, 2], [0, 1, 2**31 - 1]]), "a face names vertex 2147483647"),
        (ply_text([], [[0, 1, 2]]), "a face names vertex 0, and there are 0 to -1"),
        (ply_text([[0, 0, np.nan], *CORNERS[1:]], [[0, 1, 2]]), "NaN or infinite"),
        (ply_text([[0, -np.inf, 0], *CORNERS[1:]], [[0, 1, 2]]), "NaN or infinite"),
        (ply_text([[-1.7e308, 0, 0], [1.7e308, 0, 0], [0, 1, 0]], [[0, 1, 2]]), "or infinite"),
        (ply_text(CORNERS, [[0, 1, 1]]), "no face has an area"),
        (ply_text([[1, 1, 1]] * 3, [[0, 1, 2]]), "no face has an area"),
        (ply_text([[0, 0, 0], [1, 1, 1], [2, 2, 2]], [[0, 1, 2]]), "no face has an area"),
        (ply_text(CORNERS, [[0, 1, 2]])[:-3], "not a readable mesh.*cut off.*export it again"),
    ],
)
def test_a_ply_that_is_none_is_told_in_one_line(tmp_path, content, said):
    refused(tmp_path, content, said)


OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
ASCII_STL = BALL.export(file_type="stl_ascii")


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.obj", OBJ + "f 1 2 9\n", "not a readable mesh"),
        ("a.obj", OBJ + "f -9 -2 -1\n", "not a readable mesh"),
        ("a.obj", OBJ + "f 0 1 2\n", "a face names vertex 0, and OBJ counts from 1"),
        ("a.obj", OBJ, "without faces"),
        ("a.obj", OBJ.replace("1", "nan") + "f 1 2 3\n", "NaN or infinite"),
        ("a.obj", OBJ + "f 1 2 2\n", "no face has an area"),
        ("a.obj", bytes(range(1, 256)), "without faces|not a readable"),
        ("a.off", OFF.replace("0 1 2\n", "0 1 9\n"), "not a readable mesh"),
        ("a.off", OFF.replace("3 1 0", "3 1000000000 0"), "cut off: .* 1000000000 faces"),
        ("a.off", OFF.replace("3 1 0", "3000000000 1 0"), "cut off"),
        ("a.off", OFF[:20], "cut off"),
        ("a.stl", stl(0), "without faces"),
        ("a.stl", stl(2**32 - 1, STL_FACE), "cut off: there are not the 4294967295 faces"),
        ("a.stl", stl(2, STL_FACE, STL_FACE[:-1]), "cut off: there are not the 2 faces"),
        ("a.stl", stl(1)[:50], "cut off"),
        ("a.stl", ASCII_STL[: len(ASCII_STL) // 2], "cut off: it has no endsolid"),
        ("a.gltf", '{"asset": {"version": "2.0"}}', "without faces"),
        ("a.gltf", '{"asset": ', "not a readable mesh"),
        ("a.glb", b"glTF" + bytes(20), "not a readable mesh"),
        ("a.glb", BALL.export(file_type="glb")[:3000], "not a readable mesh"),
        ("a.xyz", "0 0 0\n1 0 0\n0 1 0\n", "without faces"),
        ("a.txt", "hello\n", "not a readable mesh"),
        ("a", "hello\n", "not a readable mesh"),
    ],
)
def test_another_format_that_is_none_is_told_in_one_line(tmp_path, name, content, said, caplog):
    with caplog.at_level(logging.WARNING):
        refused(tmp_path, content, said, name)
    assert caplog.records == []


def test_bytes_after_the_end_of_an_stl_do_not_matter(tmp_path):
    mesh = loaded(tmp_path, stl(1, STL_FACE, b"after"), "a.stl")
    assert len(mesh.faces) == 1
    assert len(loaded(tmp_path, b"solid" + stl(1, STL_FACE)[5:], "b.stl").faces) == 1


def test_what_is_no_file_is_named(tmp_path):
    with pytest.raises(NpfmError, match=r"absent\.ply: no such file"):
        load_mesh(tmp_path / "absent.ply")
    with pytest.raises(NpfmError, match="is a folder, not a mesh; give the path of a file in it"):
        load_mesh(tmp_path)


def test_noise_is_told_in_one_line(tmp_path):
    """Whatever byte is wrong, there is a mesh or a line."""
    rng = np.random.default_rng(7)
    small = trimesh.creation.icosphere(0)
    for extension in ("ply", "stl", "obj", "off", "glb"):
        exported = small.export(file_type=extension)
        content = exported if isinstance(exported, bytes) else exported.encode()
        for _ in range(60):
            noisy = bytearray(content)
            noisy[rng.integers(len(noisy))] = rng.integers(256)
            try:
                mesh = loaded(tmp_path, bytes(noisy), f"noisy.{extension}")
            except NpfmError as error:
                assert "\n" not in str(error)
            else:
                assert np.isfinite(mesh.vertices).all() and np.isfinite(mesh.normals).all()
