import numpy as np
import pytest

from npfm.rendering.effects import SUBPIXELS
from npfm.rendering.scenes import CAMERA, Scene
from npfm.rendering.view_angles import NOTHING, view_angles

PIXELS = 24


def angle_on_the_sphere(x, y):
    """Degrees between the normal of the unit sphere and the viewer, along a ray of the film."""
    edge = np.tan(CAMERA.field / 2)
    ray = np.array([edge * x, edge * y, -1.0])
    ray /= np.linalg.norm(ray)
    # By the law of sines in the triangle of viewer, centre and point.
    sine = CAMERA.distance * np.sin(np.arccos(-ray[2]))
    return np.degrees(np.arcsin(sine)) if sine <= 1 else None


def by_hand(steps):
    """Mean over steps x steps rays of every pixel."""
    expected = np.full((PIXELS, PIXELS), NOTHING)
    places = (np.arange(steps) + 0.5) / steps
    for row in range(PIXELS):
        for column in range(PIXELS):
            rays = [
                angle_on_the_sphere(2 * (column + x) / PIXELS - 1, 1 - 2 * (row + y) / PIXELS)
                for x in places
                for y in places
            ]
            if met := [angle for angle in rays if angle is not None]:
                expected[row, column] = np.mean(met)
    return expected


@pytest.mark.parametrize(("effects", "steps"), [((), 1), (("antialiasing",), SUBPIXELS)])
def test_a_sphere_is_seen_under_the_angles_of_the_law_of_sines(effects, steps):
    # Normals of more than 88.9 degrees are bent to the viewer.
    found = view_angles(Scene(("sphere",), effects), PIXELS)
    np.testing.assert_allclose(found, by_hand(steps), atol=0.3)


def test_the_nearest_object_counts():
    both, alone = (
        view_angles(Scene(objects), 12) for objects in (("figure", "sphere"), ("sphere",))
    )
    assert both.shape == alone.shape == (12, 12)
    assert not np.allclose(both, alone)
    assert (both[:, -1] == NOTHING).all() and both.min() >= 0
