"""Evenly spread points against those of a library."""

import numpy as np
import pytest
from scipy.stats import qmc

from npfm.rendering.sampling.low_discrepancy import low_discrepancy


@pytest.mark.parametrize("count", [1, 2, 3, 7, 64, 1000, 4096, 1 << 16])
def test_points_are_those_of_sobol(count):
    power = (count - 1).bit_length()
    expected = qmc.Sobol(2, scramble=False).random_base2(power)[:count]
    np.testing.assert_array_equal(low_discrepancy(count), expected)


def test_no_point_is_none():
    assert low_discrepancy(0).shape == (0, 2)
