import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.evaluation.delta_e import mean_images
from npfm.evaluation.metrics import delta_e
from npfm.storage.pictures import write_exr, write_png

#: sRGB of #102030 and of #112233.
ONE, OTHER = (16, 32, 48), (17, 34, 51)


def picture(color, shape=(4, 4)):
    return np.broadcast_to(np.uint8(color), (*shape, 3)).copy()


@pytest.fixture
def folder(tmp_path):
    """Two materials; the second has no fit by one of the variants. The left half is foreground."""
    for material, variants in (("steel", ("ggx", "abc")), ("felt", ("ggx",))):
        (tmp_path / material).mkdir()
        coverage = np.repeat([[1, 1, 0.5, 0]], 4, axis=0)
        write_exr(tmp_path / material / "measured.exr", np.dstack([np.ones((4, 4, 3)), coverage]))
        write_png(tmp_path / material / "measured.png", picture((255, 255, 255)))
        for variant in variants:
            write_png(tmp_path / material / f"{variant}.png", picture((255, 255, 255)))
    write_png(tmp_path / "felt" / "ggx.png", picture((0, 0, 0)))
    return tmp_path


def test_black_and_white_are_100_apart():
    assert delta_e(picture((0, 0, 0)), picture((255, 255, 255))) == pytest.approx(100, abs=1e-3)


def test_equal_pictures_do_not_differ_and_the_order_does_not_matter():
    assert (delta_e(picture(ONE), picture(ONE)) == 0).all()
    one, other = delta_e(picture(ONE), picture(OTHER)), delta_e(picture(OTHER), picture(ONE))
    np.testing.assert_allclose(one, other, rtol=1e-9)
    assert 0 < one.max() < 1.5


def test_alpha_does_not_count():
    rgba = np.dstack([picture(ONE), np.full((4, 4), 7, np.uint8)])
    np.testing.assert_array_equal(
        delta_e(rgba, picture(OTHER)), delta_e(picture(ONE), picture(OTHER))
    )


def test_means_over_the_materials_that_have_a_picture(folder):
    images, table = mean_images(folder, {"ggx": folder, "abc": folder}, ["steel", "felt"])
    np.testing.assert_allclose(images["ggx"][:, :2], 50, atol=1e-3)
    assert (images["abc"][:, :2] == 0).all()
    assert all(np.isnan(image[:, 2:]).all() for image in images.values())
    values = table.set_index(["material", "variant"]).delta_e
    assert values["steel", "ggx"] == values["steel", "abc"] == 0
    assert values["felt", "ggx"] == pytest.approx(100, abs=1e-3)
    assert ("felt", "abc") not in values.index


def test_what_is_missing_or_of_another_size_is_said(folder):
    with pytest.raises(NpfmError, match="no picture of 'naive'"):
        mean_images(folder, {"naive": folder}, ["steel"])
    with pytest.raises(NpfmError, match=r"glass.measured\.exr: no such file"):
        mean_images(folder, {"ggx": folder}, ["glass"])
    write_png(folder / "steel" / "ggx.png", picture(ONE, (2, 2)))
    with pytest.raises(NpfmError, match="of another size"):
        mean_images(folder, {"ggx": folder}, ["steel"])
