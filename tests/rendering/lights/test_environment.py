import math

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from npfm.errors import NpfmError
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import LUMINANCE, Environment, tabulate
from npfm.storage.pictures import write_exr


def random_directions(count: int, seed: int = 0) -> np.ndarray:
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def spiky(rows: int = 12, columns: int = 24) -> Environment:
    """Some brilliant texels, some black ones, a black row and a black column."""
    radiance = np.random.default_rng(1).random((rows, columns, 3)) ** 12 * 1e4
    radiance[3] = 0
    radiance[-1] = 0
    radiance[:, 5] = 0
    return Environment(radiance)


@pytest.mark.parametrize(
    ("direction", "row", "column"),
    [
        ((0, 0, -1), 4, 8),  # the camera's direction: the middle of the map
        ((1, 0, 0), 4, 12),  # right of the camera
        ((-1, 0, 0), 4, 4),
        ((0, 1, 0), 0, None),
        ((0, -1, 0), 7, None),
    ],
)
def test_axes_point_into_the_right_texels(direction, row, column):
    light = Environment(np.ones((8, 16, 3)))
    # A little right of and below the boundary between texels.
    nudged = np.add(direction, (1e-6, -1e-6, 1e-6 * np.sign(direction[0])))
    found = np.divmod(light.texel(nudged / np.linalg.norm(nudged)), 16)
    assert found[0] == row
    assert column is None or found[1] == column


def test_straight_back_is_the_seam():
    light = Environment(np.ones((8, 16, 3)))
    right, left = np.array([1e-6, -1e-6, 1.0]), np.array([-1e-6, -1e-6, 1.0])
    assert light.texel(right) % 16 == 15
    assert light.texel(left) % 16 == 0
    assert light.texel(np.array([0.0, 0.0, 1.0])) % 16 == 0


def test_lookup_agrees_with_a_search_through_all_texels():
    light = spiky()
    rows, columns, _ = light.radiance.shape
    for x, y, z in random_directions(200):
        row = next(k for k in range(rows) if y >= math.cos((k + 1) * math.pi / rows))
        azimuth = math.acos(-z / math.hypot(x, z)) * (1 if x > 0 else -1)
        edges = [2 * math.pi * (k + 1) / columns - math.pi for k in range(columns)]
        column = next(k for k, edge in enumerate(edges) if azimuth < edge)
        assert (light.lookup(np.array([x, y, z])) == light.radiance[row, column]).all()


def test_between_the_centres_of_texels_light_is_interpolated_around_the_seam():
    light = spiky()
    rows, columns, _ = light.radiance.shape
    direction = random_directions(500)
    theta, azimuth = np.arccos(direction[:, 1]), np.arctan2(direction[:, 0], -direction[:, 2])
    places = theta / np.pi * rows - 0.5, (azimuth / np.pi + 1) / 2 * columns - 0.5
    # Two columns more on either side, and the first and the last row once more.
    padded = np.pad(light.radiance, ((0, 0), (2, 2), (0, 0)), mode="wrap")
    padded = np.pad(padded, ((1, 1), (0, 0), (0, 0)), mode="edge")
    for channel, plane in enumerate(np.moveaxis(padded, -1, 0)):
        expected = map_coordinates(plane, np.add(places, [[1], [2]]), order=1)
        np.testing.assert_allclose(light.interpolated(direction)[:, channel], expected, atol=1e-8)


def test_at_the_centres_of_texels_light_is_theirs():
    light = spiky()
    theta, azimuth = np.meshgrid(
        (np.arange(12) + 0.5) / 12 * np.pi,
        (np.arange(24) + 0.5) / 12 * np.pi - np.pi,
        indexing="ij",
    )
    x, z = np.sin(theta) * np.sin(azimuth), -np.sin(theta) * np.cos(azimuth)
    found = light.interpolated(np.stack([x, np.cos(theta), z], axis=-1))
    np.testing.assert_allclose(found, light.radiance, atol=1e-8)


