"""Every verb on ``.bin`` files: what it makes of them, or the one line with which it refuses."""

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.fitting import fits
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
from npfm.reflectance.utia import read_bin, write_bin
from npfm.rendering import transport
from npfm.storage.pictures import read_exr

SMALL = "--objects sphere --resolution 12 --samples 64"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Two materials, a fit of MERL's, and scenes for tables of either kind."""
    folder = tmp_path_factory.mktemp("directional")
    light = f"--light {folder}/grove.exr {SMALL}"
    for call in [
        f"material --synthetic-anisotropic brushed-steel -o {folder}/steel.bin",
        f"material --synthetic-anisotropic satin -o {folder}/satin.bin",
        f"material --synthetic-anisotropic satin --shape 3x12x3x12 -o {folder}/coarse.bin",
        f"light --generate grove --height 16 -o {folder}/grove.exr",
        f"scene {light} --grid directional -o {folder}/scene",
        f"scene {light} --grid directional 3x12x3x12 -o {folder}/coarse",
        f"scene {light} --record {folder}/merl.json -o {folder}/merl",
        f"render {folder}/scene {folder}/steel.bin -o {folder}/steel.exr",
        f"render {folder}/scene {folder}/satin.bin -o {folder}/satin.exr",
    ]:
        assert main(call.split()) == 0, call
    cells = np.ones((3, 90, 90), dtype=np.float32)
    fits.save(folder / "isotropic.npz", fits.Fit("bivariate", {"B": cells}, MERL))
    return folder


def test_a_scene_is_for_the_grid_that_it_names(made):
    assert transport.load(made / "scene").grid == UTIA
    assert transport.load(made / "coarse").grid == Directional(3, 12, 3, 12)
    assert transport.load(made / "merl").grid == MERL


def test_a_picture_is_rendered(made):
    expected = transport.render(transport.load(made / "scene"), read_bin(made / "steel.bin"))
    np.testing.assert_array_equal(read_exr(made / "steel.exr"), expected)
    assert (made / "steel.png").is_file()


def test_finer_and_coarser_tables_are_rendered_in_scenes_of_theirs(made, tmp_path):
    call = f"render {made}/coarse {made}/coarse.bin -o {tmp_path}/a.exr"
    assert main(call.split()) == 0


def test_pictures_are_compared(made, capsys):
    assert main(f"compare {made}/steel.exr {made}/satin.exr".split()) == 0
    assert "satin" in capsys.readouterr().out


