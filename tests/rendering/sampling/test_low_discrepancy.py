import numpy as np
import pytest

from npfm.rendering.sampling.low_discrepancy import low_discrepancy, rotate


@pytest.mark.parametrize("count", [1, 2, 64, 100])
def test_low_discrepancy_points_are_a_prefix_of_one_sequence(count):
    points = low_discrepancy(count)
    np.testing.assert_array_equal(points, low_discrepancy(128)[:count])


def test_low_discrepancy_points_form_nets():
    # A (0, 6, 2)-net in base 2: each elementary interval of area 1/64 holds one point, in any
    # aligned block of the sequence, so that each camera ray of a pixel gets a net of its own.
    for points in low_discrepancy(256).reshape(4, 64, 2):
        for columns in (1, 2, 4, 8, 16, 32, 64):
            index = np.floor(points * [columns, 64 // columns]).astype(int)
            assert len({tuple(i) for i in index}) == 64


def test_rotation_stays_in_the_unit_square_and_keeps_distances_on_the_torus():
    points = rotate(low_discrepancy(64), np.array([0.7, 0.2]))
    assert points.min() >= 0 and points.max() < 1
    back = rotate(points, -np.array([0.7, 0.2]))
    np.testing.assert_allclose(back, low_discrepancy(64), atol=1e-12)
