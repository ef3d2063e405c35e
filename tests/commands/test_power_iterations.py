import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.fitting import fits
from npfm.fitting.objective import Objective
from npfm.models import bivariate, power_iteration
from npfm.papers import dupuy2015


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


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("surfaces {0}/plain.npz", "a fit of 'bivariate'; give fits of power-iteration"),
        ("delta-e --measured {0} --fits ggx --materials a --images {0}/x.exr", "'ggx' has no '='"),
        ("timing --repeats 0", "give a whole number of 1 or more"),
    ],
)
def test_mistakes_are_answered_in_one_line(capsys, tmp_path, table, arguments, said):
    fits.save(tmp_path / "plain.npz", bivariate.fit(table, Objective(), None, 1))
    output = tmp_path / "never.csv"
    call = f"power-iterations {arguments.format(tmp_path)} -o {output}"
    assert main(call.split()) == 1
    [line] = capsys.readouterr().err.splitlines()
    assert said in line
    assert not output.exists()
