"""Radiance pictures: every encoding, orientation and variable of the header, and damaged ones."""

import re
from itertools import product

import numpy as np
import OpenImageIO as oiio
import pytest

from npfm.errors import NpfmError
from npfm.storage.pictures import read_exr, read_radiance

FORM = "FORMAT=32-bit_rle_rgbe\n"


def header(size, variables=FORM):
    return f"#?RADIANCE\n{variables}\n{size}\n".encode()


def flat(stored):
    return stored.tobytes()


def by_channel(stored):
    """New run lengths: runs of three and more repeat, others are written out."""
    body = bytearray()
    for row in stored:
        body += bytes([2, 2, len(row) >> 8, len(row) & 255])
        for values in row.T:
            for run in np.split(values, np.flatnonzero(np.diff(values)) + 1):
                for start in range(0, len(run), 127):
                    part = run[start : start + 127]
                    body += bytes(
                        [128 + len(part), part[0]] if len(part) > 2 else [len(part), *part]
                    )
    return bytes(body)


def by_pixel(stored):
    """Old run lengths: the count of repetitions in digits of 256, the lowest first."""
    body = bytearray()
    for row in stored:
        changes = np.flatnonzero((np.diff(row.astype(int), axis=0) != 0).any(axis=1)) + 1
        for run in np.split(row, changes):
            body += run[0].tobytes()
            repeats = len(run) - 1
            while repeats:
                body += bytes([1, 1, 1, repeats & 255])
                repeats >>= 8
    return bytes(body)


