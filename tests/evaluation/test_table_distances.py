import math

import numpy as np
import pytest

from npfm.evaluation.table_distances import BLACK, distances
from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

GRID = HalfDifference(8, 7, 6)


def a_table(seed, scale=1.0):
    rng = np.random.default_rng(seed)
    return Table(scale * 10 ** rng.uniform(-3, 1, (3, *GRID.shape)), GRID)


def weight(h, d, p):
    """cos(theta_i) cos(theta_o) and the solid angles of a cell, from directions of their own."""
    th, td, pd = GRID.theta_h[h], GRID.theta_d[d], GRID.phi_d[p]
    # Difference vector (Rusinkiewicz), turned by theta_h about the y axis.
    x, z = math.sin(td) * math.cos(pd), math.cos(td)
    cos_i = math.cos(th) * z - math.sin(th) * x
    cos_o = math.cos(th) * z + math.sin(th) * x  # the other side of the half vector
    if min(cos_i, cos_o) < math.cos(math.radians(80)):
        return 0.0
    # Solid angles 4 cos(td) sin(td) sin(th) dth dtd dpd dph; theta_h bins grow as sqrt(theta_h).
    return cos_i * cos_o * 4 * z * math.sin(td) * math.sin(th) * math.sqrt(th)


def test_distances_by_a_loop():
    one, other = a_table(1), a_table(2)
    other.values[0, 3] = -1  # not measured
    sums = np.zeros(3)
    for c, h, d, p in np.ndindex(other.values.shape):
        y = other.values[c, h, d, p]
        if y >= 0:
            x, w = one.values[c, h, d, p], weight(h, d, p)
            root = x ** (1 / 3) - y ** (1 / 3)
            log = math.log(x + 1e-3) - math.log(y + 1e-3)
            sums += w * np.array([1, root**2, log**2])
    found = distances(one, other)
    assert found["cube-root"] == pytest.approx(math.sqrt(sums[1] / sums[0]), rel=1e-9)
    assert found["logarithm"] == pytest.approx(math.sqrt(sums[2] / sums[0]), rel=1e-9)


def test_tables_of_both_directions_by_a_loop():
    grid = Directional(6, 2, 3, 2)
    rng = np.random.default_rng(0)
    one, other = (Table(rng.random((3, *grid.shape)), grid) for _ in range(2))
    sums = np.zeros(2)
    for index in np.ndindex(other.values.shape):
        weight = 1.0
        for degrees, half in ((15 * index[1], 7.5), (30 * index[3], 15)):
            ends = (math.radians(max(degrees - half, 0)), math.radians(degrees + half))
            solid_angle = math.cos(ends[0]) - math.cos(ends[1])
            weight *= solid_angle * math.cos(math.radians(degrees)) * (degrees <= 80)
        root = np.cbrt(one.values[index]) - np.cbrt(other.values[index])
        sums += weight * np.array([1, root**2])
    found = distances(one, other)["cube-root"]
    assert found == pytest.approx(math.sqrt(sums[1] / sums[0]), rel=1e-9)


def test_equal_tables_are_not_apart():
    assert distances(a_table(1), a_table(1)) == {"cube-root": 0, "logarithm": 0}


def test_constants_apart():
    """0 and 1/sr: cube roots 0 and 1; logarithms log BLACK and log(1 + BLACK)."""
    black, white = (Table(np.full((3, *GRID.shape), value), GRID) for value in (0.0, 1.0))
    found = distances(black, white)
    assert found["cube-root"] == pytest.approx(1)
    assert found["logarithm"] == pytest.approx(math.log((1 + BLACK) / BLACK))


def test_what_a_fit_has_below_zero_is_black():
    negative, black = a_table(1, scale=-1.0), Table(np.zeros((3, *GRID.shape)), GRID)
    assert distances(negative, a_table(2)) == distances(black, a_table(2))


def test_without_a_measurement_there_is_no_distance():
    nothing = Table(np.full((3, *GRID.shape), -1.0), GRID)
    assert all(math.isnan(value) for value in distances(a_table(1), nothing).values())
