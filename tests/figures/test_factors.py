"""Figures 3 to 6 and 16: weights, slices, factors and the texture of them."""

import itertools
import time

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.datasets.published_factors import G_THETA
from npfm.exports.texture import PARAMETERS, rows, texture
from npfm.figures import figure03, figure04, figure05, figure06, figure16, style
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective, channel_samples
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import Table

GRID = HalfDifference(18, 15, 12)


def table():
    """A BRDF with a highlight, a colour, and a gap in one channel."""
    highlight = np.exp(-GRID.theta_h / 0.1)[:, None, None] * np.ones(GRID.shape)
    values = np.stack([0.1 + 5 * highlight, 0.2 + highlight, 0.4 + 0 * highlight])
    values[:, ~GRID.above_horizon] = -1
    values[1, 2, 3] = -1
    return Table(values, GRID)


def glossy_G(theta):
    """G of three channels at given angles."""
    return np.cos(theta) ** (0.2 * np.array([[1.0], [1.5], [2.0]]))


def factors(steepness):
    """D, G and F of three channels."""
    channels = np.array([1.0, 1.5, 2.0])[:, None]
    return {
        "D": np.maximum(np.exp(-steepness * channels * MERL.theta_h), 1e-6),
        "G": glossy_G(MERL.theta_d),
        "F": 0.1 * channels + 0.5 * np.sin(MERL.theta_d) ** 5,
    }


def published(steepness):
    """The same, each in another scale, G at its nodes, with what no sample has touched."""
    scaled = {name: 7 * values for name, values in factors(steepness).items()}
    scaled["G"] = 7 * glossy_G(G_THETA)
    scaled["G"][:, 0] = scaled["F"][:, 0] = np.nan
    return scaled


def fit(steepness=1.0):
    rho = {"rho_d": np.array([0.1, 0.2, 0.0]), "rho_s": np.array([1.0, 10.0, 100.0])}
    parameters = {name: a.astype(np.float32) for name, a in (factors(steepness) | rho).items()}
    return Fit("independent-g", parameters, MERL)


def slices():
    measured = figure05.shown(table(), 0.3)
    return {name: {"measured": measured, "naive": measured**1.5} for name in ("chrome", "nylon")}


FIGURES = {
    "figure03": lambda: figure03.draw(figure03.weights(table(), Objective()), GRID, "nylon"),
    "figure04": figure04.draw,
    "figure05": lambda: figure05.draw(slices()),
    "figure06": lambda: figure06.draw(
        {"chrome": factors(20.0), "nylon": factors(1.0)}, {"chrome": published(20.0)}
    ),
    "figure16": lambda: figure16.draw(
        {name: texture({"a": fit(), "bc": fit(9)})[place] for name, place in rows(fit()).items()},
        ["a", "bc"],
    ),
}


@pytest.mark.parametrize("name", FIGURES)
@pytest.mark.mpl_image_compare(style=["default", style.SETTINGS], savefig_kwargs={"dpi": 50})
def test_it_looks_as_it_did(name):
    return FIGURES[name]()


@pytest.mark.parametrize("name", FIGURES)
def test_nothing_is_cut_off(name):
    figure = FIGURES[name]()
    with style.context():
        figure.draw_without_rendering()
    boxes = [ax.get_tightbbox() for ax in figure.axes]
    boxes += [legend.get_window_extent() for legend in figure.legends]
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 <= box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 <= box.y1 <= figure.bbox.y1


@pytest.mark.parametrize("name", FIGURES)
def test_it_is_as_wide_as_a_column_or_a_page_and_the_same_again(name, tmp_path, monkeypatch):
    figures = FIGURES[name](), FIGURES[name]()
    assert figures[0].get_figwidth() in (style.COLUMN_WIDTH, style.PAGE_WIDTH)
    style.save(figures[0], [tmp_path / "first.pdf"])
    later = time.time() + 86_400
    monkeypatch.setattr(time, "time", lambda: later)
    style.save(figures[1], [tmp_path / "second.pdf"])
    assert (tmp_path / "first.pdf").read_bytes() == (tmp_path / "second.pdf").read_bytes()


def test_weights_are_shares_of_the_largest_and_multiply_to_the_objective():
    weights = list(figure03.weights(table(), Objective()).values())
    counts = np.isfinite(weights[0])
    assert not counts[2, 3].any() and counts[2, 4].any()
    assert all((np.isfinite(w) == counts).all() and np.nanmax(w) == 1 for w in weights)
    product = weights[0] * weights[1] * weights[2]
    np.testing.assert_allclose(product[counts] / np.nanmax(product), weights[3][counts])
    expected = channel_samples(table(), figure03.CHANNEL, Objective()).weight
    np.testing.assert_allclose(weights[3][counts], expected[counts] / expected.max())