def test_solid_angles_add_up_to_the_sphere():
    light = spiky()
    assert light.solid_angle.sum() * 24 == pytest.approx(4 * np.pi, rel=1e-14)


def test_density_integrates_to_one_and_follows_luminance():
    light = spiky()
    density = light.density.reshape(12, 24)
    assert light.solid_angle @ density.sum(axis=1) == pytest.approx(1, rel=1e-14)
    luminance = light.radiance @ LUMINANCE
    lit = luminance > 0
    ratio = density[lit] / luminance[lit]
    np.testing.assert_allclose(ratio, ratio[0], rtol=1e-12)
    assert (density[~lit] == 0).all()


def test_samples_fall_into_texels_by_their_probability():
    light = spiky()
    count = 200_000
    direction = light.sample(np.random.default_rng(2).random((count, 2)))
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, rtol=1e-12)
    expected = count * light.density * np.repeat(light.solid_angle, 24)
    found = np.bincount(light.texel(direction), minlength=12 * 24)
    assert (found[expected == 0] == 0).all()
    some = expected > 5
    chi_squared = ((found - expected)[some] ** 2 / expected[some]).sum()
    freedom = some.sum()
    assert abs(chi_squared - freedom) < 4 * np.sqrt(2 * freedom)


def test_samples_are_uniform_over_the_solid_angle_of_a_texel():
    radiance = np.zeros((4, 8, 3))
    radiance[0, 2] = 1
    direction = Environment(radiance).sample(np.random.default_rng(3).random((100_000, 2)))
    # The first row spans cosines from cos(45 degrees) to 1, the third column 45 degrees.
    height = (direction[:, 1] - np.sqrt(0.5)) / (1 - np.sqrt(0.5))
    turn = (np.arctan2(direction[:, 0], -direction[:, 2]) + np.pi / 2) / (np.pi / 4)
    for fraction in (height, turn):
        assert 0 <= fraction.min() < 1e-3 and 1 - 1e-3 < fraction.max() <= 1
        found, _ = np.histogram(fraction, bins=20, range=(0, 1))
        assert ((found - 5000) ** 2 / 5000).sum() < 19 + 4 * np.sqrt(2 * 19)
    assert abs(np.corrcoef(height, turn)[0, 1]) < 0.02


def test_estimates_by_samples_agree_with_the_sum_over_texels():
    light = spiky()
    up = tabulate(lambda d: np.maximum(d[:, 1:2], 0) * np.ones(3), 12, 16)
    exact = np.einsum("rck,rck,r->k", light.radiance, up, light.solid_angle)
    direction = light.sample(np.random.default_rng(4).random((100_000, 2)))
    weighted = light.lookup(direction) * np.maximum(direction[:, 1:2], 0)
    terms = weighted / light.pdf(direction)[:, None]
    error = terms.std(axis=0) / np.sqrt(len(terms))
    assert (np.abs(terms.mean(axis=0) - exact) < 4 * error).all()
    assert (error < 0.03 * exact).all()


def test_samples_keep_the_stratification_of_their_numbers():
    side = 16
    grid = (np.arange(side) + 0.5) / side
    u = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
    direction = Environment(np.ones((64, 128, 3))).sample(u)
    height = np.floor((1 - direction[:, 1]) / 2 * side)
    turn = np.floor((np.arctan2(direction[:, 0], -direction[:, 2]) / (2 * np.pi) + 0.5) * side)
    assert len(set(zip(height, turn, strict=True))) == side * side


def test_the_ends_of_the_unit_square_give_directions_that_can_be_drawn():
    light = spiky()
    ends = np.array([0.0, np.nextafter(1.0, 0.0), 1.0])
    u = np.stack(np.meshgrid(ends, ends), axis=-1).reshape(-1, 2)
    direction = light.sample(u)
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, rtol=1e-12)
    # Strictly inside, the texel found is one that has light.
    assert (light.pdf(light.sample(np.clip(u, 1e-9, 1 - 1e-9))) > 0).all()


