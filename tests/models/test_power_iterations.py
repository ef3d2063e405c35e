import numpy as np
import pytest

from npfm.datasets import neural
from npfm.errors import NpfmError
from npfm.evaluation.power_iterations import surfaces
from npfm.fitting.objective import Objective
from npfm.fitting.power_iterations.mirrors import mirrors
from npfm.models import beckmann, ggx, ggx_fitted, power_iteration
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.slopes import beckmann_roughness, ggx_roughness
from npfm.reflectance.table import INVALID, Table

ROUGHNESS = {ggx: ggx_roughness, beckmann: beckmann_roughness}
RISE = 0.04 + 0.96 * (1 - np.cos(MERL.theta_d)) ** 5


def fitted(model, table, **settings):
    return model.fit(table, Objective(), None, 1, **settings)


def formula_table(model, alpha, head_on=(0.04, 0.5, 0.9)):
    """A table of a formula, with Schlick's Fresnel factor."""
    D, area = model.MODEL.form.surface({"alpha": np.array([alpha])}, MERL)
    unit = mirrors(D, area, MERL)
    whole = np.concatenate([unit, unit[..., ::-1]], axis=-1)
    rise = (1 - np.cos(MERL.theta_d[:, None])) ** 5
    values = [np.where(MERL.above_horizon, (f + (1 - f) * rise) * whole, INVALID) for f in head_on]
    return Table(np.stack(values), MERL)


@pytest.mark.parametrize("model", ROUGHNESS)
@pytest.mark.parametrize("alpha", [0.01, 0.1, 0.6])
@pytest.mark.parametrize("way", ["least-squares", "median"])
def test_a_fit_of_a_formula_finds_its_numbers(model, alpha, way):
    table = formula_table(model, alpha)
    free = fitted(power_iteration, table, fresnel=way)
    converted = fitted(model, table, fresnel=way)
    assert ROUGHNESS[model](free.parameters["D"][0], MERL) == pytest.approx(alpha, rel=1e-4)
    assert converted.parameters["alpha"] == pytest.approx(alpha, rel=1e-4)
    for fit in (free, converted):
        F = fit.parameters["rho_s"][:, None] * fit.parameters["F"]
        np.testing.assert_allclose(F[0, :-1], RISE[:-1], rtol=1e-3)
        assert F[:, 0] == pytest.approx([0.04, 0.5, 0.9], rel=1e-3)


def test_the_conversions_keep_the_fresnel_factor_of_the_power_iterations(table):
    free = fitted(power_iteration, table)
    for model in ROUGHNESS:
        converted = fitted(model, table)
        for key in ("F", "rho_s"):
            assert np.array_equal(converted.parameters[key], free.parameters[key])


def test_settings_reach_the_fit(table):
    fits = {
        (kernel, way): fitted(power_iteration, table, kernel=kernel, fresnel=way)
        for kernel in power_iteration.SETTINGS["kernel"]
        for way in power_iteration.SETTINGS["fresnel"]
    }
    distributions = {kernel: fit.parameters["D"].tobytes() for (kernel, _), fit in fits.items()}
    assert len(set(distributions.values())) == 2
    factors = {fit.parameters["F"].tobytes() for fit in fits.values()}
    assert len(factors) == len(fits)


def test_363_numbers():
    assert power_iteration.parameter_count(MERL) == 363
    assert ggx.parameter_count(MERL) == beckmann.parameter_count(MERL) == 274
    assert ggx_fitted.parameter_count(MERL) == 8


def test_what_float32_cannot_hold_is_refused(table):
    dark = Table(np.where(table.valid, 1e-60 * table.values, INVALID), table.grid)
    with pytest.raises(NpfmError, match="red channel needs a coefficient"):
        fitted(power_iteration, dark)


@pytest.mark.parametrize("alpha", [0.02, 0.1, 0.4])
def test_ggx_fitted_finds_its_own_numbers(alpha):
    made = fitted(ggx_fitted, formula_table(ggx, alpha, (0.2, 0.2, 0.2)))
    assert made.parameters["alpha"] == pytest.approx(alpha, rel=1e-3)
    assert made.parameters["f0"] == pytest.approx(0.2, rel=1e-2)
    assert made.parameters["rho_s"] == pytest.approx(1, rel=1e-2)
    assert made.parameters["rho_d"] == pytest.approx(0, abs=1e-4)


@pytest.mark.parametrize(("name", "resolved"), [("chrome", False), ("nylon", True)])
def test_real_materials(data, name, resolved):
    """A mirror whose roughness the table cannot tell, and a matte plastic whose it can."""
    fit = fitted(power_iteration, neural.load(data / "merl_nbrdf.zip", name))
    assert {record.status for record in fit.records} == {"converged"}
    assert all(record.objective < 0.5 for record in fit.records)
    [surface] = surfaces({name: fit}).to_dict("records")
    assert surface["resolved"] == resolved
    assert (surface["alpha_ggx"] < 0.03) == (name == "chrome")
    assert all(0 < surface[color] < 1 for color in ("red", "green", "blue"))
