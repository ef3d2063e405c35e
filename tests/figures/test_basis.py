import numpy as np
import pandas as pd
import pytest
from lobed import NODES, fit_of, many

from npfm.__main__ import main
from npfm.evaluation import tables
from npfm.evaluation import uniqueness as study
from npfm.evaluation.basis import SUMMARY
from npfm.figures import basis, basis_curves, uniqueness
from npfm.fitting import iterations
from npfm.fitting.basis import library
from npfm.fitting.iterations import Iterations
from npfm.fitting.objective import Objective


def summary():
    numbers = (10, 816, 3264, 6480, 1.0, 2.0)
    rows = []
    for variant, level in (("independent-g", 45.0), ("mine", 50.0)):
        rows.append((variant, "free", 0, *numbers, 0.01, 1.0, 1.0, level, 0.0, 0.0))
        for n in (1, 5, 20):
            end = 0.01 + 0.1 / n, 1 + 10 / n, 1 + 20 / n
            rows.append((variant, "fitted", n, *numbers, *end, level - 10 / n, 1.0, 2.0))
            rows.append((variant, "projected", n, *numbers, *end, np.nan, np.nan, np.nan))
    return pd.DataFrame(rows, columns=SUMMARY)


def test_a_line_for_each_variant_and_way():
    figure = basis.draw(summary(), {"mine": "#112233"})
    objective, by_curves, by_bytes = figure.axes
    assert [ax.get_xlabel() for ax in figure.axes] == [
        "curves of each of D, F and G", "curves of each of D, F and G", "bytes of a material",
    ]  # fmt: skip
    drawn = [list(line.get_ydata()) for line in by_curves.lines if len(line.get_xdata()) == 3]
    assert [35, 43, 44.5] in drawn and [40, 48, 49.5] in drawn
    assert any(line.get_color() == "#112233" for line in by_bytes.lines)
    assert [label.get_text() for label in objective.get_xticklabels()] == ["1", "5", "20"]


def test_curves_are_drawn_about_their_mean():
    found = [library.gather(many(name), Objective()) for name in library.MODELS]
    figure = basis_curves.draw(found)
    assert len(figure.axes) == 6
    assert [ax.get_title() for ax in figure.axes[:3]] == ["D", "F", "G"]
    for ax in figure.axes:
        assert len(ax.lines) == 7
        # Either way of a curve leaves the mean's form by powers: their product is its square.
        plus, minus, mean = (np.log(ax.lines[k].get_ydata()) for k in (0, 1, 6))
        rest = plus + minus - 2 * mean
        assert rest == pytest.approx(np.full(rest.size, rest[0]), abs=1e-6)


def record():
    fit, state = fit_of("independent-g", 0.3, 1.0, 0.5), np.arange(6)
    change = 1 - 0.5 * (state[:, None] % 2) * np.linspace(0, 1, 18)
    arrays = (np.tile(fit.parameters[name][0], (6, 1)) for name in "DG")
    return Iterations(
        ("a", "b"), state // 2, state % 2, 0 * state, np.full(6, 0.1), *arrays,
        fit.parameters["F"][0] * change,
    )  # fmt: skip


def channels():
    rows = [
        (name, channel, 8, 8, 0.01, 0.0, 0.05 * k, 0.1 * k + 0.01 * j, 0.0, 0.0, 0.1 * k, 0.2, 0.1)
        for k, name in enumerate(("felt", "silk"))
        for j, channel in enumerate(("red", "green", "blue"))
    ]
    return pd.DataFrame(rows, columns=study.CHANNEL)


def test_distances_and_the_factors_that_are_furthest_apart():
    assert uniqueness.furthest(channels()) == ("silk", "blue")
    figure = uniqueness.draw(channels(), record(), "silk, blue")
    above, below = figure.axes[:3], figure.axes[3:]
    assert [ax.get_title() for ax in above] == ["D", "F", "G"]
    assert list(above[1].lines[2].get_ydata()) == pytest.approx([0.02, 0.12])
    assert {text.get_text() for text in above[1].texts} == {"silk"}
    assert [len(ax.lines) for ax in below] == [2, 2, 2]
    assert below[0].get_ylabel().startswith("silk, blue")
    assert below[2].lines[0].get_xdata() == pytest.approx(np.degrees(NODES))


def test_the_verbs_draw_the_same_twice(tmp_path, capsys):
    tables.write(tmp_path / "basis.csv", summary())
    tables.write(tmp_path / "channels.csv", channels())
    iterations.save(tmp_path / "silk.npz", record())
    library.save(tmp_path / "all.npz", library.gather(many("independent-g"), Objective()))
    calls = {
        "basis": "--table basis.csv",
        "basis_curves": "--factors all.npz",
        "uniqueness": "--table channels.csv --iterations silk.npz",
    }
    for name, options in calls.items():
        words = [f"{tmp_path}/{w}" if "." in w else w for w in options.split()]
        for end in ("a", "b"):
            assert main(["figure", name, *words, "-o", f"{tmp_path}/{name}-{end}.png"]) == 0
        first, second = ((tmp_path / f"{name}-{end}.png").read_bytes() for end in ("a", "b"))
        assert first == second
    words = ["figure", "uniqueness", "--table", f"{tmp_path}/channels.csv"]
    call = [*words, "--iterations", f"{tmp_path}/all.npz", "-o", f"{tmp_path}/c.png"]
    assert main(call) == 1
    assert "no record of silk among --iterations" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "column", "value", "said"),
    [
        ("basis", "way", "thrown", "the way 'thrown' is none of fitted, projected, free"),
        ("basis", "curves", np.nan, "no number in the column curves"),
        ("uniqueness", "channel", "mauve", "the channel 'mauve' is none of red, green, blue"),
        ("uniqueness", "F", np.nan, "no number in the column F"),
    ],
)
def test_tables_of_something_else_are_told_in_one_line(tmp_path, capsys, name, column, value, said):
    table = summary() if name == "basis" else channels()
    table = table.astype({column: object})
    table.loc[1, column] = value
    tables.write(tmp_path / "wrong.csv", table)
    words = ["figure", name, "--table", f"{tmp_path}/wrong.csv"]
    words += [] if name == "basis" else ["--iterations", f"{tmp_path}/silk.npz"]
    assert main([*words, "-o", f"{tmp_path}/a.png"]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and f"wrong.csv: {said}" in error