def test_turning_the_map_turns_the_light():
    light = spiky()
    turned = Environment(np.roll(light.radiance, 3, axis=1))
    angle = 2 * np.pi * 3 / 24
    x, y, z = random_directions(500).T
    # Azimuth grows to the right, from -z to +x.
    right = np.stack(
        [np.cos(angle) * x - np.sin(angle) * z, y, np.sin(angle) * x + np.cos(angle) * z], axis=1
    )
    assert (turned.lookup(right) == light.lookup(np.stack([x, y, z], axis=1))).all()


def test_turned_by_whole_texels_a_light_is_rolled():
    light = spiky()
    for texels in (-7, 3, 24, 25):
        turned = environment.turned(light, 15 * texels)
        assert (turned.radiance == np.roll(light.radiance, texels, axis=1)).all()


@pytest.mark.parametrize("degrees", [4.0, -100.0, 359.0])
def test_turned_by_any_angle_texels_are_what_they_cover(degrees):
    light = spiky()
    turned = environment.turned(light, degrees)
    # Texels of a degree each, which the angle is a whole number of.
    fine = Environment(np.repeat(light.radiance, 15, axis=1))
    wanted = environment.turned(fine, degrees).radiance.reshape(12, 24, 15, 3).mean(axis=2)
    np.testing.assert_allclose(turned.radiance, wanted, rtol=1e-9, atol=1e-9)
    assert (environment.turned(light, 0).radiance == light.radiance).all()


def test_tabulate_averages_over_solid_angle():
    height, columns = 6, 12
    edges = np.cos(np.arange(height + 1) * np.pi / height)
    mean = tabulate(lambda d: d[:, 1:2] ** 2 * np.ones(3), height, 64)
    exact = (edges[1:] ** 3 - edges[:-1] ** 3) / (3 * (edges[1:] - edges[:-1]))
    assert mean.shape == (height, columns, 3)
    np.testing.assert_allclose(mean, np.broadcast_to(exact[:, None, None], mean.shape), rtol=1e-3)


def test_tabulate_does_not_depend_on_how_directions_are_blocked(monkeypatch):
    def radiance(direction):
        return np.exp(3 * direction)

    whole = tabulate(radiance, 8, 3)
    monkeypatch.setattr(environment, "BLOCK", 200)
    np.testing.assert_allclose(tabulate(radiance, 8, 3), whole, rtol=1e-14)


@pytest.mark.parametrize(
    ("radiance", "message"),
    [
        (np.ones((4, 8)), r"\(4, 8\)"),
        (np.zeros((4, 8, 3)), "every texel is black"),
        (np.full((4, 8, 3), -2.0), "smallest value is -2"),
        (np.full((4, 8, 3), np.nan), "96 values are NaN or infinite"),
    ],
)
def test_what_is_not_light_is_refused(radiance, message):
    with pytest.raises(ValueError, match=message):
        Environment(radiance)


def test_a_map_comes_back_from_its_file(tmp_path):
    light = spiky()
    environment.write(tmp_path / "light.exr", light)
    back = environment.read(tmp_path / "light.exr")
    assert (back.radiance == light.radiance.astype(np.float32)).all()
    environment.write(tmp_path / "again.exr", back)
    assert (tmp_path / "again.exr").read_bytes() == (tmp_path / "light.exr").read_bytes()


@pytest.mark.parametrize(
    ("pixels", "message"),
    [(np.ones((4, 4, 3)), "4 x 4 pixels"), (np.zeros((4, 8, 3)), "every texel is black")],
)
def test_a_file_that_is_no_light_is_refused_in_one_line(tmp_path, pixels, message):
    path = tmp_path / "light.exr"
    write_exr(path, pixels)
    with pytest.raises(NpfmError, match=message) as caught:
        environment.read(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
