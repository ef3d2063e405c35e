"""Our pictures against those of Mitsuba 3, which shares nothing with us but the table."""

import math

import numpy as np
import pytest

from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
from npfm.rendering.assembly import build
from npfm.rendering.lights.environment import Environment, tabulate
from npfm.rendering.scenes import CAMERA, Scene
from npfm.rendering.transport import render

mitsuba = pytest.importorskip("mitsuba", reason="the referee needs pip install npfm[mitsuba]")

RESOLUTION = 16
#: Independent renderings by the referee, from which its noise is known, and rays a pixel in each.
RENDERINGS, SAMPLES = 64, 40
ROWS, COLUMNS = 256, 512


def light(direction):
    """A sky, a large warm lamp ahead and a small blue one behind, all smooth."""
    x, y, z = np.moveaxis(direction, -1, 0)
    warm = np.exp(12 * (0.48 * x + 0.6 * y - 0.64 * z - 1))
    blue = np.exp(40 * (-0.6 * x + 0.64 * y + 0.48 * z - 1))
    return np.stack(
        [0.2 + 3 * warm + blue, 0.2 + 0.1 * y + 2 * warm + 2 * blue, 0.3 + warm + 6 * blue], axis=-1
    )


def glossy_table():
    """A lobe of 0.2 rad with a coloured Fresnel term and a dependence on phi_d, on a base."""
    theta_h, theta_d, phi_d = np.meshgrid(MERL.theta_h, MERL.theta_d, MERL.phi_d, indexing="ij")
    lobe = np.exp(-((theta_h / 0.2) ** 2)) * (1 + 0.5 * np.cos(2 * phi_d))
    fresnel = np.array([0.3, 0.1, 0.05])[:, None, None, None] + (1 - np.cos(theta_d)) ** 5
    return Table(0.1 + 2 * fresnel * lobe)


def merl_lookup(light, view):
    """Indices of a pair of directions, along the lines of BRDFRead.cpp: rotate, then bin."""
    half = [a + b for a, b in zip(light, view, strict=True)]
    length = math.sqrt(sum(a * a for a in half))
    half = [a / length for a in half]
    theta_h, phi_h = math.acos(min(half[2], 1.0)), math.atan2(half[1], half[0])
    c, s = math.cos(-phi_h), math.sin(-phi_h)
    x, y, z = c * light[0] - s * light[1], s * light[0] + c * light[1], light[2]
    c, s = math.cos(-theta_h), math.sin(-theta_h)
    x, z = c * x + s * z, c * z - s * x
    theta_d, phi_d = math.acos(max(-1.0, min(z, 1.0))), math.atan2(y, x)
    phi_d += math.pi if phi_d < 0 else 0.0
    return (
        min(int(math.sqrt(theta_h / (math.pi / 2)) * 90), 89),
        min(int(theta_d / (math.pi / 2) * 90), 89),
        min(int(phi_d / math.pi * 180), 179),
    )


def table_bsdf(values):
    """A BSDF class that looks reflectance up in `values` (3, 90, 90, 180) without interpolation."""
    mi = mitsuba

    class TableBSDF(mi.BSDF):
        def __init__(self, properties):
            mi.BSDF.__init__(self, properties)
            self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0]

        def sample(self, context, si, sample1, sample2, active):
            result = mi.BSDFSample3f()
            result.wo = mi.warp.square_to_cosine_hemisphere(sample2)
            result.pdf = self.pdf(context, si, result.wo, active)
            result.eta = 1.0
            result.sampled_type = int(self.m_flags)
            value = self.eval(context, si, result.wo, active)
            return result, value / result.pdf if result.pdf > 0 else value

        def eval(self, context, si, wo, active):
            if si.wi.z <= 0 or wo.z <= 0:
                return mi.Color3f(0)
            cell = merl_lookup([wo.x, wo.y, wo.z], [si.wi.x, si.wi.y, si.wi.z])
            return mi.Color3f(*(float(plane[cell]) * wo.z for plane in values))

        def pdf(self, context, si, wo, active):
            if si.wi.z <= 0 or wo.z <= 0:
                return 0.0
            return mi.warp.square_to_cosine_hemisphere_pdf(wo)

        def eval_pdf(self, context, si, wo, active):
            return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)

        def to_string(self):
            return "TableBSDF[]"

    return TableBSDF


def referee_light():
    """`light` at the points between which Mitsuba interpolates its map.

    Its rows reach from pole to pole; its first column is centred half a texel right of -z.
    """
    theta = np.arange(ROWS) * np.pi / (ROWS - 1)
    azimuth = (np.arange(COLUMNS) + 0.5) * 2 * np.pi / COLUMNS
    sine = np.sin(theta)[:, None]
    return light(
        np.stack(
            np.broadcast_arrays(
                sine * np.sin(azimuth), np.cos(theta)[:, None], -sine * np.cos(azimuth)
            ),
            axis=-1,
        )
    )


def referee(values):
    """Mean and standard error of the pixels of Mitsuba's picture, each (16, 16, 3)."""
    mi = mitsuba
    mi.set_variant("scalar_rgb")
    mi.register_bsdf("table", table_bsdf(values))
    from_camera = mi.ScalarTransform4f().look_at([0, 0, CAMERA.distance], [0, 0, 0], [0, 1, 0])
    film = {
        "type": "hdrfilm",
        "width": RESOLUTION,
        "height": RESOLUTION,
        "rfilter": {"type": "box"},
        "pixel_format": "rgb",
        "component_format": "float32",
    }
    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "sensor": {
                "type": "perspective",
                "fov": math.degrees(CAMERA.field),
                "to_world": from_camera,
                "film": film,
                "sampler": {"type": "independent"},
            },
            "light": {"type": "envmap", "bitmap": mi.Bitmap(referee_light().astype(np.float32))},
            "sphere": {"type": "sphere", "bsdf": {"type": "table"}},
        }
    )
    pictures = [np.array(mi.render(scene, spp=SAMPLES, seed=n)) for n in range(RENDERINGS)]
    pictures = np.array(pictures, dtype=float)
    return pictures.mean(axis=0), pictures.std(axis=0, ddof=1) / math.sqrt(RENDERINGS)


def test_agrees_with_mitsuba():
    table = glossy_table()
    expected, error = referee(table.values)
    # Mitsuba spreads its rays over the whole pixel: so do 16 x 16 of ours, in four pixels squared.
    environment = Environment(tabulate(light, ROWS, 2))
    fine = build(Scene(("sphere",), ("antialiasing",)), environment, MERL, 4 * RESOLUTION, 1024, 3)
    blocks = (RESOLUTION, 4, RESOLUTION, 4)
    inside = fine.foreground.reshape(blocks).all(axis=(1, 3))
    picture = render(fine, table)[..., :3].reshape(*blocks, 3).mean(axis=(1, 3))

    difference, error = (picture - expected)[inside], error[inside]
    assert inside.sum() > 100
    assert np.median(error / expected[inside]) < 0.02
    assert (np.abs(difference) <= 3 * error).mean() >= 0.99
    np.testing.assert_allclose(
        picture[inside].mean(axis=0), expected[inside].mean(axis=0), rtol=0.01
    )
