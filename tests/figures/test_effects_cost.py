import numpy as np
import pandas as pd
import pytest
from PIL import Image

from npfm.__main__ import main
from npfm.evaluation import tables
from npfm.evaluation.effects_cost import COLUMNS
from npfm.figures import effects_cost, style
from npfm.storage.pictures import write_exr_parts, write_png


def table():
    rows = []
    for scene in ("A", "B"):
        for effect in ("antialiasing", "visibility"):
            refused = (scene, effect) == ("A", "visibility")
            for on in (0, 1):
                changes = on and not refused
                rays = 3e6 if scene == "B" and changes else 0
                change = (-1.5, 20) if changes else (0, np.inf)
                rows.append((scene, effect, on, 5 + 2 * changes, rays, 4e6, 0, *change))
    return pd.DataFrame(rows, columns=COLUMNS)


def pictures():
    """Pictures of two scenes: the first cannot have visibility switched."""
    picture = np.ones((6, 6, 4), dtype=np.float32)
    picture[0] = [5, 5, 5, 0]  # background, which does not count for the peak
    picture[3, 3, 0] = 2
    darker = picture.copy()
    darker[2, 1, :3] -= 0.2
    return {
        "A": {"scene": picture, "antialiasing": darker},
        "B": {"scene": picture, "antialiasing": picture, "visibility": darker},
    }


def test_changes_are_in_decibels_of_the_peak_of_the_object():
    change = effects_cost.change_db(pictures()["B"], "visibility")
    assert change[2, 1] == pytest.approx(-20)  # 0.2 of 2
    change[2, 1] = -np.inf
    assert np.isneginf(change).all()


def test_an_effect_that_cannot_be_switched_changes_nothing():
    assert np.isneginf(effects_cost.change_db(pictures()["A"], "visibility")).all()


def test_every_effect_is_drawn_off_and_on_in_every_scene():
    figure = effects_cost.draw(table(), pictures(), [np.zeros((6, 6, 3))] * 2)
    panels = figure.subfigs[0].axes
    assert [ax.get_title() for ax in panels] == [panel[1] for panel in effects_cost.PANELS]
    labels = [label.get_text() for label in panels[0].get_yticklabels()]
    assert labels == ["A antialiasing", "A visibility", "B antialiasing", "B visibility"]
    rays = panels[1].get_lines()
    off, on = rays[-2:]
    assert (off.get_xdata()[0], on.get_xdata()[0]) == (0, 3)
    assert off.get_markerfacecolor() == "white" != on.get_markerfacecolor()
    below = [ax for ax in figure.subfigs[1].axes if ax.get_images() and not ax.get_label()]
    texts = [ax.get_xlabel() for ax in below]
    assert texts == ["", "", "3% of the pixels", "no change", "no change", "3% of the pixels"]


def test_the_verb_draws_the_same_bytes_again(tmp_path):
    tables.write(tmp_path / "effects.csv", table())
    changed, shown = [], []
    for scene, parts in pictures().items():
        changed.append(str(tmp_path / f"{scene}.exr"))
        shown.append(str(tmp_path / f"{scene}.png"))
        write_exr_parts(changed[-1], parts)
        write_png(shown[-1], np.zeros((6, 6, 3), dtype=np.uint8))
    outputs = [tmp_path / "figure.pdf", tmp_path / "figure.png"]
    call = ["figure", "effects_cost", "--table", str(tmp_path / "effects.csv")]
    call += ["--changed", *changed, "--shown", *shown, "-o", *map(str, outputs)]
    assert main(call) == 0
    first = [path.read_bytes() for path in outputs]
    assert main(call) == 0
    assert [path.read_bytes() for path in outputs] == first
    with Image.open(outputs[1]) as image:
        assert image.width == style.PAGE_WIDTH * style.DPI
