import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering import assembly, textures, transport
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import Scene, place

GRID = HalfDifference(8, 8, 16)
SPHERE = Scene(("sphere",), ())
RESOLUTION = 24


@pytest.fixture(scope="module")
def matrix():
    light = Environment(np.random.default_rng(2).uniform(0, 1, (8, 16, 3)))
    strategies = registry.make(["light", "half-vector"], Given(light, GRID))
    return assembly.build(SPHERE, light, GRID, RESOLUTION, 64, 1, strategies)


@pytest.fixture(scope="module")
def places():
    return textures.coordinates(place(SPHERE), RESOLUTION)


def flat(*values):
    return [Table(np.full((3, *GRID.shape), value), GRID) for value in values]


def test_a_texture_is_wrapped_around_the_axis(matrix, places):
    on = matrix.foreground
    assert np.isfinite(places[on]).all()
    assert np.isnan(places[matrix.coverage == 0]).all()
    u, v = np.moveaxis(places, -1, 0)
    middle = RESOLUTION // 2
    assert v[on].min() < 0.2 and v[on].max() > 0.8
    assert (np.diff(v[2:-2, middle]) > 0).all()  # from the top downwards
    assert min(u[middle, middle], 1 - u[middle, middle]) < 0.05  # to the camera
    assert 0.1 < u[middle, middle + 7] < 0.25 and 0.75 < u[middle, middle - 8] < 0.9


@pytest.mark.parametrize("count", [1, 2, 5])
def test_shares_add_up_and_lie_between_neighbours(places, count):
    texture = np.random.default_rng(1).random((16, 32))
    parts = textures.shares(texture, places, count)
    assert parts.shape == (count, RESOLUTION, RESOLUTION)
    np.testing.assert_allclose(parts.sum(axis=0), 1, rtol=1e-12)
    assert ((parts > 0).sum(axis=0) <= 2).all()


def test_black_is_the_first_and_white_the_last(matrix, places):
    tables = flat(0.1, 0.2, 0.4)
    for value, table in ((0.0, tables[0]), (0.5, tables[1]), (1.0, tables[2])):
        parts = textures.shares(np.full((4, 4), value), places, 3)
        found = textures.render_varying(matrix, tables, parts)
        np.testing.assert_allclose(found, transport.render(matrix, table), rtol=1e-5)


def test_an_edge_whose_pixels_are_covered_in_part_has_the_material_beside_it(places):
    light = Environment(np.random.default_rng(2).uniform(0, 1, (8, 16, 3)))
    smooth = assembly.build(Scene(("sphere",), ("antialiasing",)), light, GRID, RESOLUTION, 64, 1)
    assert ((smooth.coverage > 0) & np.isnan(places[..., 0])).any()
    first, second = flat(0.1, 0.4)
    found = textures.render_varying(
        smooth, [first, second], textures.shares(np.ones((4, 4)), places, 2)
    )
    np.testing.assert_allclose(found, transport.render(smooth, second), rtol=1e-5)


def test_where_there_is_no_object_at_all_there_are_shares():
    parts = textures.shares(textures.own_texture(), np.full((3, 3, 2), np.nan), 3)
    np.testing.assert_allclose(parts.sum(axis=0), 1)


def test_weights_are_read_off_bands():
    grey = np.array([[[0.0], [0.5], [1.0]]])
    between = textures.weights_of(grey)
    np.testing.assert_allclose(between[0], [[1, 0, 0, 0], [0, 0.5, 0.5, 0], [0, 0, 0, 1]])
    colours = np.array([[[1.0, 0, 0], [0, 0, 0], [0.25, 0.25, 0], [1, 1, 0]]])
    expected = [[1, 0, 0, 0], [0, 0, 0, 1], [0.25, 0.25, 0, 0.5], [0.5, 0.5, 0, 0]]
    np.testing.assert_allclose(textures.weights_of(colours)[0], expected)
    np.testing.assert_allclose(textures.weights_of(np.array([[[0.0, 0.5, 0, 1]]]))[0, 0, 3], 2 / 3)
    with pytest.raises(NpfmError, match="no material at column 1, row 0"):
        textures.weights_of(np.array([[[1.0, 0, 0, 0], [0, 0, 0, 0]]]))


def test_own_weights_have_every_material_and_mixtures(places):
    weights = textures.own_weights()
    np.testing.assert_allclose(weights.sum(axis=-1), 1, rtol=1e-12)
    assert (weights.max(axis=(0, 1)) > 0.95).all()
    assert (weights.mean(axis=(0, 1)) > 0.1).all()
    parts = textures.shares_of_weights(weights, places)
    assert parts.shape == (4, RESOLUTION, RESOLUTION)
    np.testing.assert_allclose(parts.sum(axis=0), 1, rtol=1e-12)


def test_the_own_texture_has_no_seam_and_all_values():
    texture = textures.own_texture()
    steps = np.abs(np.diff(np.concatenate([texture, texture[:, :1]], axis=1), axis=1))
    assert steps[:, -1].max() <= steps[:, :-1].max() * 1.001
    assert 0 <= texture.min() < 0.02 and 0.98 < texture.max() <= 1
    assert 0.3 < texture.mean() < 0.7
