"""Figures 9 to 14: rows of renderings, close-ups, scores and error maps."""

import itertools

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.figures import (
    figure09,
    figure10,
    figure11,
    figure12,
    figure13,
    figure14,
    renderings,
    scores,
    style,
)
from npfm.figures.compared import OTHERS, compared
from npfm.papers import bagher2016
from npfm.storage.pictures import write_exr, write_png

SIZE = 20
SCENES, MATERIALS = ["A", "B"], ["chrome", "nylon", "pink-felt"]
#: Error of the display values of each variant, in the lower right of each picture.
ERRORS = {"independent-g": 8, "naive": 40, "bivariate": 20, "abc-e2": 60, "tucker-20": 2}
#: The same, of single pictures.
MORE = {("A", "chrome", "independent-g"): 90, ("B", "nylon", "independent-g"): 50}


def radiance(error):
    pixels = np.full((SIZE, SIZE, 4), 0.25, dtype=np.float32)
    pixels[12:16, 12:16, :3] += error / 100
    pixels[..., 3] = 0
    pixels[3:18, 3:18, 3] = 1
    return pixels


def display(error):
    pixels = np.full((SIZE, SIZE, 3), 100, dtype=np.uint8)
    pixels[12:16, 12:16] += np.uint8(error)
    return pixels


def decibels(material, variant):
    return {"bivariate": 55.0 if material == "chrome" else 35.0}.get(variant, 60 - ERRORS[variant])


@pytest.fixture
def run(tmp_path):
    for scene, material in itertools.product(SCENES, MATERIALS):
        folder = tmp_path / "renders" / scene / material
        for variant, error in {"measured": 0, **ERRORS}.items():
            error = MORE.get((scene, material, variant), error)
            folder.mkdir(parents=True, exist_ok=True)
            write_png(folder / f"{variant}.png", display(error))
            write_exr(folder / f"{variant}.exr", radiance(error))
    return tmp_path


@pytest.fixture
def psnr():
    rows = [(s, m, v, decibels(m, v)) for s, m, v in itertools.product(SCENES, MATERIALS, ERRORS)]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])


def without(psnr, variant, material):
    return psnr[(psnr["variant"] != variant) | (psnr["material"] != material)]


def pictures(figure):
    return [ax for ax in figure.axes if ax.images]


def rows(figure):
    return [label for ax in pictures(figure) if (label := ax.get_ylabel().replace("\n", " "))]


def corner_labels(figure):
    return [[text.get_text() for text in ax.texts] for ax in pictures(figure)]


def drawn(run, psnr, name):
    non_parametric = ["independent-g", "naive"]
    return {
        "figure09": lambda: figure09.draw(run, psnr, non_parametric, ["nylon", "chrome"]),
        "figure10": lambda: figure10.draw(run, psnr, non_parametric),
        "figure11": lambda: figure11.draw(run, psnr, ["independent-g", "bivariate"]),
        "figure12": lambda: figure12.draw(run, psnr, ["independent-g", "abc-e2"], ["nylon"]),
        "figure13": lambda: figure13.draw(run, psnr, ["independent-g", "tucker-20"], ["nylon"]),
        "figure14": lambda: figure14.draw(run, psnr, ["independent-g", "abc-e2"], ["nylon"]),
    }[name]()


def test_measurement_and_fits_stand_side_by_side_with_their_decibels(run, psnr):
    shown = [renderings.Row("nylon", "A"), renderings.Row("chrome", "B")]
    figure, axes = renderings.draw(run, psnr, shown, ["naive", "tucker-20"])
    assert [ax.get_title() for ax in axes[0]] == ["measured", "naive", "tucker-20"]
    assert rows(figure) == ["nylon scene A", "chrome scene B"]
    assert corner_labels(figure) == [[], ["20.0 dB"], ["58.0 dB"]] * 2
    brightest = [round(ax.images[0].get_array().max() * 255) for ax in axes.flat]
    assert brightest == [100, 140, 102] * 2


def test_a_figure_is_as_wide_as_a_page_or_a_column_and_its_pictures_are_square(run, psnr):
    shown = [renderings.Row("nylon", "A")]
    for variants, width in ((["naive"], 3.33), (["naive", "abc-e2", "tucker-20"], 7.0)):
        figure, axes = renderings.draw(run, psnr, shown, variants)
        figure.draw_without_rendering()
        assert figure.get_figwidth() == width
        for ax in axes.flat:
            box = ax.get_window_extent()
            assert box.width == pytest.approx(box.height, abs=0.1)


