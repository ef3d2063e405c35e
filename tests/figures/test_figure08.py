import argparse
import math
import time

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import quality, tables
from npfm.figures import figure08, own_colors, style

MATERIALS = ["wood", "chrome", "felt"]
PSNR = {
    ("A", "independent-g"): [30, 50, 40],
    ("B", "independent-g"): [50, 60, 20],
    ("A", "naive"): [20, 45, 35],
    ("B", "naive"): [40, 55, 15],
}


def long_table(values):
    rows = [
        (scene, material, variant, value)
        for (scene, variant), column in values.items()
        for material, value in zip(MATERIALS, column, strict=True)
    ]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "value"])


def drawn(ax):
    return [np.asarray(line.get_ydata(), dtype=float).tolist() for line in ax.get_lines()]


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_sorted_by_decreasing_error_of_independent_g():
    assert figure08.by_error(long_table(PSNR)) == ["felt", "wood", "chrome"]  # 30, 40, 55 dB


def test_equal_pictures_come_behind_and_unknown_ones_last():
    infinite = long_table(PSNR | {("A", "independent-g"): [30, math.inf, 40]})
    assert figure08.by_error(infinite) == ["felt", "wood", "chrome"]
    missing = long_table(PSNR).drop(0)
    assert figure08.by_error(missing) == ["felt", "chrome", "wood"]


def test_sorted_by_increasing_diffuseness_of_those_in_the_table():
    known = pd.DataFrame(
        {"material": ["felt", "chalk", "wood", "chrome"], "diffuseness": [3.0, 3.1, 0.5, 0.01]}
    )
    assert figure08.by_diffuseness(long_table(PSNR), known) == ["chrome", "wood", "felt"]
    with pytest.raises(NpfmError, match="no diffuseness of chrome, wood"):
        figure08.by_diffuseness(long_table(PSNR), known[:2])


def test_sorting_by_error_needs_independent_g():
    table = long_table({("A", "naive"): [1, 2, 3]})
    with pytest.raises(NpfmError, match="no PSNR of independent-g"):
        figure08.by_error(table)


def test_mean_above_and_every_scene_below():
    figure = figure08.draw(long_table(PSNR), ["felt", "wood", "chrome"], "material")
    mean, a, b = figure.axes
    assert drawn(mean) == [[30, 40, 55], [25, 30, 50]]
    assert drawn(a) == [[40, 30, 50], [35, 20, 45]]
    assert drawn(b) == [[20, 50, 60], [15, 40, 55]]
    assert legend(figure) == ["independent-g: 41.67 dB", "naive: 35.00 dB"]
    assert [ax.get_ylabel() for ax in figure.axes] == ["PSNR (dB)"] * 3
    names = [label.get_text() for label in b.get_xticklabels()]
    assert names == ["felt", "wood", "chrome"]


def test_one_scene_has_one_panel():
    table = long_table({("A", "naive"): [1, 2, 3]})
    [ax] = figure08.draw(table, MATERIALS, "material").axes
    assert ax.get_title("left") == "scene A"
    assert drawn(ax) == [[1, 2, 3]]


def test_missing_and_infinite_values_are_gaps_and_counted(tmp_path):
    values = {
        ("A", "independent-g"): [30, math.inf, 40],
        ("B", "independent-g"): [50, 60, math.nan],
        ("A", "naive"): [math.inf] * 3,
    }
    figure = figure08.draw(long_table(values), MATERIALS, "material")
    mean, a, b = (np.array(drawn(ax)) for ax in figure.axes)
    nan = np.nan
    np.testing.assert_array_equal(mean, [[40, nan, nan], [nan, nan, nan]])
    np.testing.assert_array_equal(a, [[30, nan, 40], [nan, nan, nan]])
    np.testing.assert_array_equal(b, [[50, 60, nan], [nan, nan, nan]])
    assert legend(figure) == ["independent-g: 40.00 dB, 2 gaps", "naive: nothing finite, 3 gaps"]
    style.save(figure, [tmp_path / "gaps.pdf"])
    assert (tmp_path / "gaps.pdf").stat().st_size > 0


def test_a_hundred_names_do_not_touch_and_nothing_is_clipped():
    names = [f"specular-orange-phenolic-{i:02}" for i in range(100)]
    variants = [*style.LOOKS, *(f"another-variant-{i}" for i in range(9))]
    rows = [("A", m, v, 40.0 + i) for i, v in enumerate(variants) for m in names]
    table = pd.DataFrame(rows, columns=["scene", "material", "variant", "value"])
    figure = figure08.draw(table, names, "material")
    figure.draw_without_rendering()
    [ax] = figure.axes
    labels = ax.get_xticklabels()
    boxes = [label.get_window_extent() for label in labels]
    pitch = np.diff([(box.x0 + box.x1) / 2 for box in boxes]) * 72 / figure.dpi
    assert 4 < labels[0].get_fontsize() < pitch.min()
    page = figure.bbox
    for box in (*boxes, figure.legends[0].get_window_extent(), ax.get_tightbbox()):
        assert page.x0 <= box.x0 <= box.x1 <= page.x1
        assert page.y0 <= box.y0 <= box.y1 <= page.y1
    # the panel keeps its height whatever the names and the legend take
    assert ax.get_window_extent().height > 0.85 * figure08.MEAN_HEIGHT * figure.dpi