def test_rows_of_weights_are_their_slices():
    figure = FIGURES["figure03"]()
    shown = [ax.images[0].get_array() for ax in figure.axes if ax.images]
    [_, _, compressive, product] = figure03.weights(table(), Objective()).values()
    np.testing.assert_array_equal(shown[2].filled(np.nan), compressive[..., 0].T)
    np.testing.assert_array_equal(shown[4 + 3].filled(np.nan), product[..., 3].T)
    np.testing.assert_array_equal(shown[8 + 3].filled(np.nan), product[..., 6].T)


def test_a_slice_has_the_median_in_the_middle_and_gaps_are_clear():
    flat = Table(np.where(table().valid, 0.25, -1.0), GRID)
    assert figure05.median(flat) == 0.25
    shown = figure05.shown(flat, 0.25)
    valid = flat.valid[..., GRID.phi_d_bins // 2].all(axis=0)
    np.testing.assert_allclose(shown[valid][:, :3], 0.5)
    np.testing.assert_array_equal(shown[..., 3], valid)


def test_published_factors_are_dashed_in_our_scale():
    figure = FIGURES["figure06"]()
    chrome = [ax for ax in figure.axes if len(ax.get_lines()) == 6]
    assert len(chrome) == len(figure06.ANGLES)
    for ax in chrome:
        for ours, theirs in zip(ax.get_lines()[::2], ax.get_lines()[1::2], strict=True):
            assert (ours.get_linestyle(), theirs.get_linestyle()) == ("-", "--")
            assert ours.get_color() == theirs.get_color()
            # Each curve at its own angles: G is drawn at the nodes that the authors' has.
            known = np.isfinite(theirs.get_ydata())
            drawn = np.interp(theirs.get_xdata(), *ours.get_data())
            within = known & (theirs.get_xdata() > 1) & (theirs.get_xdata() < 85)
            np.testing.assert_allclose(theirs.get_ydata()[within], drawn[within], rtol=2e-3)
    nodes = chrome[list(figure06.ANGLES).index("G")].get_lines()[1].get_xdata()
    np.testing.assert_allclose(nodes, np.arange(90))
    assert len(figure.legends[0].get_texts()) == 4
    alone = figure06.draw({"nylon": factors(1.0)}, {"chrome": published(1.0)})
    assert len(alone.legends[0].get_texts()) == 3


def test_the_scale_is_told_from_angles_up_to_80_degrees():
    angles = np.array([10.0, 50.0, 85.0])
    np.testing.assert_allclose(figure06.scaled(np.array([1.0, 4.0, 40.0]), angles), [0.25, 1, 10])
    ours, published = np.array([2.0, 2.0, 1.0]), np.array([1.0, 1.0, 9.0])
    assert figure06.scale_to(published, ours, angles) == 2


def test_the_texture_is_drawn_from_black_to_white_by_logarithms():
    np.testing.assert_allclose(
        figure16.brightness(np.array([0, 1e-6, 1e-3, 1]), 1e-6, 1), [0, 0, 0.5, 1]
    )
    figure = FIGURES["figure16"]()
    assert [tick.get_text() for tick in figure.axes[-1].get_xticklabels()] == ["a", "bc"]
    assert [len(ax.images[0].get_array()) for ax in figure.axes] == [1, 1, 90, 90, 90]


def test_the_verb_draws_factors_and_texture_of_fits(tmp_path):
    fits.save(tmp_path / "chrome.npz", fit())
    for figure in ("figure06", "figure16"):
        output = tmp_path / f"{figure}.png"
        assert (
            main(["figure", figure, "--fits", str(tmp_path / "chrome.npz"), "-o", str(output)]) == 0
        )
        assert output.stat().st_size > 1000


def test_a_fit_without_the_factors_is_refused(tmp_path, capsys):
    other = Fit("bivariate", {"B": np.ones((3, 90, 90), dtype=np.float32)}, MERL)
    fits.save(tmp_path / "chrome.npz", other)
    for figure, message in (
        ("figure06", "a fit without D, F, G"),
        ("figure16", "does not go into"),
    ):
        call = ["figure", figure, "--fits", str(tmp_path / "chrome.npz"), "-o", "x.pdf"]
        assert main(call) == 1
        error = capsys.readouterr().err
        assert message in error and error.count("\n") == 1


def test_a_hundred_names_fit_under_the_texture():
    names = [f"specular-orange-phenolic-{k:02}" for k in range(100)]
    many = texture(dict.fromkeys(names, fit()))
    figure = figure16.draw({n: many[place] for n, place in rows(fit()).items()}, names)
    figure.draw_without_rendering()
    boxes = [tick.get_window_extent() for tick in figure.axes[-1].get_xticklabels()]
    assert all(left.x1 <= right.x0 for left, right in itertools.pairwise(boxes))
    assert all(box.y0 >= 0 for box in boxes)


def test_the_texture_has_every_parameter():
    assert set(PARAMETERS) == set(fit().parameters)
