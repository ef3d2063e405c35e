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
    with pytest.raises(NpfmError, match=r"page\.zip: cannot be read as a zip"):
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
        (keras_file(neural.LAYERS | {"dense_1": (9, 21)}), "the layers are 9x21, 21x21, 21x3"),
    ],
)
def test_other_layers_than_the_published_are_refused(tmp_path, content, reason):
    path = zip_of(tmp_path / "networks.zip", {"a/odd.h5": content})
    with pytest.raises(NpfmError, match=rf"networks\.zip: a/odd\.h5: {reason}") as caught:
        neural.load(path, "odd")
    assert "\n" not in str(caught.value)
