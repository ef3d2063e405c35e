import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import tables
from npfm.figures import delta_e, extraction_time, roughness, side_by_side
from npfm.storage.pictures import write_exr, write_png

MATERIALS = ["steel", "felt"]
VARIANTS = ["ggx", "shifted-gamma-published"]


@pytest.fixture
def folder(tmp_path):
    """Pictures of a scene: materials measured and fitted, and at three roughnesses."""
    for k, material in enumerate(MATERIALS):
        (tmp_path / material).mkdir()
        write_exr(tmp_path / material / "measured.exr", np.ones((4, 4, 4)))
        for name in ("measured", *VARIANTS, "0.5", "1", "2", "textured"):
            write_png(tmp_path / material / f"{name}.png", np.full((4, 4, 3), 60 * k, np.uint8))
    return tmp_path


def differences():
    rows = [(m, v, 1.0 + i + j) for i, m in enumerate(MATERIALS) for j, v in enumerate(VARIANTS)]
    return pd.DataFrame(rows, columns=["material", "variant", "delta_e"])


def surfaces():
    rows = [("steel", "False", 0.02), ("felt", "True", 0.4)]
    return pd.DataFrame(rows, columns=["material", "resolved", "alpha_ggx"])


def test_all_images_are_on_one_scale_with_their_means():
    images = {name: np.full((4, 4), 2.0 + k) for k, name in enumerate(VARIANTS)}
    figure = delta_e.draw(images, differences())
    *panels, bar = figure.axes
    assert {ax.images[0].get_clim() for ax in panels} == {(0, 3.0)}
    assert [ax.get_xlabel() for ax in panels] == [
        "mean 1.50\n2 materials",
        "mean 2.50\n2 materials",
    ]
    assert bar.get_ylabel() == "CIEDE2000"


def test_every_part_and_their_sum_are_drawn():
    rows = [(n, part, 0.1 * n) for n in (45, 90) for part in extraction_time.PARTS]
    figure = extraction_time.draw(pd.DataFrame(rows, columns=["nodes", "part", "seconds"]))
    lines = {line.get_label(): line.get_ydata() for line in figure.axes[0].get_lines()}
    assert len(lines) == 5
    np.testing.assert_allclose(lines["a material, D to F"], [3 * 4.5, 3 * 9])


def test_of_anisotropic_surfaces_the_dense_matrix_ends_where_it_is_too_large():
    rows = [(n, part, 0.1 * n) for n in (45, 90) for part in extraction_time.ANISOTROPIC]
    figure = extraction_time.draw(pd.DataFrame(rows[:-2], columns=["nodes", "part", "seconds"]))
    lines = {line.get_label(): line.get_ydata() for line in figure.axes[0].get_lines()}
    assert list(lines) == list(extraction_time.ANISOTROPIC.values())
    assert np.isnan(lines[extraction_time.ANISOTROPIC["dense"]][-1])


def test_anisotropic_roughness_has_two_numbers(folder, tmp_path):
    rows = [("steel", 0.05, 0.5), ("felt", 0.4, 0.4)]
    table = pd.DataFrame(rows, columns=["material", "alpha_x", "alpha_y"])
    tables.write(tmp_path / "surfaces.csv", table)
    call = f"figure roughness --pictures {folder} --materials steel felt --factors 0.5 2 textured"
    out = tmp_path / "a.png"
    assert main(f"{call} --surfaces {tmp_path}/surfaces.csv -o {out}".split()) == 0
    figure = roughness.draw(folder, MATERIALS, ["0.5", "2", "textured"], table)
    told = [text.get_text() for ax in figure.axes for text in ax.texts]
    assert told[:2] == ["$\\alpha$ 0.025, 0.25", "$\\alpha$ 0.1, 1"]


def test_a_row_a_material_and_a_column_a_model(folder):
    columns = {"measured": folder} | dict.fromkeys(VARIANTS, folder)
    figure = side_by_side.draw(columns, MATERIALS, differences())
    assert len(figure.axes) == 6
    assert [ax.get_title() for ax in figure.axes[:2]] == ["measured", "ggx"]
    texts = [[text.get_text() for text in ax.texts] for ax in figure.axes]
    assert texts[:3] == [[], ["$\\Delta$E 1.0"], ["$\\Delta$E 2.0"]]
    (folder / "felt" / "ggx.png").unlink()
    with pytest.raises(NpfmError, match=r"felt.ggx\.png: no such picture"):
        side_by_side.draw(columns, MATERIALS, differences())


def test_roughness_is_told_where_it_is_known(folder):
    figure = roughness.draw(folder, MATERIALS, ["0.5", "1", "2"], surfaces())
    assert [ax.get_title() for ax in figure.axes[:3]] == ["slopes x 0.5", "as fitted", "slopes x 2"]
    told = [ax.texts[0].get_text() for ax in figure.axes]
    assert told == ["$\\alpha$ not resolved"] * 3 + [
        "$\\alpha$ 0.2",
        "$\\alpha$ 0.4",
        "$\\alpha$ 0.8",
    ]
    figure = roughness.draw(folder, ["felt"], ["1", "textured"], surfaces())
    assert figure.axes[1].get_title() == "by a texture"
    assert not figure.axes[1].texts
    with pytest.raises(NpfmError, match=r"4\.png: no such picture"):
        roughness.draw(folder, MATERIALS, ["4"], surfaces())


def test_the_verbs_make_the_same_bytes_again(folder):
    fits = f"--fits {' '.join(f'{variant}={folder}' for variant in VARIANTS)}"
    shared = f"--measured {folder} {fits} --materials {' '.join(MATERIALS)}"
    table, images = folder / "table.csv", folder / "images.exr"
    call = f"power-iterations delta-e {shared} -o {table} --images {images}"
    assert main(call.split()) == 0
    tables.write(folder / "surfaces.csv", surfaces())
    calls = {
        "delta_e": f"--images {images} --table {table}",
        "side_by_side": f"{shared} --table {table}",
        "roughness": f"--pictures {folder} --materials felt --factors 1 2"
        f" --surfaces {folder}/surfaces.csv",
    }
    for figure, arguments in calls.items():
        made = [folder / f"{figure}-{k}.png" for k in range(2)]
        for path in made:
            assert main(f"figure {figure} {arguments} -o {path}".split()) == 0
        assert made[0].read_bytes() == made[1].read_bytes()
