"""Factors in a spreadsheet: what is written gives the fit's own table."""

import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.exports.factors_csv import physical
from npfm.fitting import fits
from npfm.fitting.factors.microfacet import G_THETA
from npfm.fitting.fits import Fit
from npfm.fitting.registry import tabulated
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.slopes import bands


def fit(model, seed=1):
    rng = np.random.default_rng(seed)
    D = np.exp(-(((MERL.theta_h + 0.02) / [[0.1], [0.2], [0.5]]) ** 2))
    arrays = {"D": D, "F": rng.uniform(0.1, 1, (3, 90)), "rho_d": rng.random(3)}
    arrays["rho_s"] = rng.random(3)
    if model == "independent-g":
        arrays["G"] = 0.7 * np.cos(G_THETA) * np.ones((3, 1))
    return Fit(model, {name: a.astype(np.float32) for name, a in arrays.items()}, MERL)


@pytest.mark.parametrize("model", ["independent-g", "g-from-d"])
def test_the_columns_give_the_table(tmp_path, model):
    path, output = tmp_path / "a.npz", tmp_path / "a.csv"
    fits.save(path, fit(model))
    assert main(["export", str(path), "--to", "csv", "-o", str(output)]) == 0
    sheet = pd.read_csv(output)
    assert len(sheet) == 90
    h, d, _ = np.meshgrid(MERL.theta_h, MERL.theta_d, MERL.phi_d, indexing="ij")
    cosines = [np.clip(c, 1e-9, 1) for c in MERL.cosines]
    expected = tabulated(path).values

    def at(angle, x, factor):
        return np.interp(np.degrees(x), sheet[f"{angle} (degrees)"], sheet[factor])

    for values, channel in zip(expected, ("red", "green", "blue"), strict=True):
        D = at("theta_h", h, f"D {channel} (1/sr)")
        F = at("theta_d", d, f"F {channel} (reflectance)")
        G = [at("theta_i or theta_o", np.arccos(c), f"G {channel} (share)") for c in cosines]
        rho_d = sheet[f"rho_d {channel} (1/sr)"].dropna()
        assert len(rho_d) == 1
        found = rho_d[0] + D * F * G[0] * G[1] / (4 * cosines[0] * cosines[1])
        # Nodes of G are half a degree from the horizon, where they end.
        inside = np.minimum(*cosines) > 0.02
        np.testing.assert_allclose(found[inside], values[inside], rtol=1e-4)
        assert sheet[f"G {channel} (share)"].max() == 1
        microfacets = sheet[f"D {channel} (1/sr)"] * np.cos(MERL.theta_h) * bands(MERL)
        assert 2 * np.pi * microfacets.sum() == pytest.approx(1, rel=1e-4)


def test_a_mirror_of_the_world_has_a_fresnel_factor_of_one():
    """The model of Cook and Torrance with F = 1, as a fit has it, is F = 1 here as well."""
    made = fit("independent-g")
    D = made.parameters["D"][0].astype(float)
    total = 2 * np.pi * np.sum(D * np.cos(MERL.theta_h) * bands(MERL))
    p = made.parameters | {
        "D": np.tile(D.astype(np.float32), (3, 1)),
        "F": np.ones((3, 90), dtype=np.float32),
        "G": np.ones((3, 90), dtype=np.float32),
        "rho_s": np.full(3, 1 / (4 * total), dtype=np.float32),
    }
    _, F, _, _ = physical(Fit("independent-g", p, MERL))
    np.testing.assert_allclose(F, 1, rtol=1e-5)


def test_what_is_no_distribution_is_refused(tmp_path, capsys):
    made = fit("independent-g")
    made.parameters["D"][1] = 0
    fits.save(tmp_path / "a.npz", made)
    call = ["export", str(tmp_path / "a.npz"), "--to", "csv", "-o", str(tmp_path / "a.csv")]
    assert main(call) == 1
    assert f"{tmp_path}/a.npz: D of the green channel is no distribution" in capsys.readouterr().err
