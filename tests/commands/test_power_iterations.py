import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.datasets import synthetic_anisotropic
from npfm.fitting import fits
from npfm.fitting.objective import Objective
from npfm.models import bivariate, ggx, power_iteration
from npfm.papers import dupuy2015
from npfm.reflectance.directional import UTIA
from npfm.reflectance.table import Table


def test_recovery_has_what_the_paper_prints_beside_it(tmp_path):
    output = tmp_path / "recovery.csv"
    assert main(["power-iterations", "recovery", "-o", str(output)]) == 0
    table = pd.read_csv(output).dropna()
    assert dict(zip(table.alpha, table.published_error, strict=True)) == dupuy2015.BACKSCATTER_ERROR
    assert set(table.surface) == {"beckmann"}
    assert set(table.nodes) == {360}
    assert (table.backscatter_error < table.published_error).all()


def test_surfaces_of_fits(tmp_path, table):
    for name, model in (("power", power_iteration), ("plain", bivariate)):
        fits.save(tmp_path / f"{name}.npz", model.fit(table, Objective(), None, 1))
    output = tmp_path / "surfaces.csv"
    assert main(["power-iterations", "surfaces", f"{tmp_path}/power.npz", "-o", str(output)]) == 0
    [row] = pd.read_csv(output).to_dict("records")
    assert row["material"] == "power"
    assert 0 < row["alpha_ggx"] < row["alpha_beckmann"]
    assert np.isfinite(list(row.values())[1:]).all()


def directional_fit(path, model):
    values = synthetic_anisotropic.tabulate(synthetic_anisotropic.MATERIALS["cast-chrome"], UTIA)
    fits.save(path, model.fit(Table(values, UTIA), Objective(), None, 1))


def test_surfaces_of_tables_of_both_directions(tmp_path):
    directional_fit(tmp_path / "chrome.npz", ggx)
    output = tmp_path / "surfaces.csv"
    assert main(["power-iterations", "surfaces", f"{tmp_path}/chrome.npz", "-o", str(output)]) == 0
    [row] = pd.read_csv(output).to_dict("records")
    assert list(row) == ["material", "alpha_x", "alpha_y", "rho", "red", "green", "blue"]
    assert (row["alpha_x"], row["alpha_y"]) == pytest.approx((0.3, 0.33), rel=0.03)


def test_anisotropic_surfaces_are_found_again_and_timed(tmp_path):
    for kind, columns in (
        ("recovery", ["alpha_error", "rho_error"]),
        ("timing --repeats 1", ["nodes", "seconds"]),
    ):
        output = tmp_path / f"{kind.split()[0]}.csv"
        assert main(f"power-iterations {kind} --anisotropic -o {output}".split()) == 0
        assert {*columns} <= {*pd.read_csv(output).columns}
    found = pd.read_csv(tmp_path / "recovery.csv")
    assert (found.elevations * found.azimuths == 8100).all()
    assert found.alpha_error.max() < 0.005
    assert found.rho_error.max() < 0.01


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("surfaces {0}/plain.npz", "a fit of 'bivariate'; give fits of power-iteration"),
        (
            "delta-e --measured {0} --fits ggx --materials a --images {0}/x.exr",
            "'ggx' is not written",
        ),
        ("surfaces {0}/turned.npz", "a fit of 'power-iteration'; give fits of ggx"),
        ("surfaces {0}/ggx.npz {0}/power.npz", "on another kind of grid than"),
        ("timing --repeats 0", "give a whole number of 1 or more"),
    ],
)
def test_mistakes_are_answered_in_one_line(capsys, tmp_path, table, arguments, said):
    fits.save(tmp_path / "plain.npz", bivariate.fit(table, Objective(), None, 1))
    fits.save(tmp_path / "power.npz", power_iteration.fit(table, Objective(), None, 1))
    directional_fit(tmp_path / "turned.npz", power_iteration)
    directional_fit(tmp_path / "ggx.npz", ggx)
    output = tmp_path / "never.csv"
    call = f"power-iterations {arguments.format(tmp_path)} -o {output}"
    assert main(call.split()) == 1
    [line] = capsys.readouterr().err.splitlines()
    assert said in line
    assert not output.exists()
