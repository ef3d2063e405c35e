import io
import json
import zipfile

import h5py
import numpy as np
import pytest

from npfm.datasets import neural
from npfm.datasets.names import MERL_NAMES
from npfm.errors import NpfmError
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import INVALID


@pytest.fixture
def archive(data):
    return data / "merl_nbrdf.zip"


def keras_file(shapes, seed=0):
    """A network of random weights in the layout of the published files."""
    rng = np.random.default_rng(seed)
    content = io.BytesIO()
    with h5py.File(content, "w") as file:
        for layer, shape in shapes.items():
            file[f"{layer}/{layer}/kernel:0"] = rng.normal(0, 0.5, shape).astype("f4")
            file[f"{layer}/{layer}/bias:0"] = rng.normal(0, 0.5, shape[1]).astype("f4")
    return content.getvalue()


def zip_of(path, members):
    with zipfile.ZipFile(path, "w") as file:
        for name, content in members.items():
            file.writestr(name, content)
    return path


def by_the_book(content, theta_h, theta_d, phi_d):
    """The network for one sample, step by step in the words of its description."""
    x = np.array(
        [
            np.sin(theta_h),
            0,
            np.cos(theta_h),
            np.sin(theta_d) * np.cos(phi_d),
            np.sin(theta_d) * np.sin(phi_d),
            np.cos(theta_d),
        ]
    )
    with h5py.File(io.BytesIO(content)) as file:
        for layer in ("dense_1", "dense_2", "dense_3"):
            weights = file[layer][layer]
            x = np.float64(weights["kernel:0"][()]).T @ x + weights["bias:0"][()]
            if layer != "dense_3":
                x[x < 0] = 0
    return np.exp(x) - 1


def assert_is_the_network(table, content, seed):
    rng = np.random.default_rng(seed)
    above = np.argwhere(MERL.above_horizon)
    for h, d, p in rng.choice(above, 300, replace=False):
        expected = by_the_book(content, MERL.theta_h[h], MERL.theta_d[d], MERL.phi_d[p])
        found = table.values[:, h, d, p]
        np.testing.assert_allclose(found, np.maximum(expected, 0), rtol=1e-9, atol=1e-12)


def test_a_table_is_the_network_at_the_cell_centres(tmp_path):
    content = keras_file(neural.LAYERS)
    archive = zip_of(tmp_path / "networks.zip", {"folder/made-up.h5": content})
    table = neural.load(archive, "made-up")
    assert_is_the_network(table, content, seed=1)
    assert np.array_equal(table.values == INVALID, [~MERL.above_horizon] * 3)
    # Random weights give negative values too, which would read as "not measured".
    assert (table.values == 0).any()
    assert table.values[:, MERL.above_horizon].min() == 0


def test_the_published_archive_holds_the_merl_materials(archive):
    assert neural.materials(archive) == list(MERL_NAMES)


@pytest.mark.parametrize("name", ["chrome", "black-obsidian"])
def test_a_published_network_is_evaluated_as_described(archive, name):
    with zipfile.ZipFile(archive) as opened:
        content = opened.read(f"merl_nbrdf/{name}.h5")
        layers = json.loads(opened.read(f"merl_nbrdf/{name}.json"))["config"]["layers"]
    assert [layer["config"].get("activation") for layer in layers[:3]] == ["relu", "relu", "linear"]
    table = neural.load(archive, name)
    assert table.values.dtype == np.float64
    assert_is_the_network(table, content, seed=2)
    assert np.array_equal(table.valid, [MERL.above_horizon] * 3)


def test_a_misspelt_material_is_answered_with_the_nearest(archive):
    with pytest.raises(NpfmError, match=r"merl_nbrdf\.zip.*'crome'; did you mean chrome"):
        neural.load(archive, "crome")


def test_an_absent_archive_is_named(tmp_path):
    with pytest.raises(NpfmError, match=r"absent\.zip: no such file"):
        neural.materials(tmp_path / "absent.zip")


def test_a_file_that_is_no_zip_is_named(tmp_path):
    path = tmp_path / "page.zip"
    path.write_text("<html>not found</html>")
    with pytest.raises(NpfmError, match=r"page\.zip: looks like an HTML page, not the zip"):
        neural.materials(path)


def test_a_zip_without_networks_is_named(tmp_path):
    path = zip_of(tmp_path / "other.zip", {"readme.txt": "hello"})
    with pytest.raises(NpfmError, match=r"other\.zip: holds no network"):
        neural.materials(path)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"no hdf5", "not a Keras file"),
        (keras_file({"dense_1": (6, 21), "dense_2": (21, 3)}), "not a Keras file"),
        (keras_file(neural.LAYERS | {"dense_1": (9, 21)}), r".*the kernel of dense_1 is \(9, 21\)"),
    ],
)
def test_other_layers_than_the_published_are_refused(tmp_path, content, reason):
    path = zip_of(tmp_path / "networks.zip", {"a/odd.h5": content})
    with pytest.raises(NpfmError, match=rf"networks\.zip: a/odd\.h5: {reason}") as caught:
        neural.load(path, "odd")
    assert "\n" not in str(caught.value)


