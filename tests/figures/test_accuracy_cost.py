import time

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from npfm.__main__ import main
from npfm.evaluation import tables
from npfm.evaluation.accuracy_cost import FITS, SAMPLING, TRACES
from npfm.figures import convergence, pareto, sampling, settings, style

MATERIALS = ["chrome", "felt"]


def traces():
    rows = []
    for material in MATERIALS:
        for solver, scale in (("gauss-newton", 1.0), ("awls", 2.0)):
            for start in ("ones", "slices"):
                thinned = int(solver == "gauss-newton" and start == "ones")
                status = "iteration cap" if (solver, start) == ("awls", "ones") else "converged"
                for step in range(4):
                    point = scale * step, scale * 10.0**-step
                    rows.append((material, "red", solver, start, thinned, status, *point))
            rows.append((material, "red", solver, "together", 0, "converged", 9.0, scale * 1e-3))
    return pd.DataFrame(rows, columns=TRACES)


def fits():
    rows = []
    for k, material in enumerate(MATERIALS):
        for scene in ("A", "D"):
            for setting, seconds, size, decibels in (
                ("bivariate", 1, 97200, 45),
                ("naive/gauss-newton", 2, 4344, 40),
                ("naive/awls", 4, 4344, 39),
                ("independent-g/gauss-newton", 8, 3264, 46),
            ):
                rows.append((material, "model", setting, scene, seconds, size, decibels + k))
            for n in (1, 2, 10):
                rows.append((material, "starts", str(n), scene, n * 1.0, 3264, 40 + n * (1 + k)))
            for n, setting in enumerate(("1e-02", "1e-03")):
                rows.append((material, "tolerance", setting, scene, n + 1.0, 3264, 43 + n))
    return pd.DataFrame(rows, columns=FITS)


def samplings():
    rows = []
    for name, power in (("light", 0.5), ("half-vector", 1.0), ("light+half-vector", 1.5)):
        for samples in (16, 64, 256):
            for k, material in enumerate(MATERIALS):
                error = (3 + k) * samples**-power
                picture = 20 * power * np.log10(samples) + 10 * k
                rows.append((name, samples, samples / 100, material, picture, 40 + error, 40))
    return pd.DataFrame(rows, columns=SAMPLING)


#: Name, table, what draws it, and the option that names the table.
FIGURES = {
    "convergence": (traces, convergence, "--traces"),
    "pareto": (fits, pareto, "--fits"),
    "settings": (fits, settings, "--fits"),
    "sampling": (samplings, sampling, "--sampling"),
}


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def points(ax):
    """First point of each line of a panel."""
    return [(float(line.get_xdata()[0]), float(line.get_ydata()[0])) for line in ax.get_lines()]


def test_convergence_draws_every_start_and_the_end_of_all():
    figure = convergence.draw(traces())
    assert [ax.get_title("left") for ax in figure.axes] == ["chrome, red", "felt, red"]
    lines = figure.axes[0].get_lines()
    assert len(lines) == 2 * 2 + 2
    assert lines[0].get_linestyle() == "--"
    assert lines[1].get_linestyle() == lines[2].get_linestyle() == "-"
    assert list(lines[1].get_xdata()) == [convergence.FIRST_SECOND, 1, 2, 3]
    assert points(figure.axes[0])[4:] == [(9, 1e-3), (9, 2e-3)]
    [text] = figure.axes[0].texts
    assert text.get_text() == "gauss-newton 0.001\nawls +100.0%"
    assert "awls: starts; 2 of 4 stopped at 3 iterations" in legend(figure)


def test_pareto_front_is_what_nothing_beats():
    costs, values = pd.Series([3.0, 1.0, 2.0, 2.0, 4.0]), pd.Series([7.0, 5.0, 4.0, 6.0, 7.0])
    assert pareto.front(costs, values) == [1, 3, 0]


