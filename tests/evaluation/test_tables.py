import math

import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.fitting.fits import ChannelRecord, Fit, Trace, save
from npfm.papers import bagher2016
from npfm.papers.table1 import table1
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import CHANNELS
from npfm.storage.pictures import write_exr

PAPER = bagher2016.MEAN_PSNR_DB

GRID = HalfDifference(30, 10, 6)
SCENES, MATERIALS, VARIANTS = ["B", "A"], ["felt", "chrome"], ["naive", "bivariate"]


def a_fit(variant, D, seconds=1.0, gss_calls=0):
    """A fit whose channels took 1, 2 and 3 times `seconds`, with two starts of 10 and 5 sweeps."""
    runs = (("ones", 10, (1.0, 0.25)), ("random-1", 5, (1.0, 0.5)))
    traces = tuple(
        Trace(start, "converged", sweeps, gss_calls, (0.0, seconds), objective)
        for start, sweeps, objective in runs
    )
    records = tuple(
        ChannelRecord(name, (i + 1) * seconds, "ones", 0.25, 0.125, "converged", traces)
        for i, name in enumerate(CHANNELS)
    )
    return Fit(variant, {"D": np.float32(D)}, GRID, records)


def picture(value):
    """Four foreground pixels of constant radiance, and a row of half-covered ones to be ignored."""
    pixels = np.full((3, 2, 4), value, dtype=np.float32)
    pixels[..., 3] = 1
    pixels[2] = (1000 * value, 0, 0, 0.5)
    return pixels


@pytest.fixture
def run(tmp_path):
    """A made-up run. Radiance is 1; in scene A naive is off by 0.1, in scene B by 0.01."""
    ones, narrow = np.ones((3, 30)), np.tile(np.exp(-np.arange(30.0)), (3, 1))
    save(tmp_path / "fits/naive/felt.npz", a_fit("naive", ones, seconds=2.0, gss_calls=4))
    save(tmp_path / "fits/naive/chrome.npz", a_fit("naive", narrow, seconds=4.0))
    for material in MATERIALS:
        save(tmp_path / f"fits/bivariate/{material}.npz", a_fit("bivariate", np.ones((3, 50))))
    for scene, error in {"A": 0.1, "B": 0.01}.items():
        for material in MATERIALS:
            folder = tmp_path / "renders" / scene / material
            write_exr(folder / "measured.exr", picture(1.0))
            write_exr(folder / "bivariate.exr", picture(1.0))
            write_exr(folder / "naive.exr", picture(1.0 + error))
    return tmp_path


def written(path, table):
    tables.write(path, table)
    return path


def test_psnr_of_every_picture_in_the_order_of_the_lists(run):
    table = tables.psnr(run, SCENES, MATERIALS, VARIANTS)
    assert list(table) == ["scene", "material", "variant", "psnr_db", "gap"]
    assert set(table["gap"]) == {""}
    assert list(table["scene"]) == ["B"] * 4 + ["A"] * 4
    assert list(table["material"]) == ["felt", "felt", "chrome", "chrome"] * 2
    assert list(table["variant"]) == VARIANTS * 4
    # -20 log10 of the error, the peak being 1
    expected = [40, math.inf] * 2 + [20, math.inf] * 2
    np.testing.assert_allclose(table["psnr_db"], expected, atol=1e-4)


def test_pictures_that_are_not_listed_do_not_count(run):
    write_exr(run / "renders/A/stale/naive.exr", picture(2.0))
    assert tables.psnr(run, ["A"], ["felt"], ["naive"]).values.tolist() == [
        ["A", "felt", "naive", pytest.approx(20, abs=1e-4), ""]
    ]


