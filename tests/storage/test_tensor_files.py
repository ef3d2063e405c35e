"""The container of the RGL database: what is in it, and what is not believed."""

import struct

import numpy as np
import pytest
from bsdf import tensor_file

from npfm.errors import NpfmError
from npfm.storage import tensor_files
from npfm.storage.files import Kind, marked
from npfm.storage.tensor_files import read_arrays, read_header, write_arrays

ARRAYS = {
    "one": np.arange(6, dtype="<f4").reshape(1, 2, 3),
    "words": np.array([3, 1], "<u4"),
    "flag": np.array([1], "u1"),
}


@pytest.fixture
def path(tmp_path):
    path = tmp_path / "a.bsdf"
    path.write_bytes(tensor_file(ARRAYS))
    return path


def test_arrays_come_back(path):
    fields = read_header(path, "a file")
    assert list(fields) == list(ARRAYS)
    for name, array in read_arrays(path, fields, ARRAYS).items():
        np.testing.assert_array_equal(array, ARRAYS[name])
        assert array.dtype == ARRAYS[name].dtype


def test_mitsuba_reads_the_same(path):
    """So the tests' own writer is right, and with it the reader."""
    mitsuba = pytest.importorskip("mitsuba", reason="needs pip install npfm[mitsuba]")
    mitsuba.set_variant("scalar_rgb")
    told = str(mitsuba.TensorFile(str(path)))
    for name, field in read_header(path, "a file").items():
        at = told.index(f'"{name}"')
        assert f"offset = {field.offset}," in told[at:]
        assert f"shape = {list(field.shape)}" in told[at:]


def one_line(path):
    with pytest.raises(NpfmError) as error:
        read_header(path, "a .bsdf file")
    assert "\n" not in str(error.value)
    assert path.name in str(error.value)
    return str(error.value)


def test_no_file(tmp_path):
    assert "no such file" in one_line(tmp_path / "none.bsdf")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is an empty file, not a .bsdf file"),
        (b"<html>", "looks like an HTML page"),
        (b"PK\x03\x04", "looks like a zip archive"),
        (b"version https://git-lfs.example/spec/v1", "git lfs pull"),
        (b"tensor_fil", "does not begin as one|ends within its header"),
        (b"tensor_file\0\1\0", "ends within its header"),
        (b"tensor_file\0\2\0\0\0\0\0", "does not begin as one of version 1.0"),
        (b"tensor_file\0\1\0\xff\xff\xff\xff", "declares 4294967295 fields"),
        (b"tensor_file\0\1\0\1\0\0\0\xff\xff", "ends within its header"),
    ],
)
def test_what_is_no_tensor_file(tmp_path, content, said):
    path = tmp_path / "odd.bsdf"
    path.write_bytes(content)
    assert any(part in one_line(path) for part in said.split("|"))


def declared(name=b"one", axes=1, code=10, offset=0, shape=(1,), times=1):
    field = struct.pack(f"<H{len(name)}sHBQ", len(name), name, axes, code, offset)
    field += struct.pack(f"<{len(shape)}Q", *shape)
    return struct.pack("<12sBBI", b"tensor_file", 1, 0, times) + times * field


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (declared(axes=60000), "'one' has 60000 axes"),
        (declared(axes=9, shape=9 * (1,)), "'one' has 9 axes"),
        (declared(code=0), "'one' is of the unknown type 0"),
        (declared(code=12), "'one' is of the unknown type 12"),
        (declared(shape=(2**40,)), "'one' goes on beyond the end"),
        (declared(axes=2, shape=(2**63, 2**63)), "'one' goes on beyond the end"),
        (declared(offset=2**64 - 1), "'one' goes on beyond the end"),
        (declared(offset=50), "'one' goes on beyond the end"),
        (declared(times=2), "two fields 'one'"),
        (declared(name=b"\xff\n\x1b"), None),
    ],
)
def test_what_a_header_declares_is_not_believed(tmp_path, content, said):
    path = tmp_path / "odd.bsdf"
    path.write_bytes(content)
    if said is None:  # no name of ours, but nothing that is wrong
        assert list(read_header(path, "a file")) == [r"\xff" + "\n\x1b"]
    else:
        assert said in one_line(path)


def test_every_end_but_the_last_is_refused(path):
    whole = path.read_bytes()
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        one_line(path)


def test_a_file_that_is_too_large_is_not_read(path, monkeypatch):
    monkeypatch.setattr(tensor_files, "MOST_BYTES", 10)
    assert "10 are the most that a .bsdf file has" in one_line(path)


def test_what_is_written_is_read_again(tmp_path):
    kind = Kind("numbers", ".bsdf", marked(b"tensor_file"))
    arrays = {
        "one": np.arange(3, dtype=np.uint8),
        "two-three": np.arange(6, dtype=np.float32).reshape(2, 3)[:, ::-1],
        "ü": np.float64([[[1.5]]]),
    }
    write_arrays(tmp_path / "a.bsdf", kind, arrays)
    fields = read_header(tmp_path / "a.bsdf", "numbers")
    assert all(field.offset % 8 == 0 for field in fields.values())
    names = dict(zip(fields, arrays, strict=True))
    for name, array in read_arrays(tmp_path / "a.bsdf", fields, fields).items():
        assert array.dtype == arrays[names[name]].dtype
        np.testing.assert_array_equal(array, arrays[names[name]])
