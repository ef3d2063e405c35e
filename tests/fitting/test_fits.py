"""Fit files: whole, self-explaining, byte for byte the same."""

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting import fits
from npfm.fitting.fits import ChannelRecord, Fit, Trace
from npfm.models import bivariate, low_rank_b, naive
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


def contents(fit, **changes):
    """The arrays of a fit's file, changed; None leaves one out."""
    about = {"format": fits.FORMAT, "model": fit.model, "units": fits.UNITS}
    arrays = about | {"grid": np.array(fit.grid.shape)} | fit.parameters | changes
    return {name: array for name, array in arrays.items() if array is not None}


def ones(*shape, dtype="f4"):
    return np.ones(shape, dtype=dtype)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"units": None}, "a fit without units"),
        ({"model": None, "grid": None}, "a fit without model, grid"),
        ({"units": "BRDF in steradians"}, "the units are 'BRDF in steradians', not"),
        ({"grid": np.array([4, 6])}, "does not have 2 axes"),
        ({"grid": np.array(4)}, "not numbers of bins"),
        ({"grid_kind": "cube"}, "unknown kind of grid 'cube'"),
        ({"grid": np.array([4.0, 5.0, 6.0])}, "not numbers of bins"),
        ({"grid": np.array([4, 0, 6])}, "not numbers of bins"),
        ({"grid": np.array(["a", "b", "c"])}, "not numbers of bins"),
        ({"grid": np.array([2**40, 2**40, 2**40])}, "no table is on a grid of"),
        ({"grid_kind": "directional", "grid": np.array([99, 99, 99, 99])}, "no table is on a grid"),
        ({"grid": np.array([4, 5, 7])}, "no table is on a grid of"),
        ({"B": ones(3, 4, 5, dtype="f8")}, "B is of type float64, not float32"),
        ({"B": np.array(["a", "b", "c"])}, "B is of type <U1"),
        ({"B": ones(2, 4, 5)}, r"B is of shape \(2, 4, 5\), whose first axis is not"),
        ({"B": ones()}, r"B is of shape \(\)"),
        ({"B": ones(3, 0)}, r"B is of shape \(3, 0\)"),
        ({"B": ones(3, 4, 5) * np.float32(np.nan)}, "B holds a NaN or an infinity"),
        ({"B": np.array([None, 1, 2])}, r"B\.npy holds objects or records"),
        ({"B": np.zeros(3, dtype=[("a", "f4")])}, r"B\.npy holds objects or records"),
    ],
)
def test_what_a_fit_lacks_or_has_wrong_is_told_in_one_line(tmp_path, fit, changes, said):
    path = tmp_path / "a.npz"
    np.savez(path, **contents(fit, **changes))
    with pytest.raises(NpfmError, match=rf"a\.npz: .*{said}") as error:
        fits.load(path)
    assert "\n" not in str(error.value)


def test_a_pickle_is_never_run(tmp_path, fit):
    class Trap:
        def __reduce__(self):
            return (Path.touch, (tmp_path / "ran",))

    np.savez(tmp_path / "a.npz", **contents(fit, B=np.array([Trap()], dtype=object)))
    with pytest.raises(NpfmError, match="holds objects"):
        fits.load(tmp_path / "a.npz")
    assert not (tmp_path / "ran").exists()


def test_an_array_that_a_fit_lacks_is_named_when_it_is_asked_for(tmp_path, fit):
    fits.save(tmp_path / "a.npz", fit)
    with pytest.raises(NpfmError, match=r"a\.npz: a fit without the array 'D', it has B, rho_d"):
        fits.load(tmp_path / "a.npz").parameters["D"]


@pytest.mark.parametrize(
    ("model", "changes"),
    [
        (bivariate, {"B": None}),
        (bivariate, {"B": ones(3, 1, 1), "rho_d": None}),
        (bivariate, {"B": ones(3, 4, 5), "rho_d": ones(3)}),
        (bivariate, {"B": ones(1, 60), "rho_d": None}),
        (naive, {"B": None}),
        (low_rank_b, {"B": None}),
        (low_rank_b, {"B": None, "U": ones(3, 4, 2), "V": ones(3, 5, 3), "G": ones(3, 90)}),
    ],
)
def test_arrays_of_another_model_are_told_in_one_line(tmp_path, fit, model, changes):
    path = tmp_path / "a.npz"
    np.savez(path, **contents(fit, **changes))
    with pytest.raises(NpfmError, match=r"a\.npz: its arrays \(.*\) are not those of") as error:
        fits.tabulate(path, fits.load(path), model)
    assert "\n" not in str(error.value)


def test_a_fit_of_its_own_model_is_tabulated(tmp_path, fit):
    path = tmp_path / "a.npz"
    np.savez(path, **contents(fit, rho_d=None))
    loaded = fits.load(path)
    assert np.array_equal(
        fits.tabulate(path, loaded, bivariate).values, bivariate.tabulate(loaded).values
    )


def test_no_more_is_unpacked_than_a_fit_can_have(tmp_path, fit, monkeypatch):
    path = tmp_path / "a.npz"
    np.savez_compressed(path, **contents(fit, B=np.zeros((3, 2**22), "f4")))
    assert path.stat().st_size < 10**5
    with pytest.raises(NpfmError, match=r"a\.npz: .*unpacks to \d+ bytes, 34992000 are the most"):
        fits.load(path)


def test_an_array_is_not_made_as_large_as_its_header_says(tmp_path, fit):
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f4", "fortran_order": False, "shape": (3, 2**40)}
    )
    fits.save(tmp_path / "a.npz", fit)
    with zipfile.ZipFile(tmp_path / "a.npz", "a") as archive:
        archive.writestr("G.npy", header.getvalue() + bytes(64))
    with pytest.raises(NpfmError, match=r"G\.npy has 64 bytes where its header declares 1319"):
        fits.load(tmp_path / "a.npz")


def test_a_fit_cut_off_anywhere_is_told_in_one_line(tmp_path, fit):
    path = tmp_path / "a.npz"
    fits.save(path, fit)
    whole = path.read_bytes()
    for size in range(0, len(whole), 53):
        path.write_bytes(whole[:size])
        with pytest.raises(NpfmError, match=r"a\.npz: ") as error:
            fits.load(path)
        assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"channels": []}', "null", "[" * 100_000, '{"channels": [{"a": 1}]}']
)
def test_what_is_no_record_is_told_in_one_line(tmp_path, fit, text):
    fits.save(tmp_path / "a.npz", fit)
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(NpfmError, match=r"a\.json: cannot be read as the record") as error:
        fits.load_record(tmp_path / "a.npz")
    assert "\n" not in str(error.value)