def test_a_black_material_is_a_gap_with_its_reason_and_others_keep_their_tables(run, tmp_path):
    for name in ("measured", *VARIANTS):
        write_exr(run / f"renders/A/chrome/{name}.exr", picture(0.0))
    infinite = picture(1.0)
    infinite[0, 0, 0] = np.inf
    write_exr(run / "renders/B/felt/naive.exr", infinite)
    table = tables.psnr(run, SCENES, MATERIALS, VARIANTS)
    rows = table.set_index(["scene", "material", "variant"])
    assert rows.loc[("A", "felt", "naive"), "psnr_db"] == pytest.approx(20, abs=1e-4)
    gaps = rows[rows["psnr_db"].isna()]["gap"].to_dict()
    black = "the largest foreground value of the reference is 0"
    assert gaps == {
        ("B", "felt", "naive"): "1 foreground values of the picture are NaN or infinite",
        **{("A", "chrome", variant): black for variant in VARIANTS},
    }
    assert (rows["gap"] != "").sum() == len(gaps)
    again = tables.read_psnr(written(tmp_path / "psnr.csv", table))
    assert again["psnr_db"].isna().sum() == len(gaps)
    summary = tables.summary(again, tables.sizes(run, again), PAPER).set_index(["variant", "scene"])
    naive = summary.loc[("naive", "A")]
    assert (naive["materials"], naive["exact"], naive["gaps"]) == (1, 0, 1)
    assert naive["mean_psnr_db"] == pytest.approx(20, abs=1e-4)


def test_infinity_and_odd_names_survive_the_file(tmp_path):
    table = pd.DataFrame(
        {
            "scene": ["A", "A", "A"],
            "material": ["001", "none", "nan"],
            "variant": "naive",
            "psnr_db": [math.inf, 12.3456789, math.nan],
        }
    )
    path = written(tmp_path / "psnr.csv", table)
    assert path.read_text() == (
        "scene,material,variant,psnr_db\nA,001,naive,inf\nA,none,naive,12.3457\nA,nan,naive,\n"
    )
    again = tables.read_psnr(path)
    assert list(again["material"]) == ["001", "none", "nan"]
    assert again["psnr_db"].tolist() == [math.inf, 12.3457, pytest.approx(math.nan, nan_ok=True)]


def test_what_is_missing_has_no_row(run):
    missing = ["naive/felt"]
    (run / "renders/A/felt/naive.exr").unlink()
    (run / "fits/naive/felt.json").unlink()
    table = tables.psnr(run, ["A"], MATERIALS, VARIANTS, missing)
    pairs = [("felt", "bivariate"), ("chrome", "naive"), ("chrome", "bivariate")]
    assert list(zip(table["material"], table["variant"], strict=True)) == pairs
    fits = tables.fits(run, MATERIALS, VARIANTS, missing)
    assert list(zip(fits["material"], fits["variant"], strict=True))[::3] == pairs
    summary = tables.summary(table, tables.sizes(run, table), PAPER).set_index(["variant", "scene"])
    assert summary["materials"].to_dict() == {
        ("bivariate", "A"): 2,
        ("bivariate", "all"): 2,
        ("naive", "A"): 1,
        ("naive", "all"): 1,
    }


def test_the_verb_leaves_out_what_is_missing(run, tmp_path):
    (run / "renders/A/felt/naive.exr").unlink()
    lists = ["--scenes", "A", "--materials", *MATERIALS, "--variants", *VARIANTS]
    call = ["tables", "psnr", "--run", str(run), *lists, "--missing", "naive/felt"]
    assert main([*call, "-o", str(tmp_path / "psnr.csv")]) == 0
    assert len(tables.read_psnr(tmp_path / "psnr.csv")) == 3


def test_fits_have_one_row_a_channel(run):
    table = tables.fits(run, MATERIALS, VARIANTS)
    columns = "material variant channel seconds iterations gss_calls starts best_start objective"
    assert list(table) == [*columns.split(), "objective_floor", "status"]
    assert len(table) == 2 * 2 * 3
    row = ["felt", "naive", "green", 4.0, 15, 8, 2, "ones", 0.25, 0.125, "converged"]
    assert table.values.tolist()[1] == row