def mantissas(height, width, seed=0):
    """Pixels with runs of all lengths."""
    rng = np.random.default_rng(seed)
    stored = rng.integers(2, 256, (height, width, 4), dtype=np.uint8)
    for row in stored:
        start = 0
        while start < width:
            length = int(rng.integers(1, 2 + width // 2))
            row[start : start + length] = row[start]
            start += length * int(rng.integers(1, 3))
    stored[0, 0] = 0
    stored[..., 3] = np.where(stored[..., 3] > 0, stored[..., 3] // 4 + 100, 0)
    return stored


def values(stored):
    exponent = stored[..., 3:].astype(int) - 136
    return np.where(stored[..., 3:] > 0, stored[..., :3] * 2.0**exponent, 0).astype(np.float32)


@pytest.mark.parametrize(
    ("encode", "width"),
    [
        *product([flat, by_pixel], [1, 7, 8, 300, 700, 40_000]),
        *product([by_channel], [8, 127, 128, 300, 0x7FFF]),  # the lengths it is made for
    ],
)
def test_every_encoding_gives_the_values(tmp_path, encode, width):
    stored = mantissas(5, width, width)
    path = tmp_path / "p.hdr"
    path.write_bytes(header(f"-Y 5 +X {width}") + encode(stored))
    assert (read_radiance(path) == values(stored)).all()


def test_encodings_may_change_from_scanline_to_scanline(tmp_path):
    stored = mantissas(6, 40)
    encodings = (flat, by_channel, by_pixel) * 2
    body = b"".join(encode(row[None]) for encode, row in zip(encodings, stored, strict=True))
    (tmp_path / "p.hdr").write_bytes(header("-Y 6 +X 40") + body)
    assert (read_radiance(tmp_path / "p.hdr") == values(stored)).all()


@pytest.mark.parametrize("encode", [flat, by_channel])
def test_another_reader_agrees(tmp_path, encode):
    path = tmp_path / "p.hdr"
    path.write_bytes(header("-Y 9 +X 50") + encode(mantissas(9, 50)))
    assert (oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT) == read_radiance(path)).all()


@pytest.mark.parametrize("name", ["grace_probe", "ennis_probe", "rnl_probe", "stpeters_cross"])
def test_another_reader_agrees_on_the_papers_lights(data, name):
    path = data / "probes" / f"{name}.hdr"
    assert (oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT) == read_radiance(path)).all()


@pytest.mark.parametrize("order", ["YX", "XY"])
@pytest.mark.parametrize("y", "-+")
@pytest.mark.parametrize("x", "-+")
def test_every_orientation_stands_upright(tmp_path, order, x, y):
    """The format's words: the axis named first runs over scanlines, the other along them."""
    picture = mantissas(9, 11)
    extent, sign = {"X": 11, "Y": 9}, {"X": x, "Y": y}
    # X grows to the right and Y upwards; with a minus they are stored from the largest on.
    along = {a: range(n) if sign[a] == "+" else range(n)[::-1] for a, n in extent.items()}
    stored = np.zeros((extent[order[0]], extent[order[1]], 4), dtype=np.uint8)
    for i, first in enumerate(along[order[0]]):
        for j, second in enumerate(along[order[1]]):
            at = {order[0]: first, order[1]: second}
            stored[i, j] = picture[8 - at["Y"], at["X"]]
    size = " ".join(f"{sign[axis]}{axis} {extent[axis]}" for axis in order)
    for encode in (flat, by_channel):
        (tmp_path / "p.hdr").write_bytes(header(size) + encode(stored))
        assert (read_radiance(tmp_path / "p.hdr") == values(picture)).all()


@pytest.mark.parametrize(
    ("variables", "factor"),
    [
        (FORM + "EXPOSURE=2\n", 2),
        (FORM + "EXPOSURE=  2.0e0\npfilt -e 4\nEXPOSURE= 4\n", 8),
        (FORM + "COLORCORR=2 1 4\n", [2, 1, 4]),
        (FORM + "COLORCORR= 2 1 4\nEXPOSURE=.5\nCOLORCORR=1 3 1\n", [1, 1.5, 2]),
        (FORM + "\tEXPOSURE=7\n", 1),  # of a picture that went into this one
        (FORM + "GAMMA=1.0\nVIEW= -vta -vv 360\nPIXASPECT=2\n", 1),
        ("SOFTWARE=none\n", 1),  # no FORMAT: the format's default
    ],
)
def test_what_was_multiplied_is_divided_out(tmp_path, variables, factor):
    stored = mantissas(4, 9)
    (tmp_path / "p.hdr").write_bytes(header("-Y 4 +X 9", variables) + flat(stored))
    expected = values(stored) / np.asarray(factor, dtype=float)
    np.testing.assert_allclose(read_radiance(tmp_path / "p.hdr"), expected, rtol=1e-6)


def test_lines_may_end_as_on_windows(tmp_path):
    stored = mantissas(4, 9)
    start = header("-Y 4 +X 9").replace(b"\n", b"\r\n")
    (tmp_path / "p.hdr").write_bytes(start + flat(stored))
    assert (read_radiance(tmp_path / "p.hdr") == values(stored)).all()


ROW = flat(mantissas(1, 9))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (header("-Y 1 +X 9", "FORMAT=32-bit_rle_xyze\n") + ROW, "FORMAT=32-bit_rle_xyze"),
        (header("-Y 1 +X 9", FORM + "GAMMA=2.2\n") + ROW, "GAMMA=2.2"),
        (header("-Y 1 +X 9", FORM + "EXPOSURE=0\n") + ROW, "EXPOSURE=0 has no meaning"),
        (header("-Y 1 +X 9", FORM + "EXPOSURE=nan\n") + ROW, "EXPOSURE=nan has no meaning"),
        (header("-Y 1 +X 9", FORM + "EXPOSURE=two\n") + ROW, "EXPOSURE=two has no meaning"),
        (header("-Y 1 +X 9", FORM + "COLORCORR=1 2\n") + ROW, "COLORCORR=1 2 has no meaning"),
        (header("-Y 1 +X 9") + ROW[:-1], "cut off"),
        (header("-Y 1 +X 9") + bytes([1, 1, 1, 9]) + ROW, "cut off"),
        (header("-Y 1 +X 9") + ROW[:4] + bytes([1, 1, 1, 9]), "cut off"),
        (header("-Y 1 +X 9") + bytes([2, 2, 0, 9, 0, 0] * 9), "cut off"),
        (header("-Y 1 +X 9") + bytes([2, 2, 0, 9, 138, 1] * 9), "cut off"),
        (header("-Y 1 +X 9") + bytes([2, 2, 0, 9, 137, 1, 9, 1]), "cut off"),
        (header("-Y 1 +X 9") + bytes([2, 2, 0, 9, 137]), "cut off"),
        (header("-Y 0 +X 9"), "9 x 0 pixels"),
        (header("-Y -1 +X 9") + ROW, "where its size belongs"),
        (header("-Y 1 +Y 9") + ROW, "where its size belongs"),
        (header("-Y 1"), "where its size belongs"),
        (b"#?RADIANCE\n", "where its size belongs"),
        (b"#?RADIANCE\n" + b"x\n" * 2**16, "no end"),
        (b"#?" + b"x" * 2**20, "no end"),
        (header("-X 20000 -Y 30000"), "20000 x 30000 pixels"),
        (header("-Y 2000000000 +X 2000000000"), "2000000000 x 2000000000 pixels"),
        (header(f"-Y {'9' * 4000} +X 9"), "pixels|size belongs"),
        (b"\x89PNG\r\n\x1a\n", "not an OpenEXR or HDR"),
        (b"", "not an OpenEXR or HDR"),
    ],
)
def test_what_cannot_be_read_rightly_is_refused_in_one_line(tmp_path, content, message):
    path = tmp_path / "p.hdr"
    path.write_bytes(content)
    with pytest.raises(NpfmError, match=message) as caught:
        read_radiance(path)
    assert re.match(rf"{re.escape(str(path))}: [^\n]{{20,200}}$", str(caught.value))


def test_a_comparison_is_of_openexr_pictures(tmp_path):
    (tmp_path / "p.exr").write_bytes(header("-Y 1 +X 9") + ROW)
    with pytest.raises(NpfmError, match="not an OpenEXR file"):
        read_exr(tmp_path / "p.exr")
