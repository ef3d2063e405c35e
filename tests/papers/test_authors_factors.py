import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.papers.authors_factors import read


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
    with pytest.raises(NpfmError, match=rf"x\.npz: cannot be read .*{missing} is not a file"):
        read(tmp_path / "x.npz")


def test_another_shape_is_told(tmp_path):
    np.savez(tmp_path / "x.npz", **arrays(G=np.ones((1, 80, 3))))
    with pytest.raises(NpfmError, match=r"G is of shape \(1, 80, 3\)"):
        read(tmp_path / "x.npz")


def test_an_absent_file_is_told(tmp_path):
    with pytest.raises(NpfmError, match=r"none\.npz: cannot be read"):
        read(tmp_path / "none.npz")
