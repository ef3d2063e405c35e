import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from npfm.errors import NpfmError
from npfm.rendering.lights.environment import LUMINANCE, Environment, tabulate
from npfm.rendering.lights.formats import load_probe
from npfm.storage.pictures import write_exr

PROBES = {
    "grace_probe.hdr": "angular-map",
    "ennis_probe.hdr": "angular-map",
    "rnl_probe.hdr": "angular-map",
    "stpeters_cross.hdr": "vertical-cross",
}
#: Rotations that turn the front face of a cube, seen from inside, into each face of a vertical
#: cross: about the vertical for left and right, and rolling on downwards for the others.
FACES = {
    (1, 1): ("x", 0),
    (1, 0): ("y", 90),
    (1, 2): ("y", -90),
    (0, 1): ("x", 90),
    (2, 1): ("x", -90),
    (3, 1): ("x", -180),
}


def smooth(direction: np.ndarray) -> np.ndarray:
    """A light without symmetry, another one in each channel."""
    return np.exp(direction @ [[1.0, 0.3, -0.2], [0.5, -1.0, 0.4], [-0.3, 0.2, 1.1]])


def centres(count: int) -> np.ndarray:
    return (np.arange(count) + 0.5) / count * 2 - 1


def angular_map(size: int) -> np.ndarray:
    """Debevec's recipe: turn (0, 0, -1) by phi about y, then by theta about -z."""
    pixels = np.full((size, size, 3), 1e9)
    for i, v in enumerate(-centres(size)):
        for j, u in enumerate(centres(size)):
            if (r := np.hypot(u, v)) <= 1:
                # Towards +x and up are positive angles.
                away = Rotation.from_euler("y", -np.pi * r)
                around = Rotation.from_euler("z", np.arctan2(v, u))
                pixels[i, j] = smooth((around * away).apply([0, 0, -1]))
    return pixels


def vertical_cross(size: int) -> np.ndarray:
    pixels = np.full((4 * size, 3 * size, 3), 1e9)
    x, y = np.meshgrid(centres(size), -centres(size))
    front = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3)
    front /= np.linalg.norm(front, axis=1, keepdims=True)
    for (row, column), (axis, degrees) in FACES.items():
        turned = Rotation.from_euler(axis, degrees, degrees=True).apply(front)
        face = smooth(turned).reshape(size, size, 3)
        pixels[row * size : (row + 1) * size, column * size : (column + 1) * size] = face
    return pixels


def lat_long(size: int) -> np.ndarray:
    return tabulate(smooth, size, 4)


@pytest.mark.parametrize(
    ("layout", "pixels"),
    [
        ("angular-map", angular_map(128)),
        ("vertical-cross", vertical_cross(64)),
        ("lat-long", lat_long(96)),
    ],
)
def test_a_light_comes_back_from_every_layout(tmp_path, layout, pixels):
    write_exr(tmp_path / "probe.exr", pixels)
    converted = load_probe(tmp_path / "probe.exr", layout, 32).radiance
    exact = tabulate(smooth, 32, 8)
    np.testing.assert_allclose(converted, exact, rtol=0.02)
    assert np.abs(converted / exact - 1).mean() < 0.002


def test_lat_long_of_the_wanted_size_is_taken_as_it_is(tmp_path):
    pixels = np.random.default_rng(0).random((16, 32, 3)).astype(np.float32)
    write_exr(tmp_path / "probe.exr", pixels)
    assert (load_probe(tmp_path / "probe.exr", "lat-long", 16).radiance == pixels).all()


def test_lat_long_is_read_across_its_seam(tmp_path):
    pixels = np.zeros((16, 32, 3))
    pixels[:, 0] = 1
    write_exr(tmp_path / "probe.exr", pixels)
    columns = load_probe(tmp_path / "probe.exr", "lat-long", 32).radiance[10, :, 0]
    np.testing.assert_allclose(columns[[0, 1]], columns[[1, 0]])
    assert columns[-1] == pytest.approx(columns[2])
    assert columns[-1] > 0.1
    assert columns.sum() == pytest.approx(2)


def test_hdr_and_exr_of_one_light_agree(tmp_path):
    pixels = lat_long(32).astype(np.float32)
    write_exr(tmp_path / "probe.exr", pixels)
    file = oiio.ImageOutput.create(str(tmp_path / "probe.hdr"))
    file.open(str(tmp_path / "probe.hdr"), oiio.ImageSpec(64, 32, 3, oiio.FLOAT))
    file.write_image(pixels)
    file.close()
    exr, hdr = (load_probe(tmp_path / f"probe.{e}", "lat-long", 32) for e in ("exr", "hdr"))
    # RGBE keeps eight bits of the largest channel.
    assert (np.abs(exr.radiance - hdr.radiance).max(axis=2) <= pixels.max(axis=2) / 128).all()


@pytest.mark.parametrize(("layout", "size"), [("angular-map", 100), ("vertical-cross", 32)])
def test_one_brilliant_pixel_keeps_its_energy(tmp_path, layout, size):
    if layout == "angular-map":
        pixels = np.zeros((size, size, 3))
        pixels[30, 70] = 1e5
        radius = np.hypot(*centres(size)[[30, 70]])
        solid_angle = np.pi**2 * np.sinc(radius) * (2 / size) ** 2
    else:
        pixels = np.zeros((4 * size, 3 * size, 3))
        pixels[size + 10, size + 20] = 1e5
        x, y = centres(size)[[10, 20]]
        solid_angle = (2 / size) ** 2 / (1 + x * x + y * y) ** 1.5
    write_exr(tmp_path / "probe.exr", pixels)
    light = load_probe(tmp_path / "probe.exr", layout, 40)
    np.testing.assert_allclose(energy(light), 1e5 * solid_angle, rtol=0.02)


