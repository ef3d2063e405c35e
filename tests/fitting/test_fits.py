"""Fit files: whole, self-explaining, byte for byte the same."""

import json
import zipfile

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting import fits
from npfm.fitting.fits import ChannelRecord, Fit, Trace
from npfm.reflectance.half_difference import HalfDifference


@pytest.fixture
def fit():
    slow = Trace("ones", "iteration cap", 3, 1, (0.0, 0.5, 0.9, 1.5), (1.0, 0.5, 0.25, 0.2))
    fast = Trace("slices", "converged", 1, 0, (0.0, 0.25), (0.75, 0.125), compared=0.13)
    records = tuple(
        ChannelRecord(name, 2.0, "slices", 0.125, 0.0625, "converged", (slow, fast))
        for name in ("red", "green", "blue")
    )
    rng = np.random.default_rng(0)
    parameters = {
        "B": rng.random((3, 4, 5)).astype(np.float32),
        "rho_d": rng.random(3).astype(np.float32),
    }
    return Fit("bivariate", parameters, HalfDifference(4, 5, 6), records)


def test_counts(fit):
    assert fit.parameter_count == 3 * 4 * 5 + 3
    assert fit.parameter_bytes == 4 * 63


def test_a_fit_comes_back_from_its_file(tmp_path, fit):
    fits.save(tmp_path / "a.npz", fit)
    back = fits.load(tmp_path / "a.npz")
    assert (back.model, back.grid, back.records) == ("bivariate", HalfDifference(4, 5, 6), ())
    assert back.parameters.keys() == fit.parameters.keys()
    for name, array in fit.parameters.items():
        assert back.parameters[name].dtype == np.float32
        assert (back.parameters[name] == array).all()


def test_the_record_comes_back(tmp_path, fit):
    fits.save(tmp_path / "a.npz", fit)
    record = fits.load_record(tmp_path / "a.npz")
    assert record["channels"] == fit.records
    assert (record["model"], record["parameters"], record["bytes"]) == ("bivariate", 63, 252)
    assert fit.records[0].iterations == 4
    assert fit.records[0].gss_calls == 1


def test_a_fit_file_explains_itself(tmp_path, fit):
    fits.save(tmp_path / "a.npz", fit)
    with np.load(tmp_path / "a.npz", allow_pickle=False) as archive:
        assert str(archive["model"]) == "bivariate"
        assert archive["grid"].tolist() == [4, 5, 6]
        assert "1/sr" in str(archive["units"])
        assert str(archive["format"]) == fits.FORMAT
    assert json.loads((tmp_path / "a.json").read_text())["channels"][2]["channel"] == "blue"


def test_the_same_fit_gives_the_same_bytes(tmp_path, fit):
    fits.save(tmp_path / "a.npz", fit)
    fits.save(tmp_path / "b.npz", fit)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert {member.date_time for member in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_a_record_that_cannot_be_written_leaves_nothing_half_written(tmp_path, fit, monkeypatch):
    def broken(*_, **__):
        raise OSError("disk full")

    monkeypatch.setattr(fits.json, "dumps", broken)
    with pytest.raises(OSError, match="disk full"):
        fits.save(tmp_path / "a.npz", fit)
    assert [path.name for path in tmp_path.iterdir() if path.name != "a.npz"] == []


@pytest.mark.parametrize("name", ["a.fit", "a", "a.json"])
def test_another_suffix_is_refused_in_one_line(tmp_path, fit, name):
    with pytest.raises(NpfmError) as error:
        fits.save(tmp_path / name, fit)
    assert "\n" not in str(error.value)
    assert ".npz" in str(error.value)
    assert list(tmp_path.iterdir()) == []


def damaged(kind, path, fit):
    """Write a file that is not a fit."""
    fits.save(path, fit)
    whole = path.read_bytes()
    match kind:
        case "absent":
            path.unlink()
        case "empty":
            path.write_bytes(b"")
        case "text":
            path.write_text("not a fit\n")
        case "cut off":
            path.write_bytes(whole[: len(whole) // 2])
        case "flipped":
            path.write_bytes(whole[:900] + bytes([whole[900] ^ 1]) + whole[901:])
        case "one array":
            with open(path, "wb") as file:
                np.save(file, np.ones(3))
        case "other archive":
            np.savez(path, D=np.ones(3))
        case "other format":
            np.savez(path, format="npfm-fit-0", model="naive")
        case "folder":
            path.unlink()
            path.mkdir()


@pytest.mark.parametrize(
    "kind",
    [
        "absent",
        "empty",
        "text",
        "cut off",
        "flipped",
        "one array",
        "other archive",
        "other format",
        "folder",
    ],
)
def test_what_is_not_a_fit_is_told_in_one_line(tmp_path, fit, kind):
    path = tmp_path / "a.npz"
    damaged(kind, path, fit)
    with pytest.raises(NpfmError) as error:
        fits.load(path)
    assert "\n" not in str(error.value)
    assert str(path) in str(error.value)


def test_a_missing_record_is_told_in_one_line(tmp_path, fit):
    fits.save(tmp_path / "a.npz", fit)
    (tmp_path / "a.json").unlink()
    with pytest.raises(NpfmError, match=r"a\.json"):
        fits.load_record(tmp_path / "a.npz")
