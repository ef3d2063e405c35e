import numpy as np
import pytest
from bsdf import fields, tensor_file
from glossy import glossy

from npfm.__main__ import main
from npfm.datasets import rgl_folder
from npfm.errors import NpfmError
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table_files import read_table, write_table

TURNED = np.linspace(-np.pi, 0, 4)


@pytest.fixture
def folder(tmp_path):
    rng = np.random.default_rng(2)
    for name, azimuths in (("paint_rgb", (0.0,)), ("brushed_rgb", TURNED)):
        (tmp_path / f"{name}.bsdf").write_bytes(tensor_file(fields(rng, phi_i=azimuths)))
    spectral = fields(rng)
    spectral["spectra"] = spectral.pop("rgb")
    (tmp_path / "paint_spec.bsdf").write_bytes(tensor_file(spectral))
    (tmp_path / "readme.txt").touch()
    (tmp_path / ".half.bsdf").touch()
    return tmp_path


def test_lists_the_bsdf_files(folder):
    assert rgl_folder.materials(folder) == ["brushed_rgb", "paint_rgb", "paint_spec"]


def test_an_isotropic_material_is_on_the_merl_grid(folder):
    assert not rgl_folder.anisotropic(folder, "paint_rgb")
    table = rgl_folder.load(folder, "paint_rgb", Directional(3, 8, 3, 8))
    assert table.grid == MERL
    assert np.isfinite(table.values).all()
    cos_i, cos_o = MERL.cosines
    np.testing.assert_array_equal(table.valid[0], (cos_i > 0) & (cos_o > np.cos(np.radians(89))))


def test_an_anisotropic_one_is_on_a_directional_grid(folder):
    assert rgl_folder.anisotropic(folder, "brushed_rgb")
    assert rgl_folder.load(folder, "brushed_rgb").grid == UTIA
    coarse = Directional(3, 8, 3, 8)
    table = rgl_folder.load(folder, "brushed_rgb", coarse)
    assert (table.grid, table.valid.all()) == (coarse, True)


def test_what_cannot_be_loaded_is_named(folder):
    with pytest.raises(NpfmError, match=r"paint_spec\.bsdf: has spectra.*_rgb\.bsdf"):
        rgl_folder.load(folder, "paint_spec")
    with pytest.raises(NpfmError, match=r"paint\.bsdf: no such file; did you mean paint_rgb"):
        rgl_folder.load(folder, "paint")
    with pytest.raises(NpfmError, match=r"the folder of the RGL \.bsdf files"):
        rgl_folder.materials(folder / "none")
    (folder / "SILK.BSDF").touch()
    with pytest.raises(NpfmError, match=r"rename it to SILK\.bsdf"):
        rgl_folder.materials(folder)


def test_a_black_channel_is_told(folder):
    arrays = fields(np.random.default_rng(2))
    arrays["rgb"][:, :, 1] = -0.1
    (folder / "red_rgb.bsdf").write_bytes(tensor_file(arrays))
    with pytest.raises(NpfmError, match=r"red_rgb\.bsdf: the green channel is 0 or not measured"):
        rgl_folder.load(folder, "red_rgb")


def test_a_material_is_written_as_a_table(folder, tmp_path):
    out = tmp_path / "run" / "paint.binary"
    assert main(f"material --rgl paint_rgb --from {folder} -o {out}".split()) == 0
    written, table = read_table(out), rgl_folder.load(folder, "paint_rgb")
    np.testing.assert_array_equal(written.valid, table.valid)
    np.testing.assert_allclose(written.values[table.valid], table.values[table.valid])
    out = tmp_path / "run" / "brushed.bin"
    call = f"material --rgl brushed_rgb --from {folder} --shape 3x8x3x8 -o {out}"
    assert main(call.split()) == 0
    assert read_table(out).grid == Directional(3, 8, 3, 8)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("--rgl paint_rgb --from {0} -o {0}/b.bin", "give a name that ends in .binary\n"),
        ("--rgl brushed_rgb --from {0} -o {0}/b.binary", "give a name that ends in .bin\n"),
        ("--rgl ../paint --from {0} -o {0}/b.binary", "rename the file"),
        ("--rgl paint_rgb -o {0}/b.binary", "need --from"),
        ("--rgl paint_rgb --from {0} --shape 3x8x3x8 -o {0}/b.binary", "paint_rgb is isotropic"),
        ("--rgl brushed_rgb --from {0} --shape 3x8 -o {0}/b.bin", "does not have 2 axes"),
        ("--synthetic chalk --shape 3x8x3x8 -o {0}/b.binary", "--shape goes with"),
    ],
)
def test_what_cannot_be_written_is_one_line(folder, capfd, call, said):
    assert main(["material", *call.format(folder).split()]) == 1
    error = capfd.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_what_is_exported_is_read_again(tmp_path):
    """The export puts the view where the database has the light: of a reciprocal table the same."""
    table = glossy()
    write_table(tmp_path / "gloss.binary", table)
    call = f"export {tmp_path}/gloss.binary --to bsdf --views 12 --size 48 -o {tmp_path}/gloss.bsdf"
    assert main(call.split()) == 0
    again = rgl_folder.load(tmp_path, "gloss")
    inner = np.minimum(*MERL.cosines) > np.cos(np.radians(70))
    assert again.valid[:, inner].all()
    error = np.abs(again.values[:, inner] / table.values[:, inner] - 1)
    assert np.median(error) < 0.005
    assert np.quantile(error, 0.99) < 0.03
