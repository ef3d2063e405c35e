"""Figures of factorisations: what they show, and what they refuse."""

import numpy as np
import pandas as pd
import pytest

from npfm.datasets.analytic import FORMULAS
from npfm.errors import NpfmError
from npfm.figures import factorisation_steps, factorisation_terms, point_light
from npfm.fitting.factorisation.recipes import Recipe, factor
from npfm.reflectance.factored import Angles, reflectance


@pytest.mark.parametrize("improved", [True, False])
def test_steps_show_the_terms_that_there_are(improved):
    angles = Angles(True, improved, (4, 6, 12, 10))
    factors = factor(FORMULAS["ward"], Recipe(angles, (2, 3))).factors
    figure = factorisation_steps.draw(FORMULAS["ward"], factors)
    titles = {ax.get_title(): ax for ax in figure.axes}
    assert len(titles["F, share of its maximum"].lines) == 2
    assert len(titles["v, share of the maximum of all"].lines) == 3
    assert titles["matrix Y"].images[0].get_array().shape == (120, 24)


def test_a_line_for_each_number_of_outer_terms():
    rows = [{"outer": J, "inner": K, "error": 1 / J, "rms": 1 / K} for J in (1, 2) for K in (1, 3)]
    figure = factorisation_terms.draw(pd.DataFrame(rows))
    for ax, values in zip(figure.axes, ([1, 1 / 3], [0.5, 0.5]), strict=True):
        assert [line.get_label() for line in ax.lines] == ["J = 1", "J = 2"]
        np.testing.assert_allclose(ax.lines[1].get_ydata(), values)


def test_spheres_are_lit_from_where_the_light_is():
    picture = point_light.picture(lambda light, view: np.full((3, len(light)), 1 / np.pi))
    brightest = np.unravel_index(picture[..., 0].argmax(), picture.shape[:2])
    normal = point_light._normals()[brightest]
    light = point_light.LIGHT / np.linalg.norm(point_light.LIGHT)
    assert normal @ light > 0.999
    assert picture.max() == pytest.approx(1 / np.pi, rel=1e-3)
    assert picture[0, 0].max() == 0


def test_exact_factors_leave_no_difference():
    factors = factor(FORMULAS["hapke-lommel"], Recipe(Angles(False, True, (4, 1, 8, 8)))).factors

    def model(light, view):
        return reflectance(factors, light, view)

    figure = point_light.draw([model], [model], ["dust"])
    assert figure.axes[2].get_title() == "difference, 0.0 % of the mean"


def test_numbers_of_words_have_to_agree(tmp_path):
    class Arguments:
        brdfs, factors, names = ["ward"], [], ["ward"]

    with pytest.raises(NpfmError, match="give one of each"):
        point_light.make(Arguments)
