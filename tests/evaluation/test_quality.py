import math
import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import quality, tables
from npfm.evaluation.comparison import decibels
from npfm.evaluation.quality_of_fits import compare, material
from npfm.evaluation.table_distances import distances
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.storage.pictures import tone_map, write_exr, write_png

GRID = HalfDifference(6, 5, 4)


def render(path, radiance):
    """What npfm render leaves: radiance with coverage, and display values beside it."""
    coverage = np.zeros(radiance.shape[:2])
    coverage[2:-2, 2:-2] = 1
    write_exr(path, np.dstack([radiance, coverage]))
    write_png(path.with_suffix(".png"), tone_map(radiance, 1.0, 2.2))


@pytest.fixture
def run(tmp_path):
    """Pictures of one material in two scenes: `same` equals the measurement, `far` does not."""
    rng = np.random.default_rng(0)
    for scene in "AB":
        radiance = np.float32(rng.random((16, 16, 3)))
        folder = tmp_path / "renders" / scene / "felt"
        for name, factor in (("measured", 1), ("same", 1), ("near", 1.05), ("far", 1.5)):
            render(folder / f"{name}.exr", factor * radiance)
    return tmp_path


def tabulate(path):
    path = Path(path)
    factors = {"felt.binary": 1.0, "same": 1.0, "near": 1.05, "far": 1.5}
    key = path.name if path.suffix == ".binary" else path.parent.name
    return Table(np.full((3, *GRID.shape), factors[key]), GRID)


def test_a_material_by_every_metric(run):
    table = material(run, ["A", "B"], "felt.binary", ["same", "near", "far"], tabulate)
    assert list(table.columns) == list(quality.COLUMNS)
    assert len(table) == 2 * 3 * len(quality.PICTURES) + 3 * len(quality.TABLES)
    values = table.set_index(["metric", "scene", "variant"])["value"].sort_index()
    for metric, described in quality.METRICS.items():
        for scene in "AB" if metric in quality.PICTURES else [quality.ALL]:
            same, near, far = values[metric, scene][["same", "near", "far"]]
            if described.better == "higher":
                assert same > near > far
            else:
                assert 0 == same < near < far
    folder = run / "renders/A/felt"
    assert values["psnr", "A", "far"] == decibels(folder / "measured.exr", [folder / "far.exr"])[0]
    expected = distances(tabulate(run / "far/felt.npz"), tabulate(run / "felt.binary"))
    assert values["cube-root", "all", "far"] == expected["cube-root"]


def test_pictures_that_are_not_finite_have_no_number_by_any_metric(run):
    folder = run / "renders/A/felt"
    radiance = np.ones((16, 16, 3))
    radiance[8, 8, 1] = np.nan
    with np.errstate(invalid="ignore"):
        write_exr(folder / "far.exr", np.dstack([radiance, np.ones((16, 16))]))
    near, far = compare(folder / "measured.exr", [folder / "near.exr", folder / "far.exr"])
    assert all(math.isnan(value) for value in far.values())
    assert all(math.isfinite(value) for value in near.values())


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda f: (f / "far.png").unlink(), r"far\.png: no such picture; make it with npfm"),
        (lambda f: (f / "far.png").write_bytes(b"\x89PNG\r\n\x1a\n"), r"far\.png: not a PNG"),
        (lambda f: (f / "far.exr").unlink(), r"far\.exr: no such file"),
        (lambda f: write_png(f / "far.png", np.zeros((4, 4, 3), np.uint8)), "of another size"),
        (lambda f: render(f / "far.exr", np.ones((8, 8, 3))), "cannot be compared"),
        (lambda f: write_exr(f / "measured.exr", np.zeros((16, 16, 4))), "no pixel that an object"),
    ],
)
def test_what_cannot_be_compared_is_said_in_a_line(run, damage, message):
    folder = run / "renders/A/felt"
    damage(folder)
    with pytest.raises(NpfmError, match=message):
        compare(folder / "measured.exr", [folder / "far.exr"])


def test_the_verb_compare_prints_them(run, capsys):
    folder = run / "renders/A/felt"
    shutil.copy(folder / "far.exr", folder / "other.exr")
    shutil.copy(folder / "far.png", folder / "other.png")
    call = ["compare", "--metrics", *(f"{folder}/{n}.exr" for n in ("measured", "same", "other"))]
    assert main(call) == 0
    head, same, other = (line.split() for line in capsys.readouterr().out.splitlines())
    assert head == ["picture", *quality.PICTURES]
    assert same[:4] == ["same", "inf", "inf", "1.0000"]
    assert all(float(a) > float(b) for a, b in zip(same[1:4], other[1:4], strict=True))


@pytest.fixture
def table():
    rows = [
        (scene, m, v, "ssim", value, "1", "higher")
        for scene, m, v, value in [
            ("A", "felt", "far", 0.5), ("A", "silk", "far", 0.7), ("B", "felt", "far", 0.9),
            ("B", "silk", "far", math.nan), ("A", "felt", "near", 1.0),
        ]
    ]  # fmt: skip
    rows.append(("all", "felt", "far", "cube-root", 0.25, "sr^(-1/3)", "lower"))
    return pd.DataFrame(rows, columns=quality.COLUMNS)


def test_means_over_materials_and_scenes(table):
    found = quality.summary(table)
    assert list(found.variant.unique()) == ["far", "near"]
    found = found.set_index(["variant", "scene", "metric"]).sort_index()
    assert found.loc[("far", "A", "ssim"), ["mean", "materials"]].tolist() == [0.6, 2]
    assert found.loc[("far", "B", "ssim"), ["mean", "materials"]].tolist() == [0.9, 1]
    assert found.loc[("far", "all", "ssim"), "mean"] == pytest.approx(0.7)
    assert found.loc[("far", "all", "ssim"), "median"] == pytest.approx(0.7)
    assert found.loc[("far", "all", "cube-root"), "mean"] == 0.25


def test_tables_are_gathered_and_read_again(table, tmp_path):
    tables.write(tmp_path / "felt.csv", table[table.material == "felt"])
    tables.write(tmp_path / "silk.csv", table[table.material == "silk"])
    found = quality.gather([tmp_path / "felt.csv", tmp_path / "silk.csv"])
    assert len(found) == len(table) and set(found.material) == {"felt", "silk"}
    tables.write(tmp_path / "twice.csv", pd.concat([table, table]))
    with pytest.raises(NpfmError, match="'A felt far ssim' is there twice"):
        quality.read(tmp_path / "twice.csv")
    tables.write(tmp_path / "odd.csv", table.assign(metric="ssmi"))
    with pytest.raises(NpfmError, match="unknown metric 'ssmi'; did you mean ssim"):
        quality.read(tmp_path / "odd.csv")
    with pytest.raises(NpfmError, match="no value of 'hyab'"):
        quality.values_of(table, "hyab")