def test_a_network_needs_no_json_and_no_neat_archive(tmp_path):
    """A zip made by hand: folders, what macOS adds, other cases, and backslashes of Windows."""
    content = keras_file(neural.LAYERS)
    members = {
        "a/": b"",
        "a.h5/": b"",
        "__MACOSX/a/._felt.h5": b"x",
        "a/Felt.H5": content,
        "a\\silk.h5": content,
    }
    path = zip_of(tmp_path / "own.zip", members)
    assert neural.materials(path) == ["Felt", "silk"]
    assert np.array_equal(neural.load(path, "silk").values, neural.load(path, "Felt").values)


def test_two_networks_of_one_name_are_not_silently_one(tmp_path):
    path = zip_of(tmp_path / "two.zip", {"a/felt.h5": b"1", "b/felt.h5": b"2"})
    with pytest.raises(NpfmError, match=r"two networks of a material 'felt', a/felt\.h5 and b/"):
        neural.materials(path)


def damaged(content):
    """The network's bytes with those of the data in its middle overwritten."""
    return content[:900] + bytes(1000) + content[1900:]


def with_layer(name, value):
    content = io.BytesIO(keras_file(neural.LAYERS))
    with h5py.File(content, "r+") as file:
        del file[name]
        if value is not None:
            file[name] = value
    return content.getvalue()


KERNEL = "dense_2/dense_2/kernel:0"


@pytest.mark.parametrize(
    "content",
    [
        b"",
        keras_file(neural.LAYERS)[:5000],
        damaged(keras_file(neural.LAYERS)),
        with_layer(KERNEL, None),
        with_layer(KERNEL, np.full((21, 21), np.nan)),
        with_layer(KERNEL, np.ones((21, 21), dtype=int)),
        with_layer(KERNEL, np.full((21, 21), b"x")),
        with_layer("dense_2", 1.0),
        with_layer("dense_3/dense_3/bias:0", np.ones(4)),
    ],
    ids=["empty", "cut", "damaged", "absent", "nan", "int", "text", "no group", "bias"],
)
def test_a_damaged_network_is_told_in_one_line(tmp_path, content):
    path = zip_of(tmp_path / "networks.zip", {"a/odd.h5": content, "a/odd.json": "{}"})
    with pytest.raises(NpfmError, match=r"networks\.zip: a/odd\.h5: not a Keras file") as caught:
        neural.load(path, "odd")
    assert "\n" not in str(caught.value)


def test_reflectances_without_end_are_refused(tmp_path):
    content = with_layer("dense_3/dense_3/bias:0", np.full(3, 1e30))
    path = zip_of(tmp_path / "networks.zip", {"a/odd.h5": content})
    with pytest.raises(NpfmError, match=r"odd\.h5: it gives reflectances that are not finite"):
        neural.load(path, "odd")


def test_a_member_is_not_unpacked_beyond_what_a_network_needs(tmp_path):
    path = tmp_path / "bomb.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("a/bomb.h5", bytes(2**26))
    assert path.stat().st_size < 2**17
    with pytest.raises(NpfmError, match=r"a/bomb\.h5 unpacks to 67108864 bytes"):
        neural.load(path, "bomb")


def test_a_dataset_is_not_read_beyond_what_a_network_needs(tmp_path, monkeypatch):
    content = io.BytesIO(keras_file(neural.LAYERS))
    with h5py.File(content, "r+") as file:
        del file[KERNEL]
        # A terabyte on paper, nothing on disk.
        file.create_dataset(KERNEL, (2**19, 2**19), "f4", chunks=(64, 64))
    path = zip_of(tmp_path / "networks.zip", {"a/odd.h5": content.getvalue()})
    with pytest.raises(NpfmError, match=r"the kernel of dense_2 is \(524288, 524288\)"):
        neural.load(path, "odd")


def test_a_damaged_or_encrypted_member_is_told(tmp_path):
    content = keras_file(neural.LAYERS)
    path = zip_of(tmp_path / "networks.zip", {"a/odd.h5": content})
    whole = path.read_bytes()
    begin = whole.index(content)
    path.write_bytes(whole[: begin + 50] + b"damage" + whole[begin + 56 :])
    with pytest.raises(NpfmError, match=r"a/odd\.h5 is damaged or encrypted: Bad CRC-32"):
        neural.load(path, "odd")
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(NpfmError, match=r"networks\.zip: cannot be read as the zip of the neural"):
        neural.load(path, "odd")
    encrypted = bytearray(whole)
    encrypted[6] |= 1
    encrypted[whole.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(encrypted)
    with pytest.raises(NpfmError, match=r"a/odd\.h5 is damaged or encrypted: .*encrypted"):
        neural.load(path, "odd")


def test_deflated_bytes_that_are_damaged_are_told(tmp_path):
    path = tmp_path / "networks.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("odd.h5", keras_file(neural.LAYERS))
    whole = path.read_bytes()
    path.write_bytes(whole[:100] + b"\xff" * 40 + whole[140:])
    with pytest.raises(NpfmError, match=r"odd\.h5 is damaged or encrypted"):
        neural.load(path, "odd")
