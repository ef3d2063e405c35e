"""Properties of coordinates, weights and models for whatever input hypothesis thinks of."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from npfm.fitting import registry
from npfm.fitting.factors.microfacet import G_NODES
from npfm.fitting.fits import Fit
from npfm.fitting.objective import (
    compressive_weight,
    counted,
    importance,
    volume_form,
    weighted_median,
)
from npfm.reflectance.angles import directions, half_difference
from npfm.reflectance.half_difference import HalfDifference

#: The same examples at every run, without a time limit for each.
settings.register_profile("same", derandomize=True, deadline=None, max_examples=60, database=None)
settings.load_profile("same")

HALF_PI = np.pi / 2
#: Models of free factors or tables that need none of our solvers.
UNSEARCHED = ("bivariate", "power-iteration")
AWAY = st.floats(0.05, HALF_PI - 0.05)
AROUND = st.floats(0, np.pi, exclude_max=True)
GRIDS = st.builds(
    HalfDifference,
    st.integers(2, 7),
    st.integers(2, 7),
    st.integers(1, 5).map(lambda half: 2 * half),
)


def apart(angle, other):
    """Distance of two angles modulo pi."""
    return abs((angle - other + HALF_PI) % np.pi - HALF_PI)


@given(AWAY, AWAY, AROUND)
def test_angles_come_back(theta_h, theta_d, phi_d):
    found = half_difference(*directions(theta_h, theta_d, phi_d))
    assert abs(found[0] - theta_h) < 1e-12
    assert abs(found[1] - theta_d) < 1e-12
    assert apart(found[2], phi_d) < 1e-12


@given(st.floats(0, 1.5), st.floats(0, 1.5), st.floats(-np.pi, np.pi), st.floats(-np.pi, np.pi))
def test_directions_come_back(theta_i, theta_o, phi_i, phi_o):
    """Up to a rotation about the normal and the exchange that makes phi_d less than pi."""
    light, view = (
        np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
        for t, p in ((theta_i, phi_i), (theta_o, phi_o))
    )
    back = directions(*half_difference(light, view))
    assert abs(back[0] @ back[1] - light @ view) < 1e-12
    found, expected = sorted((back[0][2], back[1][2])), sorted((light[2], view[2]))
    np.testing.assert_allclose(found, expected, atol=1e-12)


@given(st.one_of(st.just(0.0), st.floats(1e-16, 1e-3)), AWAY, AROUND)
def test_at_the_normal_phi_d_alone_is_lost(small, angle, phi_d):
    """Half vector near the normal, or light near view: errors of phi_d grow as 1 / sine."""
    for theta_h, theta_d in ((small, angle), (angle, small)):
        found = half_difference(*directions(theta_h, theta_d, phi_d))
        assert abs(found[0] - theta_h) < 1e-12
        assert abs(found[1] - theta_d) < 1e-12
        assert 0 <= found[2] < np.pi
        assert small == 0 or apart(found[2], phi_d) < 1e-15 / small + 1e-12


@given(GRIDS)
def test_the_centre_of_a_cell_lies_in_it(grid):
    centres = np.meshgrid(grid.theta_h, grid.theta_d, grid.phi_d, indexing="ij")
    assert np.array_equal(grid.cell(*centres).ravel(), np.arange(grid.size))


@given(GRIDS, st.floats(1, 89.9))
def test_weights_of_cells(grid, angle):
    """Not negative, the same with light and view exchanged; a wider limit counts no less."""
    for weight in (volume_form(grid), importance(grid)):
        assert (weight >= 0).all()
        np.testing.assert_allclose(weight, weight[..., ::-1], rtol=1e-12, atol=1e-15)
    inside = counted(grid, angle)
    assert not (inside & ~counted(grid, 89.9)).any()
    assert (importance(grid)[inside] > 0).all()


@given(arrays(float, 30, elements=st.floats(0, 1e300)))
def test_the_compressive_weight_falls_from_1_to_0(relative):
    weight = compressive_weight(np.sort(relative))
    assert ((weight >= 0) & (weight <= 1)).all()
    assert (np.diff(weight) <= 1e-15).all()


@given(st.lists(st.tuples(st.floats(0, 1e6), st.integers(0, 5)), min_size=1), st.integers(-40, 40))
def test_the_weighted_median_halves_the_weight(samples, power):
    value, weight = (np.array(column, dtype=float) for column in zip(*samples, strict=True))
    if not weight.any():
        with pytest.raises(ValueError, match="no samples"):
            weighted_median(value, weight)
        return
    median = weighted_median(value, weight)
    assert median in value[weight > 0]
    assert 2 * weight[value < median].sum() < weight.sum() <= 2 * weight[value <= median].sum()
    assert weighted_median(value[::-1], weight[::-1]) == median
    assert weighted_median(value * 2.0**power, weight * 3) == median * 2.0**power


def fits(model, grid):
    """Any fit of a model that a file may hold: factors up to 1, coefficients at will."""
    nh, nd, nphi = grid.shape
    sizes = {"D": nh, "F": nd, "G": G_NODES, "H": nphi}
    factor, coefficient = st.floats(2**-20, 1, width=32), st.floats(0, 2**20, width=32)
    signed = st.floats(-(2**10), 2**10, width=32)
    shapes = {
        "bivariate": {"B": (nh, nd)},
        "independent-g": dict.fromkeys("DFG"),
        "g-from-d": dict.fromkeys("DF"),
        "naive": dict.fromkeys("DFH"),
        "bivariate-g": {"B": (nh, nd), "G": None},
        "power-iteration": dict.fromkeys("DF"),
        "low-rank-b": {"U": (nh, 2), "V": (nd, 2), "G": None},
        "shared-lobes": {"D": (2, nh), "F": None, "G": (2, G_NODES)},
    }
    parts = {}
    for name, shape in shapes[model].items():
        elements = factor if name in sizes else coefficient if name == "B" else signed
        channels = 1 if name in registry.declared(model).shared else 3
        size = (channels, *(shape or (sizes[name],)))
        parts[name] = arrays(np.float32, size, elements=elements)
    if model not in UNSEARCHED:
        parts["rho_d"] = arrays(np.float32, 3, elements=coefficient)
    if {"D", "F"} <= parts.keys():
        lobes = shapes[model]["D"][:1] if shapes[model]["D"] else ()
        parts["rho_s"] = arrays(np.float32, (3, *lobes), elements=coefficient)
    return st.fixed_dictionaries(parts).map(lambda p: Fit(model, p, grid))


GRID = HalfDifference(4, 3, 6)
#: Models of free factors or tables.
NON_PARAMETRIC = [n for n, m in registry.models().items() if m.solver or n in UNSEARCHED]


@pytest.mark.parametrize("model", NON_PARAMETRIC)
@settings(max_examples=25)
@given(data=st.data())
def test_models_are_not_negative_and_reciprocal(model, data):
    """But for naive, which is reciprocal as far as its H is symmetric."""
    fit = data.draw(fits(model, GRID))
    table = registry.model(model).tabulate(fit)
    above = table.values[:, GRID.above_horizon]
    assert np.isfinite(above).all()
    assert (above >= 0).all()
    assert np.array_equal(table.valid, np.broadcast_to(GRID.above_horizon, table.valid.shape))
    if model == "naive":
        H = fit.parameters["H"]
        symmetric = Fit(model, fit.parameters | {"H": np.maximum(H, H[:, ::-1])}, GRID)
        table = registry.model(model).tabulate(symmetric)
    assert np.array_equal(table.values, table.values[..., ::-1])