@pytest.mark.parametrize("number", range(9, 15))
@pytest.mark.parametrize("gap", [False, True])
def test_no_text_is_clipped_or_covered_by_text(run, psnr, number, gap):
    if gap:
        for variant in ("naive", "bivariate", "abc-e2", "tucker-20"):
            psnr = without(psnr, variant, "chrome")
    figure = drawn(run, psnr, f"figure{number:02}")
    with style.context():
        figure.draw_without_rendering()
    texts = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    boxes = [text.get_window_extent() for text in texts]
    for k, box in enumerate(boxes):
        assert figure.bbox.contains(*box.min) and figure.bbox.contains(*box.max), texts[k]
        touched = [texts[j] for j in range(k) if box.overlaps(boxes[j])]
        assert not touched, (texts[k], touched)


@pytest.mark.parametrize("name", OTHERS)
@pytest.mark.mpl_image_compare(style=["default", style.SETTINGS], savefig_kwargs={"dpi": 50})
def test_it_looks_as_it_did(run, psnr, name):
    return drawn(run, psnr, name)


def test_the_same_pictures_give_the_same_bytes(run, psnr, tmp_path):
    names = ["figure09.png", "figure12.pdf", "figure14.pdf"]
    written = []
    for _ in range(2):
        for name in names:
            style.save(drawn(run, psnr, name.partition(".")[0]), [tmp_path / name])
        written.append([(tmp_path / name).read_bytes() for name in names])
    assert written[0] == written[1]


def test_the_window_is_where_pictures_differ_and_tells_how_much():
    found = renderings.window([display(0) / 255.0, display(51) / 255.0])
    assert (found.row, found.column, found.side) == (12, 12, SIZE // renderings.WINDOWS)
    assert found.difference == pytest.approx(0.2)


def test_each_material_is_shown_where_its_fits_are_wrong_most_visibly(run, psnr):
    figure = figure09.draw(run, psnr, ["independent-g", "tucker-20"], ["nylon", "chrome"])
    assert rows(figure) == ["nylon scene B", "chrome scene A"]


def test_a_close_up_shows_its_window_in_a_free_corner(run, psnr):
    figure = figure09.draw(run, psnr, ["independent-g", "naive"], ["nylon"])
    for ax in pictures(figure):
        [inset] = ax.child_axes
        [frame] = ax.patches
        close = inset.images[0].get_array()
        whole = ax.images[0].get_array()
        column, row = (round(value + 0.5) for value in frame.get_xy())
        side = round(frame.get_width())
        assert (row, column, side) == (12, 12, 4)
        np.testing.assert_array_equal(close, whole[row : row + side, column : column + side])


def test_an_inset_hides_neither_its_window_nor_more_of_the_object_than_it_must():
    nothing, everything = np.zeros((10, 10), dtype=bool), np.ones((10, 10), dtype=bool)
    upper_left, upper_right, lower_right = figure09.CORNERS
    here = renderings.Window(0, 0, 2, 1.0)
    assert figure09.emptiest_corner(nothing, here) == upper_right
    assert figure09.emptiest_corner(everything, renderings.Window(0, 8, 2, 1.0)) == upper_left
    upper = everything.copy()
    upper[5:] = False
    assert figure09.emptiest_corner(upper, here) == lower_right


def test_worst_materials_come_first_each_once(run, psnr):
    figure = figure10.draw(run, psnr, ["independent-g", "naive"])
    assert rows(figure) == ["chrome scene A", "nylon scene B", "pink-felt scene A"]


def test_gains_of_the_bivariate_model_come_before_its_losses():
    index = pd.MultiIndex.from_product([list("abcdefg"), SCENES], names=["material", "scene"])
    gain = pd.Series(np.repeat([1.0, -1.0, 2.0, -3.0, 4.0, -2.0, 3.0], 2), index)
    gain["d", "A"] = 1.0  # a loss on the mean still
    assert figure11.extremes(gain) == (["e", "g", "c"], ["f", "b"])
    assert figure11.extremes(gain[["a"]]) == (["a"], [])


def test_materials_of_figure_11_are_the_extremes_of_the_table(run, psnr):
    figure = figure11.draw(run, psnr, ["independent-g", "bivariate"])
    assert [row.split()[0] for row in rows(figure)] == ["chrome", "nylon", "pink-felt"]


def test_scores_stand_beside_the_papers():
    rows = [("A", f"m{k}", v, 50.0 - k * (v == "abc-e2")) for k in range(6) for v in ERRORS]
    psnr = pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])
    counted = scores.count(psnr, "independent-g", ["abc-e2", "naive"])
    assert list(counted) == ["abc-e2", "naive", "paper: Loew et al. 2012"]
    assert (counted["abc-e2"].wins, counted["abc-e2"].ties) == (3, 3)
    assert counted["paper: Loew et al. 2012"].compared == 400


