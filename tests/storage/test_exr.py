"""OpenEXR pictures of other programs: windows, layers, parts, types, and damaged or huge ones."""

import re
import struct

import numpy as np
import OpenEXR
import OpenImageIO as oiio
import pytest

from npfm.errors import NpfmError
from npfm.evaluation.comparison import decibels
from npfm.storage.pictures import read_exr, read_exr_parts, write_exr

PIXELS = np.random.default_rng(0).random((8, 16, 4), dtype=np.float32)
RGB = PIXELS[..., :3].copy()
PLAIN = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}


def write(path, channels, **header):
    with OpenEXR.File(PLAIN | header, channels) as file:
        file.write(str(path))


def write_parts(path, **parts):
    parts = [OpenEXR.Part(dict(PLAIN), channels, name) for name, channels in parts.items()]
    with OpenEXR.File(parts) as file:
        file.write(str(path))


def named(*names, pixels=PIXELS):
    return {name: pixels[..., k].copy() for k, name in enumerate(names)}


def raw(path, channels, window, chunks=b"", kind=b"scanlineimage"):
    """Write an OpenEXR file byte by byte: what no library agrees to write."""

    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value

    listed = b"".join(
        name + b"\0" + struct.pack("<iB3xii", type_, 0, sampling, sampling)
        for name, type_, sampling in channels
    )
    box = struct.pack("<4i", *window)
    path.write_bytes(
        struct.pack("<ii", 20000630, 2)
        + attribute(b"channels", b"chlist", listed + b"\0")
        + attribute(b"compression", b"compression", b"\0")
        + attribute(b"dataWindow", b"box2i", box)
        + attribute(b"displayWindow", b"box2i", box)
        + attribute(b"lineOrder", b"lineOrder", b"\0")
        + attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
        + attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
        + attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1))
        + b"\0"
        + chunks
    )


def refused(path, message):
    with pytest.raises(NpfmError, match=message) as caught:
        read_exr(path)
    assert re.match(rf"{re.escape(str(path))}: [^\n]{{20,260}}$", str(caught.value))


def test_a_crop_stands_at_its_place_in_black(tmp_path):
    path = tmp_path / "p.exr"
    write(path, {"RGBA": PIXELS}, dataWindow=((8, 4), (23, 11)), displayWindow=((0, 0), (31, 15)))
    expected = np.zeros((16, 32, 4))
    expected[4:12, 8:24] = PIXELS
    assert (read_exr(path) == expected).all()


def test_overscan_is_left_out(tmp_path):
    path = tmp_path / "p.exr"
    write(path, {"RGB": RGB}, dataWindow=((-2, -1), (13, 6)), displayWindow=((0, 0), (11, 5)))
    assert (read_exr(path) == RGB[1:7, 2:14]).all()


def test_windows_that_overlap_in_part_or_not_at_all(tmp_path):
    path = tmp_path / "p.exr"
    write(path, {"RGB": RGB}, dataWindow=((-5, 3), (10, 10)), displayWindow=((0, 0), (9, 4)))
    expected = np.zeros((5, 10, 3))
    expected[3:] = RGB[:2, 5:15]
    assert (read_exr(path) == expected).all()
    write(path, {"RGB": RGB}, dataWindow=((50, 50), (65, 57)), displayWindow=((0, 0), (9, 4)))
    assert (read_exr(path) == np.zeros((5, 10, 3))).all()
    write(path, {"RGB": RGB}, dataWindow=((9, 5), (24, 12)), displayWindow=((9, 5), (24, 12)))
    assert (read_exr(path) == RGB).all()


