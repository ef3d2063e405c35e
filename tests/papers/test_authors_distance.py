import itertools

import numpy as np
import pytest

from npfm.datasets import neural
from npfm.datasets.published_factors import G_THETA, read
from npfm.papers.authors_distance import READINGS, distance, tabulate_channel
from npfm.reflectance.angles import directions
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


def test_values_cell_by_cell():
    """G between whole degrees, F of the bin or between whole degrees, nothing where unknown."""
    grid, rng = HalfDifference(18, 90, 36), np.random.default_rng(2)
    D, F, G = rng.random(18), rng.random(90), rng.random(90)
    F[0] = G[0] = np.nan
    at_bins = tabulate_channel(grid, D, F, G, 0.1, 2.0)
    at_degrees = tabulate_channel(grid, D, F, G, 0.1, 2.0, f_theta=G_THETA)
    for h, d, p in itertools.product((2, 9, 14), (1, 30, 60), (0, 7, 35)):
        product, angles = 2.0 * D[h], []
        for direction in directions(grid.theta_h[h], grid.theta_d[d], grid.phi_d[p]):
            angle = np.degrees(np.arccos(direction[2]))
            angles.append(angle)
            k = int(angle) if angle < 90 else 0
            g = G[k] + (angle - k) * (G[k + 1] - G[k]) if k < 89 else G[89]
            product = product * g / np.cos(np.radians(min(angle, 89)))
        if max(angles) >= 90:
            assert np.isnan(at_bins[h, d, p])
            continue
        assert at_bins[h, d, p] == pytest.approx(0.1 + product * F[d], nan_ok=True)
        between = (F[d] + F[d + 1]) / 2
        assert at_degrees[h, d, p] == pytest.approx(0.1 + product * between, nan_ok=True)
    assert np.isnan(at_bins[:, 0]).all()
    assert np.isfinite(at_bins[2, 30, 7])


#: Means of the channels of the objective, as shares of the zero model's: with G at the centres of
#: bins, and at whole degrees.
READ = {"white-fabric2": (0.0087, 0.0042), "green-latex": (0.0050, 0.0033)}


@pytest.mark.parametrize("material", READ)
def test_the_tables_support_nodes_of_g_at_whole_degrees(data, material):
    table = neural.load(data / "merl_nbrdf.zip", material)
    factors = read(data / "npf_reference.npz")[material]
    found = distance(material, table, factors, table)
    means = found[["g_at_centres", "published"]].mean()
    assert means.to_numpy() == pytest.approx(READ[material], abs=6e-5)
