import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.evaluation.shared_lobes import SAMPLING, WAYS
from npfm.figures import shared_lobes_factors, shared_lobes_psnr, shared_lobes_sampling
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.reflectance.half_difference import MERL


def psnr():
    levels = {"shared-lobes": [50, 41, 60], "independent-g": [45, 42, 40], "bivariate": [55] * 3}
    rows = [
        (material, variant, float(level))
        for variant, values in levels.items()
        for material, level in zip(("felt", "silk", "wool"), values, strict=True)
    ]
    return pd.DataFrame(rows, columns=["material", "variant", "psnr_db"])


def fit(kind="shared-lobes"):
    curves = np.exp(-np.outer([1.0, 0.5, 0.1], np.linspace(0, 5, 90)))
    parameters = {"D": curves[None], "G": curves[None], "F": curves}
    parameters |= {"rho_s": np.ones((3, 3)), "rho_d": np.ones(3)}
    single = {name: array.astype(np.float32) for name, array in parameters.items()}
    return Fit(kind, single, MERL)


def test_materials_stand_by_increasing_psnr_of_independent_g():
    figure = shared_lobes_psnr.draw(psnr())
    [ax] = figure.axes
    assert [label.get_text() for label in ax.get_xticklabels()] == ["wool", "silk", "felt"]
    lines = {line.get_label().split(":")[0]: line.get_ydata() for line in ax.get_lines()}
    assert list(lines["independent-g"]) == [40, 42, 45]
    assert list(lines["shared-lobes"]) == [60, 41, 50]
    assert "for 2 of 3 materials; in the paper for 88 of 100" in ax.get_title("left")


def test_factors_are_drawn_against_degrees():
    figure = shared_lobes_factors.draw({"felt": fit(), "silk": fit()})
    assert len(figure.axes) == 6
    assert [ax.get_title() for ax in figure.axes[:3]] == ["D", "F", "G"]
    assert all("degrees" in ax.get_xlabel() for ax in figure.axes[3:])
    assert all(len(ax.get_lines()) == 3 for ax in figure.axes)
    assert figure.axes[0].get_lines()[0].get_xdata()[-1] == pytest.approx(
        np.degrees(MERL.theta_h[-1])
    )


def test_a_line_a_way_and_a_panel_a_material():
    rows = [
        (material, way, n, 1 / n, 20 * np.log10(n), 10)
        for material in ("felt", "silk")
        for way in WAYS
        for n in (4, 16)
    ]
    figure = shared_lobes_sampling.draw(pd.DataFrame(rows, columns=SAMPLING))
    assert [ax.get_title() for ax in figure.axes] == ["felt", "silk"]
    assert [line.get_label() for line in figure.axes[1].get_lines()] == list(WAYS)


def test_fits_of_other_models_are_refused_in_one_line(tmp_path, capsys):
    fits.save(tmp_path / "felt.npz", fit("independent-g"))
    call = f"figure shared_lobes_factors --fits {tmp_path}/felt.npz -o {tmp_path}/f.png"
    assert main(call.split()) == 1
    [line] = capsys.readouterr().err.splitlines()
    assert "give one of shared-lobes" in line
    call = f"shared-lobes sampling {tmp_path}/felt.npz --light x.exr -o {tmp_path}/f.csv"
    assert main(call.split()) == 1
    [line] = capsys.readouterr().err.splitlines()
    assert "a fit of 'independent-g'" in line
