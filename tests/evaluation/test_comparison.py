import numpy as np
import OpenEXR
import pytest

from npfm.__main__ import main
from npfm.evaluation.comparison import decibels
from npfm.storage.pictures import write_exr


@pytest.fixture
def pictures(tmp_path):
    """Reference of radiance 2 in the left half, and two pictures that differ from it."""
    reference = np.zeros((2, 4, 4))
    reference[:, :2] = (2, 2, 2, 1)
    off = reference + np.array([0.2, 0.2, 0.2, 0])
    paths = [str(tmp_path / name) for name in ("measured.exr", "same.exr", "off.exr")]
    for path, pixels in zip(paths, (reference, reference, off), strict=True):
        write_exr(path, pixels)
    return paths


def test_psnr_over_the_foreground_of_the_reference(pictures):
    same, off = decibels(pictures[0], pictures[1:])
    assert same == float("inf")
    assert off == pytest.approx(20, abs=1e-4)


def test_without_alpha_every_pixel_counts(tmp_path):
    reference, picture = np.ones((2, 2, 3)), np.ones((2, 2, 3))
    picture[0] += 0.1
    write_exr(tmp_path / "r.exr", reference)
    write_exr(tmp_path / "p.exr", picture)
    [value] = decibels(tmp_path / "r.exr", [tmp_path / "p.exr"])
    assert value == pytest.approx(20 + 10 * np.log10(2), abs=1e-4)


def test_the_verb_prints_a_table_and_gathers_the_parts(pictures, tmp_path, capsys):
    assert main(["compare", *pictures, "-o", str(tmp_path / "all.exr")]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines == [["picture", "psnr_db"], ["same", "inf"], ["off", "20.00"]]
    with OpenEXR.File(str(tmp_path / "all.exr")) as file:
        assert [part.name() for part in file.parts] == ["measured", "same", "off"]
        np.testing.assert_allclose(file.parts[2].channels["RGBA"].pixels[0, 0], (2.2, 2.2, 2.2, 1))


def test_pictures_of_the_same_name_go_by_their_paths(pictures, tmp_path, capsys):
    other = str(tmp_path / "other" / "measured.exr")
    write_exr(other, np.ones((2, 4, 4)))
    assert main(["compare", pictures[0], other]) == 0
    assert capsys.readouterr().out.splitlines()[1].startswith(f"{other}  ")


def test_a_reference_without_foreground(tmp_path, capsys):
    path = str(tmp_path / "empty.exr")
    write_exr(path, np.zeros((2, 2, 4)))
    assert main(["compare", path, path, "-o", str(tmp_path / "all.exr")]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "none of the 4 pixels is foreground" in error
    assert not (tmp_path / "all.exr").exists()
