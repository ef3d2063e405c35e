"""Figures of the study of sampling, from a small table and small pictures."""

import itertools

import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.evaluation.importance import COLUMNS, INDEPENDENT, SOBOL, gather
from npfm.figures import (
    estimators,
    importance,
    improvement,
    style,
    variance_images,
    variance_samples,
    ways,
)
from npfm.storage.pictures import write_exr_parts

#: n_var of one sample, by strategy and recipe.
NOISE = {
    ("cosine", ""): 100.0,
    ("factored", "paper"): 0.2,
    ("factored", "improved"): 0.05,
    ("light+half-vector", ""): 3.0,
    ("light+factored", "improved"): 1.0,
}
MATERIALS = ("nickel", "nylon")


def table():
    rows = []
    for light, (k, material) in itertools.product(("constant", "grace"), enumerate(MATERIALS)):
        for name, noise in NOISE.items():
            for samples in (1, 4, 16, 64):
                value = noise / (1 + k) / samples**0.5
                points = INDEPENDENT if samples == 1 else SOBOL
                seconds = 2e-7 if "factored" in name[0] else 1e-7
                about = (light, material, *name, points, samples)
                rows.append((*about, value, 0.9 * value, 1.1 * value, seconds))
    made = gather([pd.DataFrame(rows, columns=COLUMNS[:-1])])
    printed = (made["strategy"] == "cosine") & (made["material"] == "nickel")
    return made.assign(published=np.where(printed, 306.17, np.nan))


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("importance") / "variance.csv"
    tables.write(path, table())
    return str(path)


@pytest.fixture
def labelled(path):
    return ways.read_labelled(path, "published")


FIGURES = {
    "importance": lambda rows: importance.draw(rows, SOBOL),
    "improvement": lambda rows: improvement.draw(rows, ["cosine"]),
    "variance_samples": lambda rows: variance_samples.draw(rows, MATERIALS),
    "estimators": estimators.draw,
}


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.mpl_image_compare(style=["default", style.SETTINGS], savefig_kwargs={"dpi": 50})
def test_it_looks_as_it_did(name, labelled):
    return FIGURES[name](labelled)


def test_every_way_and_material_has_its_number_and_the_best_is_bold(labelled):
    figure = importance.draw(labelled, INDEPENDENT)
    panels = [ax for ax in figure.axes if ax.texts]
    assert len(panels) == 2
    texts = panels[0].texts
    assert [text.get_text() for text in texts[:4]] == ["100", "50", "0.2", "0.1"]
    assert [text.get_text() for text in texts if text.get_fontweight() == "bold"] == [
        "0.05",
        "0.025",
    ]
    names = [label.get_text() for label in panels[0].get_yticklabels()]
    assert names[1:4] == ["factored (paper)", "factored (improved)", "light + half-vector"]


@pytest.mark.parametrize(
    ("value", "text"), [(123.4, "120"), (0.01234, "0.012"), (2.0, "2"), (np.nan, "")]
)
def test_numbers_have_two_digits(value, text):
    assert importance.number(value) == text


def test_lines_have_the_slope_of_the_variance(labelled):
    figure = variance_samples.draw(labelled, ["nickel"])
    lines = figure.axes[0].get_lines()
    assert [line.get_label() for line in lines][:2] == ["cosine: -1.50", "factored (paper): -1.50"]
    np.testing.assert_allclose(lines[0].get_ydata(), 100 / np.array([4, 16, 64]) ** 1.5)
    with pytest.raises(NpfmError, match="no rows of 'brass'"):
        variance_samples.draw(labelled, ["brass"])
    assert np.isnan(variance_samples.slope(pd.Series([1, 2]), pd.Series([0.0, 0.0])))


def test_improvement_is_over_the_papers_recipe_with_what_was_printed(labelled):
    figure = improvement.draw(labelled, ["cosine"])
    ours, printed, improved = figure.axes[0].get_lines()[:3]
    np.testing.assert_allclose(ours.get_ydata(), 500)
    np.testing.assert_allclose(printed.get_ydata(), [306.17, np.nan])
    np.testing.assert_allclose(improved.get_ydata(), 0.25)


def test_gains_are_at_equal_samples_and_at_equal_seconds(labelled):
    gained = estimators.gains(labelled)
    assert set(gained["way"]) == {"light + factored (improved)"}
    np.testing.assert_allclose(gained["at equal samples"], 3)
    np.testing.assert_allclose(gained["at equal seconds"], 1.5)


def test_recipes_of_one_strategy_differ_in_their_marks():
    looks = ways.looks(["factored (paper)", "factored (improved)", "light + cosine"])
    first, second, other = looks.values()
    assert first.color == second.color != other.color
    assert (first.filled, second.filled) == (True, False)


@pytest.fixture
def images(tmp_path):
    parts = {}
    for k, name in enumerate(("cosine", "factored/improved")):
        part = np.zeros((4, 4, 4), dtype=np.float32)
        part[1:3, 1:3] = [10.0**-k, 1, 1, 1]
        parts[name] = part
    (tmp_path / "grace").mkdir()
    path = tmp_path / "grace/nickel.exr"
    write_exr_parts(path, parts)
    return path


def test_pictures_of_the_variance_are_on_one_scale(images):
    inside = np.full((4, 4), np.nan)
    inside[1:3, 1:3] = 1
    figure = variance_images.draw({"nickel": [10 * inside, inside]}, ["a", "b/c+d^2"])
    first, second = figure.axes[:2]
    assert [ax.get_xlabel() for ax in (first, second)] == ["10", "1"]
    assert second.get_title() == "b c + d,\npower 2"
    assert first.images[0].norm is second.images[0].norm


def test_a_part_that_is_not_there_is_told(images, capsys):
    call = f"figure variance_images --images {images} --ways light -o {images.parent}/a.png"
    assert main(call.split()) == 1
    assert "nickel.exr: no part 'light'; measure that way again" in capsys.readouterr().err


def test_the_verbs_draw_the_same_bytes_again(path, images, tmp_path):
    calls = {
        "importance": f"--table {path} --points sobol",
        "improvement": f"--table {path} --strategies cosine",
        "variance_samples": f"--table {path} --materials nickel",
        "variance_images": f"--images {images} --ways cosine factored/improved",
        "estimators": f"--table {path}",
    }
    for figure, arguments in calls.items():
        made = [tmp_path / f"{figure}-{k}.png" for k in range(2)]
        for file in made:
            assert main(f"figure {figure} {arguments} -o {file}".split()) == 0
        assert made[0].read_bytes() == made[1].read_bytes()
