"""The light behind objects against a slow average of many points, interpolated by SciPy."""

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from npfm.rendering.backdrop import seen
from npfm.rendering.effects import subdivide
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.surfaces import look

CENTRE = np.array([[0.5, 0.5]])


def lamps(rows):
    """Texels of which a few are brilliant."""
    return Environment(np.random.default_rng(rows).random((rows, 2 * rows, 3)) ** 6)


def averaged(environment, resolution, corner, side, points=200):
    """Mean over a square of the film, whose corner and side are in pixels."""
    steps = (np.arange(points) + 0.5) / points * side
    right, down = np.meshgrid(corner[0] + steps, corner[1] + steps)
    edge = np.tan(CAMERA.field / 2)
    x, y = edge * (2 * right / resolution - 1), edge * (1 - 2 * down / resolution)
    theta, azimuth = np.arccos(y / np.sqrt(x**2 + y**2 + 1)), np.arctan2(x, 1)
    rows, columns, _ = environment.radiance.shape
    place = theta / np.pi * rows - 0.5, (azimuth / np.pi + 1) / 2 * columns - 0.5
    planes = np.moveaxis(environment.radiance, -1, 0)
    return [map_coordinates(plane, place, order=1, mode="grid-wrap").mean() for plane in planes]


@pytest.mark.parametrize("offsets", [CENTRE, subdivide(CENTRE)], ids=["one ray", "16 rays"])
@pytest.mark.parametrize(("rows", "resolution"), [(16, 12), (64, 12), (256, 12), (256, 40)])
def test_each_ray_sees_the_mean_over_its_square(rows, resolution, offsets):
    light = lamps(rows)
    side = 1 / np.sqrt(len(offsets))
    chosen = np.random.default_rng(1).integers(0, resolution**2 * len(offsets), 20)
    found = seen(CAMERA, light, offsets, resolution, chosen)
    for ray, radiance in zip(chosen, found, strict=True):
        pixel, at = divmod(ray, len(offsets))
        row, column = divmod(pixel, resolution)
        corner = offsets[at] + [column, row] - side / 2
        np.testing.assert_allclose(
            radiance, averaged(light, resolution, corner, side), rtol=0.04, atol=0.02
        )


@pytest.mark.parametrize("rows", [32, 1024])
def test_it_does_not_hang_on_how_many_rays_a_pixel_has(rows):
    light = lamps(rows)
    one, many = (
        seen(CAMERA, light, offsets, 16, np.arange(256 * len(offsets)))
        for offsets in (CENTRE, subdivide(CENTRE))
    )
    np.testing.assert_allclose(many.reshape(256, 16, 3).mean(axis=1), one, rtol=0.04, atol=0.02)


def test_stripes_that_are_finer_than_pixels_are_grey():
    radiance = np.zeros((720, 1440, 3))
    radiance[:, ::2] = 1
    # A pixel is 3.75 degrees wide and a stripe a quarter.
    found = seen(CAMERA, Environment(radiance), CENTRE, 8, np.arange(64))
    np.testing.assert_allclose(found, 0.5, atol=0.02)


def test_much_light_is_looked_up_block_by_block(monkeypatch):
    rays = np.random.default_rng(0).permutation(24**2)[:500]
    at_once = seen(CAMERA, lamps(64), CENTRE, 24, rays)
    monkeypatch.setattr("npfm.rendering.backdrop.BLOCK", 100)
    np.testing.assert_array_equal(seen(CAMERA, lamps(64), CENTRE, 24, rays), at_once)


@pytest.mark.parametrize("effects", [(), ("antialiasing",)])
def test_objects_hide_it(effects):
    scene = Scene(("figure", "sphere"), effects)
    offsets = camera_offsets(scene)
    _, coverage, backdrop = look(CAMERA, place(scene), lamps(32), offsets, 24)
    everything = seen(CAMERA, lamps(32), offsets, 24, np.arange(24**2 * len(offsets)))
    whole = everything.reshape(24, 24, -1, 3).mean(axis=2)
    assert not backdrop[coverage == 1].any()
    np.testing.assert_allclose(backdrop[coverage == 0], whole[coverage == 0], rtol=1e-6)
    partly = (coverage > 0) & (coverage < 1)
    assert partly.any() == (effects != ())
    assert (backdrop[partly] <= whole[partly] * (1 + 1e-6)).all()
