import numpy as np
import pytest

from npfm.papers.authors_distance import READINGS, distance
from npfm.papers.authors_factors import G_THETA, tabulate_channel
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table

GRID = HalfDifference(18, 18, 36)


@pytest.fixture(scope="module")
def factors():
    one = {
        "D": np.exp(-np.linspace(0, 3, 18)),
        "F": np.linspace(0.2, 1, 18),
        "G": np.cos(G_THETA) ** 0.5,
    }
    arrays = {name: np.stack([values] * 3) for name, values in one.items()}
    return arrays | {"rho_d": np.array([0.1, 0.2, 0.3]), "rho_s": np.array([1.0, 2.0, 3.0])}


def tabulated(factors, scale=1.0):
    channels = [
        scale * tabulate_channel(GRID, **{name: v[k] for name, v in factors.items()})
        for k in range(3)
    ]
    return Table(np.where(GRID.above_horizon, np.stack(channels), -1.0), GRID)


def test_factors_are_no_distance_from_their_own_table(factors):
    table = tabulated(factors)
    found = distance("felt", table, factors, table)
    assert found["channel"].tolist() == ["red", "green", "blue"]
    numbers = found[["published", "ours", "log_ratio", "log_error"]].to_numpy()
    np.testing.assert_allclose(numbers, 0, atol=1e-12)
    assert (found[list(READINGS[1:])] > 1e-5).all(axis=None)


def test_a_constant_shows_at_once(factors):
    table = tabulated(factors, scale=np.pi)
    found = distance("felt", table, factors, table)
    assert found["log_ratio"].to_numpy() == pytest.approx(-np.log(np.pi))
    assert found["log_error"].to_numpy() == pytest.approx(np.log(np.pi))
    # the square of what is left of the table, as a share of that of the zero model
    assert found["published"].to_numpy() == pytest.approx((1 - 1 / np.pi) ** 2)
    np.testing.assert_allclose(found["ours"], 0, atol=1e-12)


def test_cells_of_unknown_components_do_not_count(factors):
    table = tabulated(factors)
    unknown = {name: values.copy() for name, values in factors.items()}
    unknown["G"][:, 0] = unknown["F"][:, 0] = np.nan
    wrong = Table(table.values.copy(), GRID)
    wrong.values[:, :, 0] *= 5
    found = distance("felt", wrong, unknown, table)
    np.testing.assert_allclose(found[["published", "ours", "log_error"]], 0, atol=1e-12)
