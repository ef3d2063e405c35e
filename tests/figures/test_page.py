import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text

from npfm.errors import NpfmError
from npfm.figures import page, style
from npfm.pictures import write_png

SCENES, VARIANTS = ["A", "B"], ["naive", "bivariate"]


@pytest.fixture
def run(tmp_path):
    for scene in SCENES:
        for k, variant in enumerate(["measured", *VARIANTS]):
            picture = np.full((8, 8, 3), 60 * k, dtype=np.uint8)
            write_png(tmp_path / "renders" / scene / "chalk" / f"{variant}.png", picture)
    return tmp_path


@pytest.fixture
def psnr():
    rows = [(s, "chalk", v, 40.04 + k) for k, s in enumerate(SCENES) for v in VARIANTS]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])


def test_every_picture_is_there_with_its_decibels(run, psnr):
    figure = page.draw(run, psnr, "chalk", SCENES, VARIANTS)
    images = [ax.images[0].get_array().max() for ax in figure.axes]
    assert np.allclose(np.array(images) * 255, [0, 60, 120] * 2, atol=1)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels == ["", "40.0 dB", "40.0 dB", "", "41.0 dB", "41.0 dB"]


def test_no_text_is_clipped_or_covered(run, psnr):
    figure = page.draw(run, psnr, "chalk", SCENES, VARIANTS)
    with style.context():
        figure.draw_without_rendering()
    texts = [text for text in figure.findobj(Text) if text.get_text()]
    boxes = [text.get_window_extent() for text in texts]
    pictures = [ax.get_window_extent() for ax in figure.axes]
    for k, box in enumerate(boxes):
        assert figure.bbox.contains(*box.min) and figure.bbox.contains(*box.max), texts[k]
        others = boxes[k + 1 :] + pictures
        assert not any(box.overlaps(other) for other in others), texts[k]


def test_the_same_pictures_give_the_same_bytes(run, psnr, tmp_path):
    for name in ("a.png", "b.png"):
        style.save(page.draw(run, psnr, "chalk", SCENES, VARIANTS), [tmp_path / name])
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_missing_picture_is_named(run, psnr):
    with pytest.raises(NpfmError, match=r"measured\.png: no such picture"):
        page.draw(run, psnr, "felt", SCENES, VARIANTS)
