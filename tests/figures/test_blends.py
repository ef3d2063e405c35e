import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.evaluation import blends, tables
from npfm.figures import blends as figure
from npfm.storage.pictures import write_exr_parts

WAYS = ["tables", "log-factors", "same-albedo"]


def made():
    costs = pd.DataFrame(
        [(way, "A", 1, 3, 1, 1, 1, 4, 0.1, 0.2, "", 40.0) for way in ["measured", *WAYS]],
        columns=blends.COSTS,
    )
    pairs = [("a", "b"), ("b", "c"), ("c", "d")]
    rows = [
        (k, *pairs[k], way, 1.0, 9.0, 0.8) for k in range(3) for way in ("first", "second", *WAYS)
    ]
    half = pd.DataFrame(rows, columns=blends.HALF_WAY)
    rng = np.random.default_rng(1)
    names = ["measured", *WAYS, *(f"{k}/{row[3]}" for k in range(3) for row in rows[:5])]
    shown = {name: rng.random((4, 4, 3), dtype=np.float32) for name in names}
    return costs, half, {"weights": rng.random((4, 4, 4), dtype=np.float32), **shown}


def test_a_column_for_each_way_and_a_row_for_each_pair():
    drawn = figure.draw(*made())
    axes = np.array(drawn.axes).reshape(4, 5)
    assert [ax.get_title() for ax in axes[0]] == ["weights", "measured", *WAYS]
    assert [ax.get_title() for ax in axes[2]] == ["b", *WAYS, "c"]
    assert axes[1][2].texts[0].get_text() == "1° 9°  80 %"


def test_the_verb_says_what_is_missing(tmp_path, capsys):
    costs, half, shown = made()
    tables.write(tmp_path / "a.csv", costs)
    tables.write(tmp_path / "b.csv", half)
    call = (
        f"figure blends --table {tmp_path}/a.csv --half-way {tmp_path}/b.csv"
        f" --pictures {tmp_path}/p.exr --exposure {{}} -o {tmp_path}/f.png"
    )
    write_exr_parts(tmp_path / "p.exr", shown)
    assert main(call.format(1).split()) == 0
    assert main(call.format("nan").split()) == 1
    del shown["1/tables"]
    write_exr_parts(tmp_path / "p.exr", shown)
    assert main(call.format(1).split()) == 1
    assert "no picture '1/tables' in it" in capsys.readouterr().err


@pytest.mark.parametrize("index", range(4))
def test_each_material_has_a_colour_of_its_own(index):
    costs, half, shown = made()
    shown["weights"] = np.broadcast_to(np.eye(4)[index], (4, 4, 4))
    drawn = figure.draw(costs, half, shown)
    handle = drawn.legends[0].legend_handles[index]
    pixel = drawn.axes[0].images[0].get_array()[0, 0]
    assert handle.get_color() == figure.COLORS[index]
    np.testing.assert_allclose(pixel, figure.to_rgb(figure.COLORS[index]))
