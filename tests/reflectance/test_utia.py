"""The UTIA format, byte by byte, and what is said about files that are not in it."""

import struct

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance import merl, utia
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.reflectance.utia import check_bin, read_bin, write_bin
from npfm.storage.files import check_replaceable

PLANE = 288 * 288


@pytest.fixture(scope="module")
def stored():
    """Values of a made-up measurement as they lie in a file."""
    values = np.random.default_rng(3).uniform(0, 10, 3 * PLANE)
    values[::97] = -0.25
    return values


@pytest.fixture
def hand_made(tmp_path, stored):
    path = tmp_path / "satin.bin"
    path.write_bytes(struct.pack(f"<{3 * PLANE}d", *stored))
    return path


def independent(path, theta_i, phi_i, theta_o, phi_o):
    """RGB by seeking in the file: sixteen values, negative ones 0, and the sum not below 0.

    Angles in degrees, azimuths in [0, 360).
    """
    total = [0.0, 0.0, 0.0]
    with open(path, "rb") as file:
        for corner in range(16):
            weight, place = 1.0, []
            for bit, (angle, step, last) in enumerate(
                ((theta_i, 15, 4), (phi_i, 7.5, 47), (theta_o, 15, 4), (phi_o, 7.5, 47))
            ):
                low = min(int(angle // step), last)
                up = corner >> bit & 1
                weight *= angle / step - low if up else 1 - (angle / step - low)
                place.append(low + up)
            row = 48 * place[0] + place[1] % 48
            column = 48 * place[2] + place[3] % 48
            for plane in range(3):
                file.seek(8 * (plane * 288**2 + 288 * row + column))
                total[plane] += weight * max(struct.unpack("<d", file.read(8))[0], 0.0)
    return [max(value, 0.0) for value in total]


def put(path, index, value):
    with open(path, "r+b") as file:
        file.seek(8 * index)
        file.write(struct.pack("<d", value))


def one_line(error):
    message = str(error.value)
    assert "\n" not in message
    return message


def test_the_size_is_utias():
    assert utia.FILE_BYTES == 1_990_656


def test_reads_a_hand_made_file(hand_made, stored):
    table = read_bin(hand_made)
    assert table.grid == UTIA
    np.testing.assert_array_equal(table.values.ravel(), stored)
    assert table.valid.sum() == (stored >= 0).sum()


def test_entries_are_ordered_theta_i_phi_i_theta_o_phi_o(hand_made):
    put(hand_made, 2 * PLANE + 288 * (48 * 4 + 33) + 48 * 2 + 21, 123.0)
    assert read_bin(hand_made).values[2, 4, 33, 2, 21] == 123.0


def test_writes_the_bytes_that_it_read(tmp_path, hand_made):
    write_bin(tmp_path / "again.bin", read_bin(hand_made))
    assert (tmp_path / "again.bin").read_bytes() == hand_made.read_bytes()


def test_an_independent_reader_finds_the_same_at_random_directions(tmp_path):
    rng = np.random.default_rng(8)
    table = Table(rng.random((3, *UTIA.shape)) - 0.05, UTIA)
    write_bin(tmp_path / "noise.bin", table)
    theta = rng.uniform(0, 90, (2, 300))
    phi = rng.uniform(0, 360, (2, 300))
    vectors = [
        np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)
        for t, p in zip(np.radians(theta), np.radians(phi), strict=True)
    ]
    there = zip(theta[0], phi[0], theta[1], phi[1], strict=True)
    expected = np.transpose([independent(tmp_path / "noise.bin", *angles) for angles in there])
    np.testing.assert_allclose(table.lookup(*vectors), expected, atol=1e-11)


@pytest.mark.parametrize("shape", [(12, 96, 12, 96), (9, 36, 6, 24), (6, 48, 6, 47), (1, 1, 1, 1)])
def test_other_resolutions_come_back_with_their_header(tmp_path, shape):
    grid = Directional(*shape)
    values = np.broadcast_to(np.arange(float(grid.size)).reshape(shape), (3, *shape))
    write_bin(tmp_path / "fine.bin", Table(values, grid))
    content = (tmp_path / "fine.bin").read_bytes()
    assert struct.unpack("<4i", content[:16]) == shape
    assert len(content) == 16 + 24 * grid.size
    again = read_bin(tmp_path / "fine.bin")
    assert again.grid == grid
    np.testing.assert_array_equal(again.values, values)


def test_absent(tmp_path):
    with pytest.raises(NpfmError) as error:
        read_bin(tmp_path / "none.bin")
    assert "none.bin: no such file" in one_line(error)


HEADER = struct.pack("<4i", 12, 96, 12, 96)


@pytest.mark.parametrize(
    ("head", "size", "said"),
    [
        (b"", 0, "is an empty file, not a UTIA .bin file; copy or download it again"),
        (b"<!DOCTYPE HTML>", 60, "looks like an HTML page"),
        (b"version https://git-lfs.example/spec/v1", 130, "a git-lfs pointer.*git lfs pull"),
        (b"PK\x03\x04", utia.FILE_BYTES, "looks like a zip archive.*unpack it"),
        (b"tensor_file\0\x01", 658_960, r"a tensor file of the RGL database \(\.bsdf\)"),
        (b"v/1\x01", utia.FILE_BYTES, "looks like an OpenEXR picture"),
        (b"\x93NUMPY\x01", utia.FILE_BYTES + 128, r"a single NumPy array \(\.npy\)"),
        (b"\x89PNG", 3000, "looks like a PNG picture"),
        (struct.pack("<3i", 90, 90, 180), merl.FILE_BYTES, "a MERL file; let its name end in .bin"),
        (b"\0", 4 * 3 * PLANE, "float32 values; write them as float64"),
        (b"\0", 8 * PLANE, "one channel; write it three times"),
        (b"\0", 4 * PLANE, "one channel of float32 values"),
        (b"\0", 8 * 4 * PLANE, "four channels"),
        (b"\0", 5, "5 bytes, a UTIA file has 1990656, .*cut off or damaged"),
        (b"\0", utia.FILE_BYTES - 1, "cut off or damaged"),
        (b"\0", utia.FILE_BYTES + 8, "has bytes after its end"),
        (HEADER, 16 + 24 * (12 * 96) ** 2 - 8, "no header declares this size"),
        (struct.pack("<4i", -12, -96, 12, 96), 16 + 24 * (12 * 96) ** 2, "no header declares"),
        (struct.pack("<4i", 2**31 - 1, 2**31 - 1, 2**31 - 1, 9), 4000, "no header declares"),
        (struct.pack("<4i", 0, 0, 0, 0), 16, "no header declares"),
    ],
)
def test_what_is_no_utia_file_is_told_what_it_looks_like(tmp_path, head, size, said):
    path = tmp_path / "odd.bin"
    with open(path, "wb") as file:
        file.write(head)
        file.truncate(size)
    for check in (read_bin, check_bin):
        with pytest.raises(NpfmError, match=rf"odd\.bin: .*{said}") as error:
            check(path)
        one_line(error)


def test_the_other_byte_order_is_told(tmp_path, stored):
    (tmp_path / "big.bin").write_bytes(stored.astype(">f8").tobytes())
    with pytest.raises(NpfmError, match="big-endian"):
        read_bin(tmp_path / "big.bin")


def test_a_folder_is_not_taken_for_a_file(tmp_path):
    with pytest.raises(NpfmError, match=r"is a folder, not a UTIA \.bin file"):
        read_bin(tmp_path)


@pytest.mark.parametrize("values", [[np.nan], [np.inf], [np.nan, np.inf, -np.inf]], ids=str)
def test_not_finite(hand_made, values):
    for k, value in enumerate(values):
        put(hand_made, 1000 + k, value)
    with pytest.raises(NpfmError) as error:
        read_bin(hand_made)
    assert f"satin.bin: {len(values)} entries are NaN or infinite" in one_line(error)


def test_huge_and_tiny_values_are_read(hand_made):
    put(hand_made, 0, 1.7e308)
    put(hand_made, 1, 5e-324)
    assert np.isfinite(read_bin(hand_made).values).all()


@pytest.mark.parametrize(("channel", "name"), [(0, "red"), (1, "green"), (2, "blue")])
def test_a_channel_without_a_valid_sample(hand_made, channel, name):
    with open(hand_made, "r+b") as file:
        file.seek(8 * PLANE * channel)
        file.write(np.full(PLANE, -1.0).tobytes())
    with pytest.raises(NpfmError) as error:
        read_bin(hand_made)
    assert f"satin.bin: the {name} channel" in one_line(error)


def test_another_kind_of_grid_cannot_be_written(tmp_path):
    table = Table(np.ones((3, 4, 4, 8)), HalfDifference(4, 4, 8))
    with pytest.raises(NpfmError, match="half-difference 4x4x8"):
        write_bin(tmp_path / "small.bin", table)
    assert list(tmp_path.iterdir()) == []


def test_only_tables_are_replaced(tmp_path, hand_made):
    check_replaceable(hand_made, utia.BIN)
    (tmp_path / "firmware.bin").write_bytes(b"\x7fELF" + bytes(100))
    with pytest.raises(NpfmError, match="a file is there that is not a table of the UTIA format"):
        check_replaceable(tmp_path / "firmware.bin", utia.BIN)