def test_bars_are_as_long_as_the_counts_say_and_say_them(run, psnr):
    psnr = without(psnr, "abc-e2", "chrome")
    figure = figure12.draw(run, psnr, ["independent-g", "abc-e2"], ["nylon"])
    ax = figure.axes[-1]
    assert ax.get_xlabel() == "share of the renderings (%)"
    widths = [bar.get_width() for bar in ax.patches]
    assert widths == pytest.approx([100, 0, 0, 77, 21.25, 1.75])
    texts = [text.get_text() for text in ax.texts]
    assert "abc-e2: 4 better, 0 tied, 0 worse, 2 missing" in texts
    assert "paper: Loew et al. 2012: 308 better, 85 tied, 7 worse" in texts
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "independent-g better",
        "within 2 dB",
        "worse",
    ]


def test_the_papers_counts_make_its_percentages():
    loew, bilgili = bagher2016.HEAD_TO_HEAD.values()
    assert sum(loew) == sum(bilgili) == 400
    assert [round(100 * count / 400) for count in loew[:2]] == [77, 21]
    assert round(100 * bilgili[1] / 400, 1) == 17.8


def test_an_error_map_is_a_share_of_the_largest_error_of_ours(run, psnr):
    figure = figure14.draw(run, psnr, ["independent-g", "abc-e2"], ["pink-felt"])
    assert rows(figure) == ["pink-felt scene A", "pink-felt scene B"]
    ours, other = (ax.images[0].get_array() for ax in pictures(figure)[:2])
    outside = np.ones((SIZE, SIZE), dtype=bool)
    outside[3:18, 3:18] = False
    for values, error in ((ours, 1.0), (other, 60 / 8)):
        np.testing.assert_array_equal(values.mask, outside)
        assert values[13, 13] == pytest.approx(error, rel=1e-5)
        assert values[5, 5] == 0
    # 3 channels, each wrong by 0.08
    assert corner_labels(figure)[:2] == [["1 = 0.24"], ["up to 7.5"]]
    assert "independent-g" in figure.axes[-1].get_xlabel()
    assert all(ax.images[0].get_clim() == (0, 1) for ax in pictures(figure))


def test_pictures_that_a_variant_lacks_are_left_out_and_counted(run, psnr):
    figure = figure10.draw(run, without(psnr, "naive", "chrome"), ["independent-g", "naive"])
    assert [row.split()[0] for row in rows(figure)] == ["nylon", "pink-felt"]
    said = " ".join(text.get_text() for text in figure.texts)
    assert said == "left out of 6 renderings, for want of a fit or a PSNR: naive 2"


def test_a_picture_that_the_table_has_and_the_run_lacks_is_named(run, psnr):
    (run / "renders" / "B" / "nylon" / "naive.png").unlink()
    with pytest.raises(NpfmError, match=r"B/nylon/naive\.png: no such picture"):
        figure10.draw(run, psnr, ["independent-g", "naive"])


def test_nothing_to_compare_is_told(run, psnr):
    with pytest.raises(NpfmError, match="no picture that all of independent-g, gone have"):
        figure10.draw(run, psnr, ["independent-g", "gone"])


def test_a_figure_compares_what_the_run_has():
    assert compared(["naive", "bivariate"]) == {}
    assert compared(["abc-ours", "independent-g", "naive", "abc-published"]) == {
        "figure09": ["independent-g", "naive"],
        "figure10": ["independent-g", "naive"],
        "figure12": ["independent-g", "abc-published", "abc-ours"],
        "figure14": ["independent-g", "abc-published", "abc-ours"],
    }


@pytest.mark.parametrize("number", range(9, 15))
def test_the_verb_draws_every_figure(run, psnr, number):
    tables.write(run / "psnr.csv", psnr)
    name = f"figure{number:02}"
    variants = compared(ERRORS)[name]
    call = ["figure", name, "--run", str(run), "--psnr", str(run / "psnr.csv")]
    assert main([*call, "--variants", *variants, "-o", str(run / "x.png")]) == 0
    assert (run / "x.png").stat().st_size > 1000