def test_pareto_draws_means_with_areas_in_proportion_to_bytes():
    figure = pareto.draw(fits())
    seconds, size = figure.axes
    assert points(seconds)[:4] == [(1, 45.5), (2, 40.5), (4, 39.5), (8, 46.5)]
    assert points(size)[:4] == [(97200, 45.5), (4344, 40.5), (4344, 39.5), (3264, 46.5)]
    marks = seconds.get_lines()[:4]
    areas = np.array([mark.get_markersize() ** 2 for mark in marks])
    np.testing.assert_allclose(areas / areas[0], np.array([97200, 4344, 4344, 3264]) / 97200)
    assert marks[1].get_markeredgecolor() == marks[2].get_markeredgecolor()
    assert marks[1].get_markerfacecolor() != marks[2].get_markerfacecolor() == "white"
    front = seconds.get_lines()[4]
    assert list(front.get_ydata()[1:]) == [45.5, 46.5, 46.5]
    assert list(size.get_lines()[4].get_ydata()[1:]) == [46.5, 46.5]
    assert "naive, awls: 4344 bytes" in legend(figure)


def test_settings_are_in_the_order_of_their_numbers_and_gains_are_over_the_first():
    figure = settings.draw(fits())
    gains, tolerance, seconds, _ = figure.axes
    assert list(gains.get_lines()[0].get_xdata()) == [1, 2, 10]
    assert list(gains.get_lines()[1].get_ydata()) == [0, 2, 18]
    assert list(gains.get_lines()[2].get_ydata()) == [0, 1.5, 13.5]
    assert list(seconds.get_lines()[2].get_ydata()) == [1, 2, 10]
    assert gains.get_title("left") == "mean PSNR 41.50 to 55.00 dB"
    assert tolerance.xaxis_inverted()
    assert legend(figure) == [*MATERIALS, "mean"]


def test_sampling_states_the_slope():
    assert sampling.slope(pd.Series([1, 2, 4]), pd.Series([5.0, 8.0, 11.0])) == pytest.approx(3)
    figure = sampling.draw(samplings())
    texts = [text.get_text() for ax in figure.axes[::2] for text in ax.get_legend().get_texts()]
    assert texts == [
        "light alone: +3.01 dB a doubling",
        "half vectors alone: +6.02 dB a doubling",
        "both combined: +9.03 dB a doubling",
        "light alone: error ~ samples^-0.50",
        "half vectors alone: error ~ samples^-1.00",
        "both combined: error ~ samples^-1.50",
    ]
    error = sampling.errors(samplings())["error_db"][0]
    assert error == pytest.approx(np.sqrt((3**2 + 4**2) / 2) / 4)


@pytest.mark.parametrize("name", FIGURES)
def test_the_verb_draws_the_same_bytes_again(name, tmp_path, monkeypatch):
    table = tmp_path / "table.csv"
    tables.write(table, FIGURES[name][0]())
    outputs = [tmp_path / "figure.pdf", tmp_path / "figure.png"]
    call = ["figure", name, FIGURES[name][2], str(table), "-o", *map(str, outputs)]
    assert main(call) == 0
    first = [path.read_bytes() for path in outputs]
    later = time.time() + 86_400
    monkeypatch.setattr(time, "time", lambda: later)
    assert main(call) == 0
    assert [path.read_bytes() for path in outputs] == first
    with Image.open(outputs[1]) as image:
        assert image.width == style.PAGE_WIDTH * style.DPI


@pytest.mark.parametrize("name", FIGURES)
def test_nothing_is_cut_off_and_axes_are_labelled(name):
    table, module, _ = FIGURES[name]
    figure = module.draw(table())
    figure.draw_without_rendering()
    boxes = [ax.get_tightbbox() for ax in figure.axes]
    boxes += [legend.get_window_extent() for legend in figure.legends]
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1
    labels = {ax.get_xlabel() for ax in figure.axes} | {ax.get_ylabel() for ax in figure.axes}
    assert any("seconds" in label for label in labels)
