"""The MERL format, byte by byte, and what is said about files that are not in it."""

import struct

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance import merl
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.merl import check_header, read_binary, write_binary
from npfm.reflectance.table import Table

PLANE = 90 * 90 * 180


@pytest.fixture(scope="module")
def stored():
    """Stored values of a made-up measurement, shape (3, 90, 90, 180)."""
    values = np.random.default_rng(3).uniform(0, 1000, (3, *MERL.shape))
    values[:, ~MERL.above_horizon] = -1.0
    return values


@pytest.fixture
def hand_made(tmp_path, stored):
    """A file put together without the package."""
    path = tmp_path / "felt.binary"
    path.write_bytes(struct.pack("<3i", 90, 90, 180) + stored.astype("<f8").tobytes())
    return path


def put(path, index, value):
    """Overwrite one stored value."""
    with open(path, "r+b") as file:
        file.seek(12 + 8 * index)
        file.write(struct.pack("<d", value))


def one_line(error):
    message = str(error.value)
    assert "\n" not in message
    return message


def test_the_size_is_merls():
    assert merl.FILE_BYTES == 34_992_012


def test_reads_a_hand_made_file(hand_made, stored):
    table = read_binary(hand_made)
    for channel, scale in enumerate((1.00 / 1500, 1.15 / 1500, 1.66 / 1500)):
        np.testing.assert_allclose(
            table.values[channel, MERL.above_horizon],
            stored[channel, MERL.above_horizon] * scale,
            rtol=1e-15,
        )
    assert (table.valid == MERL.above_horizon).all()


def test_entries_are_ordered_theta_h_theta_d_phi_d(hand_made):
    put(hand_made, 2 * PLANE + (12 * 90 + 34) * 180 + 56, 1500.0)
    assert read_binary(hand_made).values[2, 12, 34, 56] == pytest.approx(1.66, rel=1e-15)


def test_writes_the_same_bytes_as_by_hand(tmp_path, hand_made, stored):
    scale = np.array([1.00, 1.15, 1.66])[:, None, None, None] / 1500
    exact = np.where(stored < 0, stored, np.round(stored))
    by_hand = struct.pack("<3i", 90, 90, 180) + exact.astype("<f8").tobytes()
    write_binary(tmp_path / "out.binary", Table(np.where(exact < 0, exact, exact * scale)))
    written = (tmp_path / "out.binary").read_bytes()
    assert len(written) == 34_992_012
    assert written[:12] == by_hand[:12]
    values = np.frombuffer(written, "<f8", offset=12)
    np.testing.assert_allclose(values, exact.ravel(), rtol=3e-16)
    assert (np.frombuffer(by_hand, "<f8", offset=12)[values < 0] == values[values < 0]).all()


def test_a_table_comes_back_from_its_file(tmp_path, hand_made):
    table = read_binary(hand_made)
    write_binary(tmp_path / "again.binary", table)
    again = read_binary(tmp_path / "again.binary")
    assert (again.valid == table.valid).all()
    np.testing.assert_allclose(again.values[table.valid], table.values[table.valid], rtol=3e-16)


def test_zero_is_a_measurement_and_minus_one_is_not():
    values = np.array([0.0, 1.0, -1.0, -1e-9]).reshape(1, 1, 2, 2) * np.ones((3, 1, 1, 1))
    assert Table(values, HalfDifference(1, 2, 2)).valid[0].ravel().tolist() == [
        True,
        True,
        False,
        False,
    ]


def test_absent(tmp_path):
    with pytest.raises(NpfmError) as error:
        read_binary(tmp_path / "none.binary")
    assert "none.binary: no such file" in one_line(error)


@pytest.mark.parametrize("size", [5, 12, 34_992_011, 34_992_013])
def test_wrong_size(tmp_path, size):
    path = tmp_path / "cut.binary"
    with open(path, "wb") as file:
        file.write(struct.pack("<3i", 90, 90, 180)[:size])
        file.truncate(size)
    for check in (read_binary, check_header):
        with pytest.raises(NpfmError) as error:
            check(path)
        assert f"cut.binary: {size} bytes" in one_line(error)
        assert "again" in one_line(error)


def of_size(path, head, size):
    """A sparse file that begins with some bytes."""
    with open(path, "wb") as file:
        file.write(head)
        file.truncate(size)
    return path


HEADER = struct.pack("<3i", 90, 90, 180)


