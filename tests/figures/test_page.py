import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text

from npfm.errors import NpfmError
from npfm.figures import page, style
from npfm.storage.pictures import write_png

SCENES, VARIANTS = ["A", "B"], ["naive", "bivariate"]


@pytest.fixture
def run(tmp_path):
    for scene in SCENES:
        for k, variant in enumerate(["measured", *VARIANTS]):
            picture = np.full((8, 8, 3), 60 * k, dtype=np.uint8)
            write_png(tmp_path / "renders" / scene / "chalk" / f"{variant}.png", picture)
    return tmp_path


def table(variants):
    rows = [(s, "chalk", v, 40.04 + k) for k, s in enumerate(SCENES) for v in variants]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])


@pytest.fixture
def psnr():
    return table(VARIANTS)


def many(run, count):
    """More variants, with names as long as those of the published fits."""
    names = [*VARIANTS, *(f"shifted-gamma-published{k:02}" for k in range(count - len(VARIANTS)))]
    for scene in SCENES:
        for name in names:
            picture = np.full((8, 8, 3), 60, dtype=np.uint8)
            write_png(run / "renders" / scene / "chalk" / f"{name}.png", picture)
    return names


def test_every_picture_is_there_with_its_decibels(run, psnr):
    figure = page.draw(run, psnr, "chalk", SCENES, VARIANTS)
    images = [ax.images[0].get_array().max() for ax in figure.axes]
    assert np.allclose(np.array(images) * 255, [0, 60, 120] * 2, atol=1)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels == ["", "40.0 dB", "40.0 dB", "", "41.0 dB", "41.0 dB"]


@pytest.mark.parametrize("count", [2, 16])
def test_no_text_is_clipped_or_covered(run, psnr, count):
    variants = many(run, count)
    figure = page.draw(run, table(variants), "chalk", SCENES, variants)
    assert figure.get_figwidth() <= style.PAGE_WIDTH
    assert sum(bool(ax.images) for ax in figure.axes) == len(SCENES) * (1 + count)
    with style.context():
        figure.draw_without_rendering()
    texts = [text for text in figure.findobj(Text) if text.get_text()]
    boxes = [text.get_window_extent() for text in texts]
    pictures = [(ax, ax.get_window_extent()) for ax in figure.axes]
    for k, box in enumerate(boxes):
        assert figure.bbox.contains(*box.min) and figure.bbox.contains(*box.max), texts[k]
        others = [*zip(texts[k + 1 :], boxes[k + 1 :], strict=True), *pictures]
        touched = [other for other, where in others if box.overlaps(where)]
        assert not touched, (texts[k], touched)


def test_the_same_pictures_give_the_same_bytes(run, psnr, tmp_path):
    for name in ("a.png", "b.png"):
        style.save(page.draw(run, psnr, "chalk", SCENES, VARIANTS), [tmp_path / name])
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_variant_without_a_fit_is_left_out_and_named(run, psnr):
    figure = page.draw(run, psnr, "chalk", SCENES, ["gone", *VARIANTS])
    titles = [ax.get_title() for ax in figure.axes]
    assert titles == ["measured", *VARIANTS] * 2
    assert figure.get_suptitle() == "chalk (no fit: gone)"


def test_a_missing_picture_is_named(run, psnr):
    with pytest.raises(NpfmError, match=r"measured\.png: no such picture"):
        page.draw(run, psnr, "felt", SCENES, VARIANTS)
