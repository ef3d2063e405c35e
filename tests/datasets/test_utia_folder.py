import numpy as np
import pytest

from npfm.__main__ import main
from npfm.datasets import utia_folder
from npfm.errors import NpfmError
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.table import Table
from npfm.reflectance.utia import write_bin


@pytest.fixture
def folder(tmp_path):
    for name, grid in (("m003_fabric", UTIA), ("wood", Directional(3, 8, 3, 8))):
        write_bin(tmp_path / f"{name}.bin", Table(np.ones((3, *grid.shape)), grid))
    (tmp_path / "readme.txt").touch()
    (tmp_path / ".half.bin").touch()
    return tmp_path


def test_lists_the_bin_files(folder):
    assert utia_folder.materials(folder) == ["m003_fabric", "wood"]


def test_finds_a_file_and_checks_it(folder):
    assert utia_folder.path(folder, "wood") == folder / "wood.bin"
    (folder / "cut.bin").write_bytes(b"\0" * 100)
    with pytest.raises(NpfmError, match=r"cut\.bin: 100 bytes"):
        utia_folder.path(folder, "cut")
    with pytest.raises(NpfmError, match=r"m003\.bin: no such file; did you mean m003_fabric"):
        utia_folder.path(folder, "m003")


def test_capitals_are_not_missed(folder):
    (folder / "SILK.BIN").touch()
    with pytest.raises(NpfmError, match=r"rename it to SILK\.bin"):
        utia_folder.materials(folder)


def test_no_folder(tmp_path):
    with pytest.raises(NpfmError, match=r"the folder of the UTIA \.bin files"):
        utia_folder.materials(tmp_path / "none")


def test_a_material_is_linked_to(folder, tmp_path):
    out = tmp_path / "run" / "wood.bin"
    for _ in range(2):
        assert main(f"material --utia wood --from {folder} -o {out}".split()) == 0
    assert out.is_symlink()
    assert out.resolve() == (folder / "wood.bin").resolve()


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("--utia wood --from {0} -o {0}/b.bin", "lies among the measurements"),
        ("--utia wood --from {0} -o {0}/run/b.binary", "give a name that ends in .bin\n"),
        ("--utia ../wood --from {0} -o {0}/run/b.bin", "rename the file"),
        ("--utia wood -o {0}/run/b.bin", "need --from"),
        ("--synthetic-anisotropic satin -o {0}/run/b.binary", "give a name that ends in .bin\n"),
        ("--synthetic chalk -o {0}/run/b.bin", "give a name that ends in .binary\n"),
    ],
)
def test_what_cannot_be_written_is_one_line(folder, capfd, call, said):
    assert main(["material", *call.format(folder).split()]) == 1
    error = capfd.readouterr().err
    assert said in error
    assert error.count("\n") == 1
