"""Golden-section search."""

import numpy as np
import pytest

from npfm.fitting.solvers.golden import golden_section


@pytest.mark.parametrize("minimum", [0.9, 0.5, 0.1, 1e-2, 1e-4])
def test_a_parabola(minimum):
    """To a thousandth of where it is, however close to 0."""
    found = golden_section(lambda t: (t - minimum) ** 2)
    assert found == pytest.approx(minimum, rel=2e-3)


@pytest.mark.parametrize("minimum", [0.3, 0.7])
def test_a_kink(minimum):
    assert golden_section(lambda t: abs(t - minimum), 1e-6) == pytest.approx(minimum, rel=2e-6)


def test_a_minimum_at_either_end():
    assert golden_section(lambda t: -t) > 0.999
    assert golden_section(lambda t: t) < 1e-8


def test_returns_the_best_point_it_has_seen():
    """Even of a function with several minima."""
    seen = {}

    def bumpy(t):
        seen[t] = np.cos(40 * t) + t
        return seen[t]

    assert seen[golden_section(bumpy)] == min(seen.values())


def test_the_section_is_golden():
    """One new evaluation an iteration, each interval 0.618 of the one before."""
    points = []

    def parabola(t):
        points.append(t)
        return (t - 0.3) ** 2

    golden_section(parabola, 1e-6)
    expected = 2 + np.ceil(np.log(0.3e-6) / np.log((5**0.5 - 1) / 2))
    assert abs(len(points) - expected) <= 1
    assert len(set(points)) == len(points)


def test_a_constant_ends():
    assert 0 <= golden_section(lambda t: 1.0) <= 1
