import numpy as np
import OpenEXR
import pytest
from PIL import Image

from npfm.errors import NpfmError
from npfm.storage.pictures import (
    read_exr,
    read_exr_parts,
    read_radiance,
    tone_map,
    tone_map_layers,
    write_exr,
    write_exr_parts,
    write_png,
)


@pytest.fixture
def picture():
    return np.random.default_rng(0).random((7, 5, 4)).astype(np.float32) * 1e4


@pytest.mark.parametrize("channels", [3, 4])
def test_a_picture_comes_back_from_its_file(tmp_path, picture, channels):
    write_exr(tmp_path / "new" / "p.exr", picture[..., :channels])
    back = read_exr(tmp_path / "new" / "p.exr")
    assert back.dtype == np.float32
    assert (back == picture[..., :channels]).all()
    assert (read_radiance(tmp_path / "new" / "p.exr") == back).all()


def test_arrays_of_any_layout_and_type_are_written_right(tmp_path, picture):
    turned = picture.astype(np.float64)[::-1].transpose(1, 0, 2)[..., :3]
    write_exr(tmp_path / "p.exr", turned)
    assert (read_exr(tmp_path / "p.exr") == turned).all()


def test_header_keeps_attributes_and_other_programs_see_the_channels(tmp_path, picture):
    write_exr(tmp_path / "p.exr", picture, {"material": "chrome", "exposure": 0.5})
    with OpenEXR.File(str(tmp_path / "p.exr"), separate_channels=True) as file:
        header, channels = file.header(), file.channels()
        assert (header["material"], header["exposure"]) == ("chrome", 0.5)
        assert header["compression"] == OpenEXR.ZIP_COMPRESSION
        assert sorted(channels) == ["A", "B", "G", "R"]
        assert (channels["G"].pixels == picture[..., 1]).all()


def test_parts_keep_their_names_order_and_pixels(tmp_path, picture):
    parts = {"reference": picture[..., :3], "naive": picture[..., 1:], "bivariate": picture}
    write_exr_parts(tmp_path / "p.exr", parts)
    with OpenEXR.File(str(tmp_path / "p.exr")) as file:
        assert [part.name() for part in file.parts] == list(parts)
        for part, (name, pixels) in zip(file.parts, parts.items(), strict=True):
            found = part.channels["RGBA" if name == "bivariate" else "RGB"].pixels
            assert (found == pixels).all()
    assert (read_exr(tmp_path / "p.exr") == parts["reference"]).all()
    again = read_exr_parts(tmp_path / "p.exr")
    assert list(again) == list(parts)
    assert all((again[name] == pixels).all() for name, pixels in parts.items())


def test_the_same_picture_gives_the_same_bytes(tmp_path, picture):
    for name in ("a", "b"):
        write_exr(tmp_path / f"{name}.exr", picture, {"material": "chrome"})
        write_exr_parts(tmp_path / f"{name}s.exr", {"x": picture, "y": picture})
        write_png(tmp_path / f"{name}.png", tone_map(picture[..., :3], 0.02, 2.2))
    for suffix in (".exr", "s.exr", ".png"):
        assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


@pytest.mark.parametrize("shape", [(4, 4), (4, 4, 2), (1, 4, 4, 3)])
def test_arrays_that_are_no_pictures_leave_no_file(tmp_path, shape):
    with pytest.raises(ValueError, match="height, width, 3 or 4"):
        write_exr(tmp_path / "p.exr", np.ones(shape))
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_cannot_be_read_is_told_in_one_line(tmp_path, picture):
    write_exr(tmp_path / "p.exr", picture)
    whole = (tmp_path / "p.exr").read_bytes()
    (tmp_path / "half.exr").write_bytes(whole[: len(whole) - 20])
    (tmp_path / "text.exr").write_text("not a picture")
    write_png(tmp_path / "p.png", tone_map(picture[..., :3], 1, 2.2))
    (tmp_path / "p.png").rename(tmp_path / "png.exr")
    grey = {"Y": np.ones((4, 4), dtype=np.float32)}
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, grey) as file:
        file.write(str(tmp_path / "grey.exr"))
    for name, message in {
        "absent": "no such file",
        "half": "cut off or damaged",
        "text": "not an OpenEXR file",
        "png": "not an OpenEXR file",
        "grey": "channels Y; red, green and blue",
    }.items():
        with pytest.raises(NpfmError, match=message) as caught:
            read_exr(tmp_path / f"{name}.exr")
        assert str(tmp_path / f"{name}.exr") in str(caught.value)
        assert "\n" not in str(caught.value)


def test_tone_mapping_is_the_papers():
    # 1 - 2^(-0.02 x 50) = 1/2, and (1/2)^(1/2.2) x 255 = 186.08.
    radiance = np.array([-1.0, 0.0, 50.0, 100.0, 1e9])
    expected = [0, 0, 186, round(255 * 0.75 ** (1 / 2.2)), 255]
    assert tone_map(radiance, 0.02, 2.2).tolist() == expected
    assert tone_map([1.0], 1, 2.8).tolist() == [round(255 * 0.5 ** (1 / 2.8))]


def test_tone_mapping_never_falls_with_radiance():
    values = tone_map(np.geomspace(1e-6, 1e4, 10_000), 0.02, 2.2)
    assert values.dtype == np.uint8
    assert (np.diff(values.astype(int)) >= 0).all()
    assert set(range(20, 250)) <= set(values.tolist())


def test_layers_are_mixed_as_they_are_shown():
    """An edge across pixels, against its picture of 16 times the resolution."""
    fine, pixels = 128, 8
    rng = np.random.default_rng(0)
    row, column = np.mgrid[:fine, :fine]
    inside = 3 * row + 2 * column < 2.6 * fine
    bright, dark = rng.random((2, pixels, pixels, 3)).astype(np.float32) * [[[[500]]], [[[20]]]]
    colour = np.where(
        inside[..., None], *(np.kron(c, np.ones((16, 16, 1))) for c in (dark, bright))
    )
    shown = 1 - 2 ** (-0.02 * colour)
    shown = shown.reshape(pixels, 16, pixels, 16, 3).mean(axis=(1, 3))
    share = inside.reshape(pixels, 16, pixels, 16).mean(axis=(1, 3)).astype(np.float32)
    layers = [(dark * share[..., None], share), (bright * (1 - share[..., None]), 1 - share)]
    found = tone_map_layers(layers, 0.02, 2.2)
    np.testing.assert_allclose(found, 255 * shown ** (1 / 2.2), atol=0.51)
    for k, whole in enumerate((dark, bright)):
        alone = share == 1 - k
        assert alone.any()
        np.testing.assert_array_equal(found[alone], tone_map(whole, 0.02, 2.2)[alone])
    assert np.abs(found - tone_map(sum(c for c, _ in layers), 0.02, 2.2).astype(float)).max() > 20


def test_png_holds_the_display_values(tmp_path):
    values = np.random.default_rng(0).integers(0, 256, (6, 9, 3), dtype=np.uint8)
    write_png(tmp_path / "p.png", values)
    with Image.open(tmp_path / "p.png") as file:
        assert (file.format, file.mode) == ("PNG", "RGB")
        assert (np.asarray(file) == values).all()