@pytest.mark.parametrize(
    ("head", "size", "said"),
    [
        (b"", 0, "is an empty file, not a MERL .binary file; copy or download it again"),
        (b"\xef\xbb\xbf \n<!DOCTYPE HTML>", 60, "looks like an HTML page"),
        (b"version https://git-lfs.example/spec/v1", 130, "a git-lfs pointer.*git lfs pull"),
        (b"\x1f\x8b\x08", 20_000_000, "looks like a gzip archive.*decompress it"),
        (b"PK\x03\x04", 20_000_000, "looks like a zip archive.*unpack it"),
        (b"tensor_file\0\x01", 658_960, r"a tensor file of the RGL database \(\.bsdf\)"),
        (b"\x89HDF\r\n\x1a\n", 20_000, "looks like an HDF5 file"),
        (b"\x93NUMPY\x01", merl.FILE_BYTES, r"a single NumPy array \(\.npy\)"),
        (struct.pack(">3i", 90, 90, 180), merl.FILE_BYTES, r"other byte order.*swap the bytes"),
        (struct.pack("<3i", 90, 90, 360), 2 * merl.FILE_BYTES - 12, "90 x 90 x 360: phi_d over"),
        (struct.pack("<3i", 45, 45, 90), merl.FILE_BYTES // 8, "the header says 45 x 45 x 90"),
        (struct.pack("<3i", -1, 2**31 - 1, 0), merl.FILE_BYTES, "the header says -1 x 2147483647"),
        (HEADER, 12 + 8 * PLANE, "one channel; write it three times"),
        (HEADER, 12 + 4 * PLANE, "one channel of float32 values"),
        (HEADER, 12 + 12 * PLANE, "float32 values; write them as float64"),
        (HEADER, 12 + 32 * PLANE, "four channels"),
        (HEADER, 12 + 25 * PLANE, "the file has bytes after its end"),
        (HEADER, 13 + 12 * PLANE, "the file is cut off or damaged"),
        (struct.pack("<d", 0.5), 24 * PLANE, "without MERL's header.*put the int32 90, 90, 180"),
        (struct.pack("<d", 0.5), 1_990_656, "of the UTIA database; let its name end in .bin"),
    ],
)
def test_what_is_no_merl_file_is_told_what_it_looks_like(tmp_path, head, size, said):
    path = of_size(tmp_path / "odd.binary", head, size)
    for check in (read_binary, check_header):
        with pytest.raises(NpfmError, match=rf"odd\.binary: .*{said}") as error:
            check(path)
        one_line(error)


def test_the_other_byte_order_can_be_mended_as_the_message_says(tmp_path, hand_made):
    content = hand_made.read_bytes()
    swapped = np.frombuffer(content, "<i4", 3).astype(">i4").tobytes()
    swapped += np.frombuffer(content, "<f8", offset=12).astype(">f8").tobytes()
    (tmp_path / "big.binary").write_bytes(swapped)
    with pytest.raises(NpfmError, match="big-endian"):
        read_binary(tmp_path / "big.binary")
    numbers = np.frombuffer(swapped, ">i4", 3).astype("<i4").tobytes()
    values = np.frombuffer(swapped, ">f8", offset=12).astype("<f8").tobytes()
    assert numbers + values == content


def test_a_folder_is_not_taken_for_a_file(tmp_path):
    with pytest.raises(NpfmError, match=r"is a folder, not a MERL \.binary file") as error:
        read_binary(tmp_path)
    one_line(error)


@pytest.mark.parametrize(
    "values",
    [[np.nan], [np.inf], [-np.inf], [np.nan, np.inf, -np.inf], [np.inf, -np.inf]],
    ids=str,
)
def test_not_finite(hand_made, values):
    for k, value in enumerate(values):
        put(hand_made, 1000 + k, value)
    with pytest.raises(NpfmError) as error:
        read_binary(hand_made)
    assert f"felt.binary: {len(values)} entries are NaN or infinite" in one_line(error)


def test_huge_but_finite_values_are_read(hand_made):
    put(hand_made, 0, 1.7e308)
    put(hand_made, 1, 1.7e308)
    assert np.isfinite(read_binary(hand_made).values[0]).all()


@pytest.mark.parametrize(("channel", "name"), [(0, "red"), (1, "green"), (2, "blue")])
def test_a_channel_without_a_valid_sample(hand_made, channel, name):
    with open(hand_made, "r+b") as file:
        file.seek(12 + 8 * PLANE * channel)
        file.write(np.full(PLANE, -1.0).tobytes())
    with pytest.raises(NpfmError) as error:
        read_binary(hand_made)
    assert f"felt.binary: the {name} channel" in one_line(error)


def test_another_grid_cannot_be_written(tmp_path):
    table = Table(np.ones((3, 4, 4, 8)), HalfDifference(4, 4, 8))
    with pytest.raises(NpfmError) as error:
        write_binary(tmp_path / "small.binary", table)
    assert "half-difference 4x4x8" in one_line(error)
    assert list(tmp_path.iterdir()) == []


def test_a_write_that_fails_midway_leaves_the_old_file(tmp_path, hand_made, monkeypatch):
    before = hand_made.read_bytes()
    monkeypatch.setattr(merl, "CHANNEL_SCALE", np.ones(2))  # breaks after the header is out
    with pytest.raises(ValueError, match="broadcast"):
        write_binary(hand_made, Table(np.ones((3, *MERL.shape))))
    assert hand_made.read_bytes() == before
    assert list(tmp_path.iterdir()) == [hand_made]