def energy(light: Environment) -> np.ndarray:
    return np.einsum("rck,r->k", light.radiance, light.solid_angle)


@pytest.fixture(scope="module")
def probes(data):
    return {name: load_probe(data / "probes" / name, x, 180) for name, x in PROBES.items()}


def energy_of_the_source(path, layout) -> np.ndarray:
    """Sum of the probe's own pixels times their solid angles."""
    pixels = oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT).astype(float)
    if layout == "angular-map":
        radius = np.hypot(centres(len(pixels))[:, None], centres(len(pixels)))
        jacobian = np.pi**2 * np.sinc(np.minimum(radius, 1))
        solid_angle = jacobian * (2 / len(pixels)) ** 2 * (radius <= 1)
    else:
        size = pixels.shape[1] // 3
        square = 1 + centres(size)[:, None] ** 2 + centres(size) ** 2
        solid_angle = np.zeros(pixels.shape[:2])
        for row, column in FACES:
            face = slice(row * size, (row + 1) * size), slice(column * size, (column + 1) * size)
            solid_angle[face] = (2 / size) ** 2 / square**1.5
    return np.einsum("rck,rc->k", pixels, solid_angle)


@pytest.mark.parametrize(("name", "layout"), PROBES.items())
def test_real_probes_keep_their_energy(data, probes, name, layout):
    exact = energy_of_the_source(data / "probes" / name, layout)
    np.testing.assert_allclose(energy(probes[name]), exact, rtol=0.005)


def test_mean_radiance_does_not_depend_on_the_height(data, probes):
    name = "grace_probe.hdr"
    coarse = load_probe(data / "probes" / name, PROBES[name], 90)
    np.testing.assert_allclose(energy(coarse), energy(probes[name]), rtol=0.005)


def test_ennis_looks_out_of_its_window_and_stands_on_its_floor(probes):
    light = probes["ennis_probe.hdr"]
    ahead, back = light.lookup(np.array([[0.0, 0.05, -1.0], [0.0, 0.05, 1.0]])) @ LUMINANCE
    assert ahead > 20 * back
    # The floor is of reddish wood, brighter than the beams of the ceiling.
    floor, ceiling = (light.radiance[row, 120:200].mean(axis=0) for row in (138, 25))
    assert floor[0] > 2 * floor[2]
    assert floor @ LUMINANCE > 2 * (ceiling @ LUMINANCE)


def test_st_peters_has_no_seams(probes):
    level = np.log(probes["stpeters_cross.hdr"].radiance[70:110] @ LUMINANCE)
    steps = np.abs(np.diff(level, axis=1, append=level[:, :1])).mean(axis=0)
    seams = [44, 134, 224, 314]  # azimuths of -135, -45, 45 and 135 degrees
    assert max(steps[seams]) < np.quantile(steps, 0.95)


def picture(tmp_path, pixels, name="probe.exr"):
    write_exr(tmp_path / name, np.broadcast_to(pixels, (*np.shape(pixels)[:2], 3)))
    return tmp_path / name


def test_a_layout_that_does_not_exist(tmp_path):
    refused(
        picture(tmp_path, np.ones((4, 8, 1))),
        "spherical",
        "unknown layout 'spherical'",
    )


@pytest.mark.parametrize(
    ("shape", "layout", "message"),
    [
        ((8, 9, 1), "angular-map", "9 x 8 pixels.*angular-map are as 1 to 1"),
        ((8, 8, 1), "vertical-cross", "8 x 8 pixels.*vertical-cross are as 3 to 4"),
        ((8, 8, 1), "lat-long", "8 x 8 pixels.*lat-long are as 2 to 1"),
    ],
)
def test_wrong_proportions(tmp_path, shape, layout, message):
    refused(picture(tmp_path, np.ones(shape)), layout, message)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.nan, "3 values are NaN or infinite"),
        (np.inf, "3 values are NaN or infinite"),
        (-1.0, "3 values are negative"),
    ],
)
def test_values_that_no_light_has(tmp_path, value, message):
    pixels = np.ones((8, 8, 1))
    pixels[3, 4] = value
    refused(picture(tmp_path, pixels), "angular-map", message)


def test_a_black_probe_and_what_lies_outside_the_circle_does_not_count(tmp_path):
    pixels = np.zeros((16, 16, 1))
    pixels[0, 0] = pixels[15, 15] = 7.0
    refused(picture(tmp_path, pixels), "angular-map", "every pixel is black")


def test_what_is_not_a_picture_of_radiance(tmp_path):
    refused(tmp_path / "absent.hdr", "angular-map", "no such file")
    (tmp_path / "text.hdr").write_text("not a picture")
    refused(tmp_path / "text.hdr", "angular-map", "not an OpenEXR or HDR")
    Image.fromarray(np.ones((8, 8, 3), dtype=np.uint8)).save(tmp_path / "p.hdr", format="PNG")
    refused(tmp_path / "p.hdr", "angular-map", "not an OpenEXR or HDR")


def test_a_probe_that_is_cut_off(tmp_path):
    path = picture(tmp_path, np.random.default_rng(0).random((64, 64, 3)))
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    refused(path, "angular-map", "cut off")


def refused(path, layout, message):
    with pytest.raises(NpfmError, match=message) as caught:
        load_probe(path, layout, 16)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_result_is_an_environment_of_the_wanted_size(tmp_path):
    light = load_probe(picture(tmp_path, np.ones((9, 9, 1))), "angular-map", 10)
    assert isinstance(light, Environment)
    np.testing.assert_allclose(light.radiance, np.ones((10, 20, 3)), rtol=1e-6)