def test_pictures_of_different_places_are_not_compared(tmp_path):
    places = {
        "whole": ((0, 0), (15, 7), (0, 0), (15, 7)),
        "left": ((0, 0), (15, 7), (0, 0), (31, 15)),
        "right": ((16, 8), (31, 15), (0, 0), (31, 15)),
        "moved": ((16, 8), (31, 15), (16, 8), (31, 15)),
        "over": ((-1, -1), (14, 6), (0, 0), (14, 6)),
        "same": ((0, 0), (14, 6), (0, 0), (14, 6)),
    }
    for name, (a, b, c, d) in places.items():
        size = (b[1] - a[1] + 1, b[0] - a[0] + 1, 3)
        write(
            tmp_path / f"{name}.exr",
            {"RGB": np.ones(size, dtype=np.float32)},
            dataWindow=(a, b),
            displayWindow=(c, d),
        )
    for one, other, message in [
        (
            "left",
            "right",
            r"left.exr: it has the pixels 16 x 8 at \(16, 8\), .* at \(0, 0\)",
        ),
        ("whole", "left", r"whole.exr: it shows 32 x 16 at \(0, 0\), the other 16 x 8"),
        ("whole", "moved", r"shows 16 x 8 at \(16, 8\)"),
    ]:
        with pytest.raises(NpfmError, match=message):
            decibels(tmp_path / f"{one}.exr", [tmp_path / f"{other}.exr"])
    assert decibels(tmp_path / "over.exr", [tmp_path / "same.exr"]) == [np.inf]


@pytest.mark.parametrize(
    "names",
    [
        "RGB",
        "rgb",
        "RGBA",
        ("red", "green", "blue"),
        ("Red", "Green", "Blue", "Alpha"),
        tuple(f"ViewLayer.Combined.{c}" for c in "RGBA"),
        tuple(f"beauty.{c}" for c in "rgb"),
    ],
)
def test_red_green_and_blue_by_any_name(tmp_path, names):
    others = named("Z", "AR", "ViewLayer.Normal.X", "ViewLayer.Normal.Y")
    write(tmp_path / "p.exr", named(*names) | others)
    assert (read_exr(tmp_path / "p.exr") == PIXELS[..., : len(names)]).all()


def test_channels_without_a_layer_come_before_layers(tmp_path):
    layer = named("diffuse.R", "diffuse.G", "diffuse.B", "diffuse.A", pixels=2 * PIXELS)
    write(tmp_path / "p.exr", named(*"RGB") | layer)
    assert (read_exr(tmp_path / "p.exr") == RGB).all()


def test_the_only_part_with_colours_is_found(tmp_path):
    depth, colours = named("Z"), {"RGB": RGB}
    write_parts(tmp_path / "p.exr", depth=depth, beauty=colours)
    assert (read_exr(tmp_path / "p.exr") == RGB).all()
    with pytest.raises(NpfmError, match="channels Z; red, green and blue"):
        read_exr_parts(tmp_path / "p.exr")


def test_several_layers_are_told_by_name(tmp_path):
    path = tmp_path / "p.exr"
    write(path, named(*(f"{k}.{c}" for k in ("diff",) for c in "RGB")) | named("s.r", "s.g", "s.b"))
    refused(path, r"several layers have red, green and blue \(diff, s\)")
    write_parts(path, depth=named("Z"), left={"RGB": RGB}, right={"RGB": RGB})
    refused(path, r"several layers .* \(part 2, part 3\)")
    write(path, {f"layer{k}.{c}": RGB[..., 0] for k in range(40) for c in "RGB"})
    refused(path, "layer11, layer12.* and 28 others|layer.* and 28 others")


@pytest.mark.parametrize(
    ("names", "listed"),
    [("Y", "Y"), ("A", "A"), ("RG", "R, G"), (("X", "Y", "Z"), "X, Y, Z"), (("V.R", "W.G"), "V.R")],
)
def test_without_colours_the_channels_are_listed(tmp_path, names, listed):
    write(tmp_path / "p.exr", named(*names))
    refused(tmp_path / "p.exr", f"channels {listed}.*; red, green and blue are needed")


def test_integers_are_refused(tmp_path):
    path = tmp_path / "p.exr"
    write(path, {c: np.full((8, 16), 3, dtype=np.uint32) for c in "RGB"})
    refused(path, "channel R is of type uint32")
    write(path, named(*"RG") | {"B": np.full((8, 16), 3, dtype=np.uint32)})
    refused(path, "channel B is of type uint32")
    write(path, named(*"RGB") | {"object": np.full((8, 16), 3, dtype=np.uint32)})
    assert (read_exr(path) == RGB).all()


