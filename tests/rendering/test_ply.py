"""PLY files written by hand, against what is in them and against trimesh."""

import io
import struct
import warnings

import numpy as np
import pytest
import trimesh

from npfm.rendering import ply

VERTICES = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]])
#: A pyramid: its foot in one piece, its sides in triangles, and a pentagon to be a fan.
FACES = ((3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4), (0, 1, 2, 3, 4))
TRIANGLES = {(3, 2, 1), (3, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)} | {
    (0, 1, 2),
    (0, 2, 3),
    (0, 3, 4),
}
ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}


def packed(order, form, *values):
    """Numbers as text, or as bytes of one order."""
    if order is None:
        return (" ".join(f"{v:.9g}" for v in values) + "\n").encode()
    return struct.pack(order + form, *values)


def pyramid(form, faces=FACES, *, ending="\n", counts=None, extra=False, vertices=VERTICES):
    """A file of the format `form`; `extra` adds what other programs write as well."""
    order = ORDERS[form]
    vertex_count, face_count = counts or (len(vertices), len(faces))
    header = ["ply", f"format {form} 1.0", "comment a pyramid", "obj_info none"]
    header += ["element camera 1", "property list uchar float view"] if extra else []
    header += [f"element vertex {vertex_count}"]
    header += [f"property double {axis}" for axis in "xyz"]
    header += ["property uchar red"] if extra else []
    header += [f"element face {face_count}"]
    header += ["property uchar flag"] if extra else []
    header += ["property list uchar int vertex_indices"]
    header += ["property list uchar float texcoord"] if extra else []
    header += ["element edge 1", "property int vertex1"] if extra else []
    body = packed(order, "B2f", 2, 0.5, 0.25) if extra else b""
    for vertex in vertices:
        body += packed(order, "3dB" if extra else "3d", *vertex, *([200] if extra else []))
    for k, face in enumerate(faces):
        texture = [0.5] * (k % 3)
        body += packed(
            order,
            f"BB{len(face)}iB{len(texture)}f" if extra else f"B{len(face)}i",
            *([7] if extra else []),
            len(face),
            *face,
            *([len(texture), *texture] if extra else []),
        )
    body += packed(order, "i", 3) if extra else b""
    return ending.join([*header, "end_header", ""]).encode() + body


@pytest.mark.parametrize("form", ORDERS)
@pytest.mark.parametrize("extra", [False, True])
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_faces_of_different_corners_in_every_format(form, extra, ending):
    content = pyramid(form, extra=extra, ending=ending)
    vertices, triangles, normals = ply.parse(content)
    np.testing.assert_array_equal(vertices, VERTICES)
    assert {tuple(t) for t in triangles.tolist()} == TRIANGLES
    assert len(triangles) == len(TRIANGLES)
    assert normals is None


@pytest.mark.parametrize("form", ORDERS)
def test_bytes_after_the_end_do_not_matter(form):
    after = b"1 2 3\n" if form == "ascii" else b"\0\xffafter"
    for faces in (FACES, FACES[1:5]):
        content = pyramid(form, faces)
        plain, more = ply.parse(content), ply.parse(content + after)
        np.testing.assert_array_equal(plain[1], more[1])


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
@pytest.mark.parametrize("normals", [False, True])
def test_what_trimesh_writes_is_read_as_trimesh_reads_it(encoding, normals):
    mesh = trimesh.creation.icosphere(2)
    content = mesh.export(file_type="ply", encoding=encoding, vertex_normal=normals)
    theirs = trimesh.load(io.BytesIO(content), file_type="ply", process=False)
    vertices, triangles, found = ply.parse(content)
    np.testing.assert_allclose(vertices, theirs.vertices, atol=1e-7)
    np.testing.assert_array_equal(triangles, theirs.faces)
    assert (found is not None) == normals
    if normals:
        np.testing.assert_allclose(found, theirs.vertex_normals, atol=1e-6)


@pytest.mark.parametrize("form", ORDERS)
@pytest.mark.parametrize("faces", [FACES, FACES[1:5]])
def test_a_file_cut_off_anywhere_is_refused(form, faces):
    content = pyramid(form, faces)
    for size in range(len(content) - 2):
        with pytest.raises(ValueError, match=r"header|cut off|has no|lack"):
            ply.parse(content[:size])


@pytest.mark.parametrize("form", ORDERS)
@pytest.mark.parametrize("counts", [(5, 7), (5, 10**15), (10**15, 6), (2**63, 2**63)])
def test_counts_are_not_believed(form, counts):
    with pytest.raises(ValueError, match=r"cut off|entries|whole number"):
        ply.parse(pyramid(form, counts=counts))


def test_rows_are_counted_where_they_are_lines():
    with pytest.raises(ValueError, match="cut off: 11 lines for the 12 rows"):
        ply.parse(pyramid("ascii", counts=(6, 6)))


def test_a_list_is_not_believed_to_be_as_long_as_it_says():
    content = pyramid("binary_little_endian").replace(b"list uchar int", b"list uint int")
    with pytest.raises(ValueError, match="cut off"):
        ply.parse(content)
    negative = pyramid("ascii", FACES[1:5]).replace(b"3 0 1 4", b"-3 0 1 4")
    with pytest.raises(ValueError, match=r"a list of its element 'face' has -3.0 entries"):
        ply.parse(negative)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (b"format ascii 1.0", b"format ascii 2.0", "a line that is not understood: 'format ascii"),
        (b"format ascii 1.0\n", b"", "names no format"),
        (b"double x", b"quad x", "not understood: 'property quad x'"),
        (b"element vertex 5", b"element vertex -5", "not understood: 'element vertex -5'"),
        (b"element vertex 5\n", b"", "not understood: 'property double x'"),
        (b"double x", b"double u", "vertices lack x, y or z"),
        (b"vertex_indices", b"corners", "no list vertex_indices or vertex_index"),
        (b"element face 6", b"element tristrips 6", "triangle strips"),
        (b"element face 6", b"element facet 6", "no faces"),
        (b"end_header", b"end", "header has no end"),
        (b"0 0 0", b"0 zero 0", "something else than numbers"),
        (b"3 0 1 4", b"3 0 1 4.5", "a corner of a face is no whole number"),
        (b"3 0 1 4", b"3 0 1 nan", "a corner of a face is no whole number"),
    ],
)
def test_what_is_wrong_is_named(old, new, said):
    content = pyramid("ascii")
    assert old in content
    with pytest.raises(ValueError, match=said):
        ply.parse(content.replace(old, new, 1))


def test_points_and_lines_are_no_faces():
    assert ply.parse(pyramid("ascii", ((0,), (0, 1), ())))[1].shape == (0, 3)
    assert ply.parse(pyramid("binary_big_endian", ()))[1].shape == (0, 3)


def test_noise_is_refused_without_a_warning():
    rng = np.random.default_rng(5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for form in ORDERS:
            content = pyramid(form, extra=True)
            for _ in range(300):
                at = rng.integers(len(content))
                noisy = bytearray(content)
                noisy[at] = rng.integers(256)
                try:
                    ply.parse(bytes(noisy))
                except ValueError as error:
                    assert "\n" not in str(error)