def test_a_material_varies(made, tmp_path):
    call = f"vary {made}/scene {made}/steel.bin {made}/satin.bin --objects sphere"
    assert main(f"{call} -o {tmp_path}/worn.exr".split()) == 0
    worn, steel, satin = (
        read_exr(path) for path in (tmp_path / "worn.exr", made / "steel.exr", made / "satin.exr")
    )
    least, most = np.minimum(steel, satin), np.maximum(steel, satin)
    assert ((worn >= least - 1e-4) & (worn <= most + 1e-4)).all()
    assert not np.array_equal(worn, steel)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ("fit {0}/steel.bin --model naive -o {1}/a.npz", "'naive' is not for tables on a direct"),
        ("fit {0}/none.bin --model naive -o {1}/a.npz", "none.bin: no such file"),
        ("render {0}/merl {0}/steel.bin -o {1}/a.exr", "build the scene for the grid of the tab"),
        ("render {0}/scene {0}/coarse.bin -o {1}/a.exr", "built for directional 6x48x6x48"),
        (
            "render {0}/scene {0}/isotropic.npz -o {1}/a.exr",
            "is on the grid half-difference 90x90x180",
        ),
        (
            "render {0}/merl {0}/isotropic.npz --measured {0}/steel.bin -o {1}/a.exr",
            "give the table that the fit was made from",
        ),
        (
            "vary {0}/merl {0}/steel.bin {0}/satin.bin --objects sphere -o {1}/a.exr",
            "build the scene for the grid of the table",
        ),
        ("tabulate {0}/isotropic.npz -o {1}/a.bin", "give a name that ends in .binary"),
        ("tabulate {0}/steel.bin -o {1}/a.bin", "cannot be read as a fit"),
        ("edit {0}/steel.bin --roughness 2 -o {1}/a.npz", "cannot be read as a fit"),
        ("texture {0}/steel.bin -o {1}/a.exr", "cannot be read as a fit"),
        ("figure figure03 --table {0}/steel.bin -o {1}/a.pdf", "give a MERL .binary file"),
        (
            "effects-cost compare {0}/merl --tables {0}/steel.bin --fits {0}/isotropic.npz"
            " -o {1}/a.csv --pictures {1}/a.exr",
            "give the table that the fit was made from",
        ),
        (
            "effects-cost compare {0}/merl --tables {0}/steel.bin --fits {0}/steel.bin"
            " -o {1}/a.csv --pictures {1}/a.exr",
            "the scene was built for half-difference 90x90x180",
        ),
        (
            "scene --light {0}/grove.exr --objects sphere --grid directional 6x48 -o {1}/a",
            "a directional grid does not have 2 axes",
        ),
        (
            "scene --light {0}/grove.exr --objects sphere --grid directed -o {1}/a",
            "unknown kind of grid 'directed'; did you mean directional",
        ),
        (
            "material --synthetic chalk --shape 6x48x6x48 -o {1}/a.binary",
            "--shape goes with --synthetic-anisotropic",
        ),
        (
            "material --synthetic-anisotropic satin --shape 6x48 -o {1}/a.bin",
            "a directional grid does not have 2 axes",
        ),
    ],
)
def test_what_a_verb_cannot_do_with_it_is_one_line(made, tmp_path, capfd, call, said):
    assert main(call.format(made, tmp_path).split()) == 1
    error = capfd.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_fit_on_a_grid_that_its_model_is_not_for_is_refused(made, tmp_path, capfd):
    arrays = {"B": np.ones((3, 6, 48), dtype=np.float32)}
    fits.save(tmp_path / "odd.npz", fits.Fit("bivariate", arrays, UTIA))
    assert main(f"tabulate {tmp_path}/odd.npz -o {tmp_path}/a.bin".split()) == 1
    assert "'bivariate' is not for tables on a directional grid" in capfd.readouterr().err


def test_a_measurement_masks_only_fits_on_its_grid():
    values = np.ones((3, 2, 1, 2, 1))
    measured = Table(
        np.where(np.arange(2)[:, None, None, None], values, -1), Directional(2, 1, 2, 1)
    )
    masked = Table(3 * values, measured.grid).where_measured(measured)
    np.testing.assert_array_equal(masked.values, np.where(measured.values < 0, -1, 3))


def test_a_table_of_a_users_is_not_replaced_by_a_fit_of_another(tmp_path, capfd):
    """A name that ends in .bin is that of many things."""
    (tmp_path / "cd.bin").write_bytes(b"CD001" * 100)
    call = f"material --synthetic-anisotropic satin -o {tmp_path}/cd.bin"
    assert main(call.split()) == 1
    assert "not a table of the UTIA format written by npfm" in capfd.readouterr().err
    assert (tmp_path / "cd.bin").read_bytes() == b"CD001" * 100


def test_bytes_are_the_same_every_time(tmp_path):
    for name in ("one", "other"):
        call = f"material --synthetic-anisotropic twill --seed 7 -o {tmp_path}/{name}.bin"
        assert main(call.split()) == 0
    assert (tmp_path / "one.bin").read_bytes() == (tmp_path / "other.bin").read_bytes()
    write_bin(tmp_path / "third.bin", read_bin(tmp_path / "one.bin"))
    assert (tmp_path / "third.bin").read_bytes() == (tmp_path / "one.bin").read_bytes()