def test_diffuseness_of_a_constant_distribution_is_pi(run):
    table = tables.materials(run, ["felt", "chrome"]).set_index("material")["diffuseness"]
    assert table["felt"] == pytest.approx(math.pi, rel=1e-6)
    assert 0 < table["chrome"] < 0.1


def test_summary_averages_over_materials_then_over_everything(run):
    psnr = pd.DataFrame(
        [
            ("A", "felt", "naive", 10.0),
            ("A", "chrome", "naive", 20.0),
            ("A", "wood", "naive", 60.0),
            ("B", "felt", "naive", 40.0),
            ("B", "felt", "bivariate", math.inf),
            ("B", "chrome", "bivariate", 50.0),
        ],
        columns=["scene", "material", "variant", "psnr_db"],
    )
    listed = tables.psnr(run, ["A"], MATERIALS, ["bivariate", "naive"])
    sizes = tables.sizes(run, listed)
    assert sizes.values.tolist() == [["bivariate", 150, 600], ["naive", 90, 360]]
    table = tables.summary(psnr, sizes, PAPER)
    assert ",".join(table) == (
        "variant,scene,materials,mean_psnr_db,median_psnr_db,exact,gaps,parameters,bytes,"
        "paper_psnr_db"
    )
    nothing = pytest.approx(math.nan, nan_ok=True)
    assert table.values.tolist() == [
        ["bivariate", "B", 2, 50.0, math.inf, 1, 0, 150, 600, nothing],
        ["bivariate", "all", 2, 50.0, math.inf, 1, 0, 150, 600, 64.07],
        ["naive", "A", 3, 30.0, 20.0, 0, 0, 90, 360, nothing],
        ["naive", "B", 1, 40.0, 40.0, 0, 0, 90, 360, nothing],
        ["naive", "all", 3, 32.5, 30.0, 0, 0, 90, 360, 56.71],
    ]


def test_table1_is_per_material_and_stands_beside_the_paper(run):
    table = table1(tables.fits(run, MATERIALS, VARIANTS))
    assert list(zip(table["technique"], table["source"].str[:5], strict=True)) == [
        ("independent-g", "paper"),
        ("g-from-d", "paper"),
        ("naive", "ours"),
        ("naive", "paper"),
        ("bivariate", "ours"),
    ]
    assert table["source"][0] == "paper (Bagher et al. 2016, Table I)"
    ours = table.loc[2]
    assert ours["materials"] == 2
    # felt: 2 + 4 + 6 s, chrome: 4 + 8 + 12 s; three channels of 10 + 5 sweeps
    assert ours.filter(like="seconds").tolist() == [12, 18, 24]
    assert ours.filter(like="iterations").tolist() == [45, 45, 45]
    # only felt searched: 2 starts of 4 searches in each channel
    assert ours.filter(regex="gss_calls_").tolist() == [24, 24, 24]
    assert ours["materials_invoking_gss"] == 1
    assert table.loc[4].filter(like="gss").tolist() == [0, 0, 0, 0]
    assert table.loc[0].tolist()[2:] == [100, 59, 2838, 16421, 25, 1192, 10168, 1, 47, 2296, 57]


def test_published_averages_stand_in_the_papers_order():
    own = ["bivariate", "independent-g", "naive", "g-from-d"]
    assert [bagher2016.MEAN_PSNR_DB[name] for name in own] == [64.07, 58.22, 56.71, 56.42]
    values = list(bagher2016.MEAN_PSNR_DB.values())
    assert values == sorted(values, reverse=True)


