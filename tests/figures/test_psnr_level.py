import numpy as np
import pandas as pd
from PIL import Image

from npfm.__main__ import main
from npfm.evaluation import tables
from npfm.evaluation.psnr_level import LEVELS
from npfm.figures import psnr_level

SETTINGS = ["as-configured", "touched"]


def table():
    rows = [
        (setting, scene, variant, 4, 40.0 + 5 * k + j, paper if scene == "all" else np.nan, 0.5)
        for k, setting in enumerate(SETTINGS)
        for scene in ("all", "A", "B", "C")
        for j, (variant, paper) in enumerate({"bivariate": 64.07, "mine": np.nan}.items())
    ]
    return pd.DataFrame(rows, columns=LEVELS)


def test_a_line_for_each_variant_and_the_papers_marks_where_they_belong():
    figure = psnr_level.draw(table(), {"mine": "#112233"})
    assert [ax.get_title(loc="left") for ax in figure.axes] == [
        "all scenes", "scene A", "scene B", "scene C",
    ]  # fmt: skip
    ticks = [[label.get_text() for label in ax.get_xticklabels()] for ax in figure.axes]
    assert ticks == [[*SETTINGS, "in the paper"], SETTINGS, SETTINGS, SETTINGS]
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert lines["bivariate"].get_ydata().tolist() == [40, 45]
    assert lines["mine"].get_color() == ("#112233", 0.5)
    marks = [line.get_ydata()[0] for line in figure.axes[0].lines if len(line.get_xdata()) == 1]
    assert 64.07 in marks


def test_what_is_not_finite_is_left_out():
    levels = table()
    levels.loc[0, "psnr_db"] = np.inf
    figure = psnr_level.draw(levels)
    assert np.isnan(figure.axes[0].lines[0].get_ydata()[0])


def test_the_verb_draws_the_same_twice(tmp_path):
    tables.write(tmp_path / "levels.csv", table())
    for name in ("a.png", "b.png"):
        call = f"figure psnr_level --levels {tmp_path}/levels.csv -o {tmp_path}/{name}"
        assert main(call.split()) == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert np.asarray(Image.open(tmp_path / "a.png")).std() > 10
