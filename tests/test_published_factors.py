import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.published_factors import read


def test_the_authors_factors_have_maximum_1_and_hide_what_no_sample_touched(data):
    published = read(data / "npf_reference.npz")
    assert len(published) == 10 and "chrome" in published
    for factors in published.values():
        assert set(factors) == {"D", "G", "F"}
        for values in factors.values():
            assert values.shape == (3, 90)
        np.testing.assert_allclose(factors["D"].max(axis=1), 1, rtol=1e-6)
        assert np.isnan(factors["G"][:, 0]).all() and np.isfinite(factors["G"][:, 1:]).all()
        assert np.isnan(factors["F"][:, 0]).all() and np.isfinite(factors["F"][:, 1:]).all()


@pytest.mark.parametrize("missing", ["names", "D"])
def test_a_file_that_lacks_something_is_told(tmp_path, missing):
    arrays = {"names": np.array(["a"]), **dict.fromkeys("DGF", np.ones((1, 90, 3)))}
    del arrays[missing]
    np.savez(tmp_path / "x.npz", **arrays)
    with pytest.raises(NpfmError, match=r"x\.npz: cannot be read as published factors"):
        read(tmp_path / "x.npz")


def test_another_shape_is_told(tmp_path):
    np.savez(tmp_path / "x.npz", names=["a"], D=np.ones((1, 90, 3)), G=np.ones((1, 80, 3)), F=[1])
    with pytest.raises(NpfmError, match=r"G is of shape \(1, 80, 3\)"):
        read(tmp_path / "x.npz")


def test_an_absent_file_is_told(tmp_path):
    with pytest.raises(NpfmError, match=r"none\.npz: cannot be read"):
        read(tmp_path / "none.npz")