def test_all_looks_differ_and_what_is_published_has_the_colour_of_our_fit():
    assert len(set(style.LOOKS.values())) == len(style.LOOKS) >= 13
    for name in ("shifted-gamma", "cook-torrance"):
        ours, theirs = style.LOOKS[name], style.LOOKS[f"{name}-published"]
        assert ours.color == theirs.color
        assert (ours.filled, theirs.filled) == (True, False)
        assert theirs.mark["markerfacecolor"] == "white"


def test_variants_keep_their_looks_and_others_differ():
    others = [f"other-{i}" for i in range(12)]
    looks = style.looks(["naive", *others, "bivariate"])
    assert looks["naive"] == style.LOOKS["naive"]
    assert looks["bivariate"] == style.LOOKS["bivariate"]
    assert len(set(looks.values())) == 14


def test_a_colour_of_the_users_takes_the_place_of_ours():
    looks = style.looks(["naive", "bivariate"], {"naive": "#123456"})
    assert looks["naive"].color == "#123456"
    assert looks["naive"].marker == style.LOOKS["naive"].marker
    assert looks["bivariate"] == style.LOOKS["bivariate"]
    with pytest.raises(NpfmError, match="'naive' is not written"):
        own_colors.colors(argparse.Namespace(colors=["naive"]))


def test_the_verb_draws_the_same_bytes_again(tmp_path, monkeypatch):
    psnr, materials = str(tmp_path / "psnr.csv"), str(tmp_path / "materials.csv")
    tables.write(psnr, long_table(PSNR).rename(columns={"value": "psnr_db"}))
    tables.write(materials, pd.DataFrame({"material": MATERIALS, "diffuseness": [0.5, 0.01, 3.0]}))
    outputs = [tmp_path / "figure08.pdf", tmp_path / "figure08.png"]
    call = ["figure", "figure08", "--psnr", psnr, "--materials", materials]
    call += ["--order", "diffuseness", "-o", *map(str, outputs)]
    assert main(call) == 0
    first = [path.read_bytes() for path in outputs]
    later = time.time() + 86_400
    monkeypatch.setattr(time, "time", lambda: later)
    assert main(call) == 0
    assert [path.read_bytes() for path in outputs] == first
    with Image.open(outputs[1]) as image:
        assert image.width == style.PAGE_WIDTH * style.DPI
    assert b"CreationDate" not in first[0]
    assert b"/FontType 42" in first[0] or b"/CIDFontType2" in first[0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--order", "diffuseness", "-o", "x.pdf"], "needs --materials"),
        (
            ["--order", "error", "-o", "x.pdf", "x.jpg"],
            "x.jpg: a figure is written as .pdf or .png",
        ),
        (
            ["--order", "diffuseness", "--materials", "known.csv", "-o", "x.pdf"],
            "known.csv: no diffuseness of chrome, felt",
        ),
    ],
)
def test_mistakes_are_told_in_one_line(tmp_path, options, message, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tables.write("psnr.csv", long_table(PSNR).rename(columns={"value": "psnr_db"}))
    tables.write("known.csv", pd.DataFrame({"material": ["wood"], "diffuseness": [0.5]}))
    assert main(["figure", "figure08", "--psnr", "psnr.csv", *options]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert message in error
    assert {path.name for path in tmp_path.iterdir()} == {"psnr.csv", "known.csv"}


def test_another_metric_has_its_label_and_its_best_side(tmp_path):
    rows = [
        ("all", material, variant, "logarithm", value, "1", "lower")
        for variant in ("independent-g", "naive")
        for material, value in zip(MATERIALS, (0.5, 0.125, 0.25), strict=True)
    ]
    table = pd.DataFrame(rows, columns=quality.COLUMNS)
    tables.write(tmp_path / "quality.csv", table)
    call = ["figure", "figure08", "--order", "error", "-o", str(tmp_path / "a.png")]
    asked = ["--quality", str(tmp_path / "quality.csv"), "--metric", "logarithm"]
    assert main([*call, *asked]) == 0
    values = quality.values_of(table, "logarithm")
    metric = quality.METRICS["logarithm"]
    order = figure08.by_error(values, metric)
    assert order == ["wood", "felt", "chrome"]
    figure = figure08.draw(values, order, "material", metric=metric)
    [ax] = figure.axes
    assert drawn(ax)[0] == [0.5, 0.25, 0.125]
    assert ax.get_ylabel() == "logarithms of tables (lower is better)"
    assert legend(figure) == ["independent-g: 0.2917", "naive: 0.2917"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--psnr {table} --metric ssim", "--metric needs --quality"),
        ("--quality {table}", "--quality needs --metric"),
        ("--quality {table} --metric ssmi", "unknown metric 'ssmi'; did you mean ssim?"),
        ("--quality {table} --metric ssim", "no value of 'ssim'"),
    ],
)
def test_a_metric_goes_with_its_table(tmp_path, capsys, words, message):
    table = pd.DataFrame([("A", "felt", "naive", "hyab", 1.0, "1", "lower")])
    tables.write(tmp_path / "table.csv", table.set_axis(list(quality.COLUMNS), axis=1))
    call = f"figure figure08 --order error {words} -o {tmp_path}/a.png"
    assert main(call.format(table=tmp_path / "table.csv").split()) == 1
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1
