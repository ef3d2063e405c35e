"""``npfm factor`` and ``npfm factorisation``: what they write and what they refuse."""

import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.evaluation import factorisation, tables
from npfm.fitting import fits, registry
from npfm.reflectance.factored import read
from npfm.reflectance.table import Table

SMALL = "--terms 2x1 --resolution 6x1x16x8"


def run(line):
    assert main(line.split()) == 0


def refused(line, capsys):
    capsys.readouterr()
    assert main(line.split()) != 0
    message = capsys.readouterr().err.strip()
    assert "\n" not in message
    return message


def test_factors_of_a_formula_are_a_fit_of_the_model(tmp_path):
    run(f"factor cook-torrance {SMALL} -o {tmp_path}/a.npz")
    factors = read(fits.load(tmp_path / "a.npz").parameters)
    assert factors.angles.shape == (6, 1, 16, 8) and factors.terms == (2, 1)
    assert isinstance(registry.tabulated(tmp_path / "a.npz"), Table)
    run(f"factor {tmp_path}/a.npz {SMALL} --recipe paper -o {tmp_path}/b.npz")
    assert not read(fits.load(tmp_path / "b.npz").parameters).angles.improved


def test_factors_of_all_azimuths_are_no_table(tmp_path, capsys):
    run(f"factor ward --terms 1x1 --resolution 4x4x8x8 -o {tmp_path}/a.npz")
    message = refused(f"tabulate {tmp_path}/a.npz -o {tmp_path}/a.binary", capsys)
    assert "16x1x128x16" in message


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("wart", "did you mean ward"),
        ("no-such.binary", "no-such.binary"),
        ("ward --terms 2", "2 whole numbers"),
        ("ward --terms 0x1", "2 whole numbers"),
        ("ward --terms 2x²", "2 whole numbers"),
        ("ward --resolution 16x16x128", "4 whole numbers"),
        ("ward --resolution 99999x99999x99999x99999", "fewer bins"),
        ("ward --terms 99999x1 --resolution 4x4x8x8", "terms"),
        ("ward --recipe mine", "mine"),
    ],
)
def test_mistakes_are_told_in_one_line(tmp_path, capsys, words, said):
    assert said in refused(f"factor {words} -o {tmp_path}/a.npz", capsys)
    assert not list(tmp_path.iterdir())


def test_rows_are_gathered(tmp_path):
    row = dict.fromkeys(factorisation.NUMBERS, 1.0) | dict.fromkeys(factorisation.TEXT, "a")
    for name in ("one", "two"):
        tables.write(tmp_path / f"{name}.csv", factorisation.table([row | {"material": name}]))
    run(f"factorisation table {tmp_path}/one.csv {tmp_path}/two.csv -o {tmp_path}/both.csv")
    assert pd.read_csv(tmp_path / "both.csv")["material"].tolist() == ["one", "two"]


def test_a_material_is_measured_by_both_recipes(tmp_path):
    run(f"factorisation measure hapke-lommel -o {tmp_path}/a.csv")
    table = pd.read_csv(tmp_path / "a.csv").set_index("recipe")
    assert (table["error"] < table["lafortune_paper"]).all()
    assert table["error"]["paper"] == pytest.approx(0.19, abs=0.01)
    assert table["paper"]["paper"] == 0.186
    assert table["lafortune"].notna().all() and table["bytes"]["improved"] < 2500
