import numpy as np
import pytest

from npfm import compilation
from npfm.errors import NpfmWarning
from npfm.fitting.factors import kernels as fitting
from npfm.rendering import kernels as rendering
from npfm.rendering import product_kernel, row_sums

PASSES = [
    fitting.kernel_sums,
    rendering.light_directions,
    rendering.half_difference_cells,
    row_sums.row_sums,
    rendering.highlights,
    product_kernel.radiances,
]


@pytest.mark.parametrize("function", PASSES, ids=lambda function: function.__name__)
def test_passes_are_there_when_their_module_is_imported(function):
    """For one set of types, and for no others later: nothing is compiled while a clock runs."""
    assert len(function.signatures) == 1
    others = [np.float32(0)] * len(function.signatures[0])
    with pytest.raises(TypeError, match="No matching definition"):
        function(*others)
    assert len(function.signatures) == 1


def test_a_cache_that_is_full_is_done_without(monkeypatch):
    def full(signature, cache=False, **options):
        if cache:
            raise OSError(28, "No space left on device")
        return lambda function: function

    monkeypatch.setattr(compilation, "njit", full)
    compilation._warn_once.cache_clear()
    with pytest.warns(NpfmWarning, match="NUMBA_CACHE_DIR"):
        assert compilation.compiled("f8(f8)")(abs) is abs