def test_half_floats_tiles_levels_and_any_order_of_lines(tmp_path):
    path = tmp_path / "p.exr"
    write(path, {"RGB": RGB.astype(np.float16)})
    assert (read_exr(path) == RGB.astype(np.float16)).all()
    write(path, {"RGB": RGB}, type=OpenEXR.tiledimage, tiles=OpenEXR.TileDescription())
    assert (read_exr(path) == RGB).all()
    write(path, {"RGB": RGB}, lineOrder=OpenEXR.DECREASING_Y)
    assert (read_exr(path) == RGB).all()
    source = oiio.ImageBuf(str(path))
    assert oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, source, str(tmp_path / "mip.exr"))
    np.testing.assert_allclose(read_exr(tmp_path / "mip.exr")[..., :3], RGB, rtol=1e-3)


@pytest.mark.parametrize("name", ["NO", "RLE", "ZIPS", "PIZ", "PXR24", "B44", "DWAA"])
def test_every_compression(tmp_path, name):
    write(tmp_path / "p.exr", {"RGB": RGB}, compression=getattr(OpenEXR, f"{name}_COMPRESSION"))
    np.testing.assert_allclose(read_exr(tmp_path / "p.exr"), RGB, atol=0.02)


def test_deep_pixels_are_refused(tmp_path):
    spec = oiio.ImageSpec(16, 8, 5, oiio.FLOAT)
    spec.channelnames, spec.deep = ("R", "G", "B", "A", "Z"), True
    deep = oiio.DeepData()
    deep.init(128, 5, (oiio.FLOAT,) * 5, spec.channelnames)
    for pixel in range(128):
        deep.set_samples(pixel, 2)
    file = oiio.ImageOutput.create(str(tmp_path / "p.exr"))
    assert file.open(str(tmp_path / "p.exr"), spec) and file.write_deep_image(deep)
    file.close()
    refused(tmp_path / "p.exr", "deep pixels")


def test_an_orientation_is_refused(tmp_path):
    spec = oiio.ImageSpec(16, 8, 3, oiio.FLOAT)
    spec.attribute("Orientation", 6)
    file = oiio.ImageOutput.create(str(tmp_path / "p.exr"))
    assert file.open(str(tmp_path / "p.exr"), spec) and file.write_image(RGB)
    file.close()
    refused(tmp_path / "p.exr", "Orientation")


HALF, FLOAT = 1, 2


def test_subsampled_channels_are_refused(tmp_path):
    path = tmp_path / "p.exr"
    raw(path, [(b"BY", FLOAT, 2), (b"RY", FLOAT, 2), (b"Y", FLOAT, 1)], (0, 0, 15, 7))
    refused(path, "[Ss]ubsampled")
    raw(path, [(b"B", FLOAT, 2), (b"G", FLOAT, 1), (b"R", FLOAT, 2)], (0, 0, 15, 7))
    refused(path, "[Ss]ubsampled")


@pytest.mark.parametrize(
    "window",
    [
        (0, 0, 2**30, 2**30),
        (0, 0, 99_999, 49_999),
        (-(2**31), -(2**31), 2**31 - 1, 2**31 - 1),
        (5, 5, 0, 0),
    ],
)
def test_a_header_cannot_ask_for_all_memory(tmp_path, window, capfd):
    path = tmp_path / "p.exr"
    raw(path, [(c, FLOAT, 1) for c in (b"B", b"G", b"R")], window)
    refused(path, "pixels|cannot be read")
    assert capfd.readouterr() == ("", "")


def test_a_display_window_cannot_ask_for_all_memory(tmp_path):
    path = tmp_path / "p.exr"
    write(path, {"RGB": RGB}, displayWindow=((0, 0), (99_999, 49_999)))
    refused(path, "100000 x 50000 pixels")


@pytest.mark.parametrize("kept", [4, 5, 20, 200, 330, -100, -1])
def test_a_file_cut_off_anywhere(tmp_path, kept):
    path = tmp_path / "p.exr"
    write_exr(path, PIXELS)
    path.write_bytes(path.read_bytes()[:kept])
    refused(path, "cut off|cannot be read")
