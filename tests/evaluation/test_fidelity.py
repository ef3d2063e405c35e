"""PSNR of tables and pictures by two peaks, against numbers worked out by hand."""

import numpy as np
import pandas as pd
import pytest

from npfm.evaluation import fidelity, tables
from npfm.evaluation.fidelity import numerical_psnr
from npfm.evaluation.metrics import psnr
from npfm.figures import fidelity as figure
from npfm.reflectance.directional import Directional
from npfm.reflectance.table import Table
from npfm.storage.pictures import write_exr

GRID = Directional(2, 2, 2, 2)


def table(values):
    return Table(np.broadcast_to(np.asarray(values, dtype=float), (3, *GRID.shape)), GRID)


def test_a_table_by_both_peaks():
    measured = np.ones((3, *GRID.shape))
    measured[0, 0] = 3.0
    mean = measured.mean()
    by_largest, by_mean = numerical_psnr(table(measured + 0.1), table(measured))
    assert by_largest == pytest.approx(20 * np.log10(3 / 0.1))
    assert by_mean == pytest.approx(20 * np.log10(255 * mean / 0.1))


def test_only_what_is_measured_counts():
    measured = np.ones((3, *GRID.shape))
    measured[:, 1] = -1.0
    fit = np.where(measured > 0, 1.01, 1e6)
    assert numerical_psnr(table(fit), table(measured))[0] == pytest.approx(40)


def test_equal_and_black_tables():
    assert numerical_psnr(table(1.0), table(1.0)) == (np.inf, np.inf)
    assert np.isnan(numerical_psnr(table(1.0), table(0.0))).all()


@pytest.fixture
def run(tmp_path):
    """Pictures of two scenes and tables of one material, and a table of PSNR."""
    rng = np.random.default_rng(3)
    foreground = np.ones((6, 6), dtype=bool)
    rows = []
    for scene, level in (("A", 1.0), ("B", 40.0)):
        reference = (level * rng.random((6, 6, 3))).astype(np.float32)
        picture = (reference + level * 0.01).astype(np.float32)
        folder = tmp_path / "renders" / scene / "satin"
        for name, radiance in (("measured", reference), ("mine", picture)):
            write_exr(folder / f"{name}.exr", np.dstack([radiance, foreground.astype(np.float32)]))
        rows.append((scene, "satin", "mine", psnr(picture, reference, foreground), reference))
    return tmp_path, rows


def test_pictures_by_both_peaks_do_not_depend_on_the_brightness_of_the_light(run):
    folder, rows = run
    listed = pd.DataFrame(
        [r[:4] for r in rows], columns=["scene", "material", "variant", "psnr_db"]
    )
    read = {"satin.bin": table(1.0), str(folder / "fits/mine/satin.npz"): table(1.1)}
    found = fidelity.fidelity(folder, listed, {"satin": "satin.bin"}, lambda path: read[str(path)])
    assert tuple(found.columns) == fidelity.COLUMNS
    [row] = found.to_dict("records")
    assert row["rendering_db"] == pytest.approx(listed["psnr_db"].mean())
    expected = [
        20 * np.log10(255 * r[4].astype(float).mean() / (0.01 * level))
        for r, level in zip(rows, (1.0, 40.0), strict=True)
    ]
    assert row["rendering_8_bit_db"] == pytest.approx(np.mean(expected), abs=0.01)
    assert row["numerical_db"] == pytest.approx(20)
    assert row["numerical_8_bit_db"] == pytest.approx(20 + 20 * np.log10(255))


def test_the_figure_shows_every_material_in_the_order_of_the_first_variant(tmp_path):
    rows = [
        (material, variant, *(np.array([30.0, 60, 25, 50]) + 5 * k - 3 * (variant == "b")))
        for k, material in enumerate(("twill", "satin", "wood"))
        for variant in ("a", "b")
    ]
    rows[0] = ("twill", "a", np.inf, np.nan, 20.0, 40.0)
    tables.write(tmp_path / "t.csv", pd.DataFrame(rows, columns=list(fidelity.COLUMNS)))
    read = tables.read(tmp_path / "t.csv", ["material", "variant"], list(figure.PANELS))
    drawn = figure.draw(read)
    assert [label.get_text() for label in drawn.axes[-1].get_xticklabels()] == [
        "satin",
        "wood",
        "twill",
    ]
    assert [line.get_label() for line in drawn.axes[0].get_lines()] == ["a: 37.5 dB", "b: 32.0 dB"]
