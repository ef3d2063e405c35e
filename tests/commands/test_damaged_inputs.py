"""What the verbs say to files that are not what they seem: one line, and nothing is written."""

import struct
import zipfile

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.fitting import fits
from npfm.reflectance.merl import FILE_BYTES

#: A fit that may be wrong in one thing.
GOOD = {
    "format": fits.FORMAT,
    "model": "bivariate",
    "units": fits.UNITS,
    "grid": np.array([90, 90, 180]),
    "B": np.ones((3, 90, 90), "f4"),
}


def refused(capsys, arguments, said):
    """Run a verb that has to fail in one line, and nowhere near a traceback."""
    assert main([str(a) for a in arguments]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(f"npfm {arguments[0]}: ")
    assert said in error, error


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"model": "bivariat"}, "fit.npz: unknown model 'bivariat'; did you mean bivariate"),
        ({"model": "../config"}, "fit.npz: unknown model '../config'"),
        ({"B": np.ones((3, 90, 1), "f4")}, "fit.npz: its arrays (B (3, 90, 1)) are not those of"),
        ({"model": "naive"}, "fit.npz: its arrays (B (3, 90, 90)) are not those of naive"),
        ({"grid": np.array([18, 18, 36])}, "fit.npz: its arrays (B (3, 90, 90)) are not those"),
        ({"B": np.full((3, 90, 90), np.nan, "f4")}, "fit.npz: B holds a NaN"),
        ({"units": "?"}, "fit.npz: the units are '?'"),
    ],
)
def test_a_fit_that_is_none(tmp_path, capsys, changes, said):
    np.savez(tmp_path / "fit.npz", **{**GOOD, **changes})
    out = tmp_path / "out.binary"
    refused(capsys, ["tabulate", tmp_path / "fit.npz", "-o", out], said)
    assert not out.exists()


def test_a_sound_fit_is_tabulated(tmp_path):
    np.savez(tmp_path / "fit.npz", **GOOD)
    assert main(["tabulate", str(tmp_path / "fit.npz"), "-o", str(tmp_path / "out.binary")]) == 0


def test_a_table_that_is_none(tmp_path, capsys):
    path = tmp_path / "big-endian.binary"
    with open(path, "wb") as file:
        file.write(struct.pack(">3i", 90, 90, 180))
        file.truncate(FILE_BYTES)
    out = tmp_path / "out.npz"
    fit = ["fit", path, "--model", "bivariate", "-o", out]
    refused(capsys, fit, "big-endian.binary: the header is in the other byte order")
    material = ["material", "--merl", "big-endian", "--from", tmp_path, "-o", tmp_path / "l.binary"]
    refused(capsys, material, "big-endian.binary: the header is in the other byte order")
    assert [p.name for p in tmp_path.iterdir()] == ["big-endian.binary"]


def test_a_network_that_is_none(tmp_path, capsys):
    with zipfile.ZipFile(tmp_path / "n.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a/felt.h5", bytes(2**24))
    out = tmp_path / "felt.binary"
    arguments = ["material", "--neural", "felt", "--from", tmp_path / "n.zip", "-o", out]
    refused(capsys, arguments, "n.zip: cannot be read as the zip of the neural materials")
    assert not out.exists()


def test_published_factors_that_are_none(tmp_path, capsys):
    np.savez(tmp_path / "fit.npz", **GOOD | {name: np.ones((3, 90), "f4") for name in "DGF"})
    with open(tmp_path / "npf.npz", "wb") as file:
        np.save(file, np.ones(3))
    out = tmp_path / "figure06.png"
    arguments = ["figure", "figure06", "--fits", tmp_path / "fit.npz"]
    arguments += ["--published", tmp_path / "npf.npz", "-o", out]
    refused(capsys, arguments, "npf.npz: looks like a single NumPy array (.npy), not published")
    assert not out.exists()