def test_the_verb_writes_every_table_twice_the_same(run, tmp_path):
    lists = ["--scenes", *SCENES, "--materials", *MATERIALS, "--variants", *VARIANTS]
    psnr, fits = str(tmp_path / "t/psnr.csv"), str(tmp_path / "t/fits.csv")
    calls = {
        "psnr": ["--run", str(run), *lists],
        "fits": ["--run", str(run), *lists[3:]],
        "materials": ["--run", str(run), *lists[3:6]],
        "summary": ["--run", str(run), "--psnr", psnr],
        "table1": ["--fits", fits],
    }
    heads = {}
    for kind, options in calls.items():
        path = tmp_path / f"t/{kind}.csv"
        assert main(["tables", kind, *options, "-o", str(path)]) == 0
        first = path.read_bytes()
        assert main(["tables", kind, *options, "-o", str(path)]) == 0
        assert path.read_bytes() == first
        heads[kind] = first.decode().splitlines()[:2]
    assert heads["psnr"] == ["scene,material,variant,psnr_db,gap", "B,felt,naive,40,"]
    assert heads["materials"] == ["material,diffuseness", "felt,3.14159"]
    assert heads["summary"][1] == "naive,B,2,40,40,0,0,90,360,"


@pytest.mark.parametrize(
    ("path", "contents", "message"),
    [
        ("renders/A/felt/measured.exr", None, "measured.exr: no such file"),
        ("renders/A/felt/naive.exr", None, "naive.exr: no such file"),
        ("renders/A/felt/naive.exr", b"no picture", "naive.exr: not an OpenEXR file"),
    ],
)
def test_a_missing_or_foreign_picture(run, path, contents, message):
    (run / path).unlink()
    if contents:
        (run / path).write_bytes(contents)
    with pytest.raises(NpfmError, match=message):
        tables.psnr(run, ["A"], ["felt"], ["naive"])


def test_a_picture_of_another_size(run):
    write_exr(run / "renders/A/felt/naive.exr", np.ones((2, 2, 4)))
    with pytest.raises(NpfmError, match=r"naive\.exr: cannot be compared .* 2 x 2 .* 2 x 3 "):
        tables.psnr(run, ["A"], ["felt"], ["naive"])


@pytest.mark.parametrize("contents", [None, "{", "[]", "{}", '{"channels": [{"traces": []}]}'])
def test_a_missing_or_foreign_record(run, contents):
    record = run / "fits/naive/felt.json"
    record.unlink()
    if contents is not None:
        record.write_text(contents)
    with pytest.raises(NpfmError, match=r"felt\.json: cannot be read as the record"):
        tables.fits(run, ["felt"], ["naive"])


def test_diffuseness_wants_a_naive_fit(run):
    save(run / "fits/naive/felt.npz", a_fit("bivariate", np.ones((3, 30))))
    with pytest.raises(NpfmError, match="a fit of bivariate, not of naive"):
        tables.materials(run, ["felt"])


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (None, "No such file"),
        ("", "No columns"),
        ("scene,material,variant\nA,felt,naive\n", "psnr_db"),
        ("scene,material,variant,psnr_db\nA,felt,naive,high\n", "could not convert"),
        ('scene,material,variant,psnr_db\n"A,felt,naive,1\n', "a row is cut off"),
        ("scene,material,variant,psnr_db\nA,felt,naive,1\nA,silk,nai", "a row is cut off"),
        ("scene,material,variant,psnr_db\nA,felt,naive,1\nA,silk,naive,3", "a row is cut off"),
        ("scene,material,variant,psnr_db\nA,felt,naive,1,2\n", "too many columns"),
        ("scene;material;variant;psnr_db\nA;felt;naive;1\n", "columns expected but not found"),
        ("<html><body>", "a row is cut off"),
        ("scene,material,variant,psnr_db\n", "without rows"),
        ("scene,material,variant,psnr_db\n" + "A,felt,naive,1\n" * 2, "'A felt naive' is there"),
    ],
)
def test_a_bad_csv_is_told_in_one_line(tmp_path, contents, message, capsys):
    path = tmp_path / "psnr.csv"
    if contents is not None:
        path.write_text(contents)
    out = tmp_path / "summary.csv"
    call = ["tables", "summary", "--run", str(tmp_path), "--psnr", str(path), "-o", str(out)]
    assert main(call) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert str(path) in error
    assert message in error
    assert not out.exists()
