"""The factors of the paper's authors: what their file says."""

import numpy as np
import pytest

from npfm.datasets.published_factors import read
from npfm.errors import NpfmError


def arrays(**changes):
    shapes = dict.fromkeys("DGF", (1, 90, 3)) | dict.fromkeys(["rho_d", "rho_s"], (1, 3))
    return {"names": ["a"], **{name: np.ones(shape) for name, shape in shapes.items()}} | changes


def test_coefficients_are_those_of_the_brdf(tmp_path):
    np.savez(tmp_path / "x.npz", **arrays(rho_s=[[1.0, 2.0, 3.0]]))
    factors = read(tmp_path / "x.npz")["a"]
    np.testing.assert_allclose(factors["rho_s"], np.array([1, 2, 3]) / np.pi)
    np.testing.assert_allclose(factors["rho_d"], 1 / np.pi)


def test_the_authors_factors_have_maximum_1_and_hide_what_no_sample_touched(data):
    published = read(data / "npf_reference.npz")
    assert len(published) == 10 and "chrome" in published
    for factors in published.values():
        assert all(factors[name].shape == (3, 90) for name in "DGF")
        np.testing.assert_allclose(factors["D"].max(axis=1), 1, rtol=1e-6)
        assert np.isnan(factors["G"][:, 0]).all() and np.isfinite(factors["G"][:, 1:]).all()
        assert np.isnan(factors["F"][:, 0]).all() and np.isfinite(factors["F"][:, 1:]).all()


@pytest.mark.parametrize("missing", ["names", "D", "rho_s"])
def test_a_file_that_lacks_something_is_told(tmp_path, missing):
    np.savez(tmp_path / "x.npz", **{k: v for k, v in arrays().items() if k != missing})
    with pytest.raises(NpfmError, match=rf"x\.npz: lacks {missing}"):
        read(tmp_path / "x.npz")


def test_another_shape_is_told(tmp_path):
    np.savez(tmp_path / "x.npz", **arrays(G=np.ones((1, 80, 3))))
    with pytest.raises(NpfmError, match=r"G is of shape \(1, 80, 3\)"):
        read(tmp_path / "x.npz")


def test_an_absent_file_is_told(tmp_path):
    with pytest.raises(NpfmError, match=r"none\.npz: no such file"):
        read(tmp_path / "none.npz")


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"D": np.full((1, 90, 3), np.nan)}, "D holds a NaN"),
        ({"D": np.full((1, 90, 3), -1.0)}, "D holds a NaN, an infinity or a negative value"),
        ({"rho_d": np.full((1, 3), np.inf)}, "rho_d holds a NaN, an infinity"),
        ({"F": np.full((1, 90, 3), "a")}, "F does not hold numbers"),
        ({"F": np.full((1, 90, 3), 1j)}, "F does not hold numbers"),
        ({"names": [1]}, "names is not a list of different texts"),
        ({"names": [["a"]]}, "names is not a list of different texts"),
        ({"names": ["a", "a"]}, "names is not a list of different texts"),
        ({"names": ["a", "b"]}, r"D is of shape \(1, 90, 3\), not \(2, 90, 3\)"),
        ({"names": np.array(["a"], dtype=object)}, r"names\.npy holds objects or records"),
    ],
)
def test_other_contents_are_told_in_one_line(tmp_path, changes, said):
    np.savez(tmp_path / "x.npz", **arrays(**changes))
    with pytest.raises(NpfmError, match=rf"x\.npz: .*{said}") as caught:
        read(tmp_path / "x.npz")
    assert "\n" not in str(caught.value)


def test_what_no_sample_touched_may_be_nan_in_the_file(tmp_path):
    G = np.ones((1, 90, 3))
    G[:, 0] = np.nan
    np.savez(tmp_path / "x.npz", **arrays(G=G))
    assert np.isfinite(read(tmp_path / "x.npz")["a"]["G"][:, 1:]).all()


def test_a_file_cut_off_anywhere_is_told_in_one_line(tmp_path):
    path = tmp_path / "x.npz"
    np.savez(path, **arrays())
    whole = path.read_bytes()
    for size in range(0, len(whole), 97):
        path.write_bytes(whole[:size])
        with pytest.raises(NpfmError, match=r"x\.npz: ") as caught:
            read(path)
        assert "\n" not in str(caught.value)


def test_a_single_array_is_told(tmp_path):
    with open(tmp_path / "x.npz", "wb") as file:
        np.save(file, np.ones(3))
    with pytest.raises(NpfmError, match=r"a single NumPy array \(\.npy\), not published factors"):
        read(tmp_path / "x.npz")
