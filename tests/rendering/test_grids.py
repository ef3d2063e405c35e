"""Other kinds of grids than half-difference: from a table to a picture and through files.

Beside the directional grid, two small ones stand here for any: one of bins, and one that
interpolates and needs a tangent.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import pytest

from npfm.errors import NpfmError
from npfm.fitting import fits
from npfm.reflectance import grids
from npfm.reflectance.angles import half_difference
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import Table
from npfm.rendering import surfaces, transport
from npfm.rendering.assembly import build
from npfm.rendering.geometry import nearest
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import CAMERA, Scene, place

WHITE = Environment(np.ones((8, 16, 3)))
LIGHT = Environment(np.random.default_rng(2).random((8, 16, 3)) ** 3)
SPHERE, BOTH = Scene(("sphere",)), Scene(("figure", "sphere"), ("visibility", "antialiasing"))


class Whole:
    """What both grids have in common: tables without empty cells, and even bins of theta_h."""

    @property
    def size(self):
        return int(np.prod(self.shape))

    @property
    def name(self):
        return f"{self.kind} " + "x".join(map(str, self.shape))

    @property
    def above_horizon(self):
        return np.ones(self.shape, dtype=bool)

    @cached_property
    def theta_h_edges(self):
        return np.linspace(0, np.pi / 2, 31)

    def theta_h_bin(self, theta_h):
        return np.minimum((theta_h * 60 / np.pi).astype(int), 29)

    @property
    def column_count(self):
        return self.size

    def columns(self, light, view, point):
        return self.cells(light, view, point)

    def column_values(self, values):
        return np.maximum(values, 0).reshape(3, -1)


@dataclass(frozen=True)
class Elevations(Whole):
    """Bins of theta_i, theta_o and the difference of the azimuths, no smaller than pi."""

    kind: ClassVar[str] = "elevations"
    anisotropic: ClassVar[bool] = False

    theta_i_bins: int
    theta_o_bins: int
    phi_bins: int

    @property
    def shape(self):
        return self.theta_i_bins, self.theta_o_bins, self.phi_bins

    @property
    def centres(self):
        theta_i, theta_o, phi = (
            (np.arange(bins) + 0.5) / bins * size
            for bins, size in zip(self.shape, (np.pi / 2, np.pi / 2, np.pi), strict=True)
        )
        return np.meshgrid(theta_i, theta_o, phi, indexing="ij")

    def axes(self, normal, view, tangent):
        return normal, view, np.cross(normal, view)

    def cells(self, light, view, point):
        cos_i, cos_io, volume = light.T
        cos_o = np.minimum(view[point, 0], 1)
        phi = np.abs(np.arctan2(volume, cos_io - cos_i * cos_o))
        parts = (
            np.arccos(np.minimum(cos_i, 1)) * 2 / np.pi,
            np.arccos(cos_o) * 2 / np.pi,
            phi / np.pi,
        )
        bins = [
            np.minimum((part * count).astype(int), count - 1)
            for part, count in zip(parts, self.shape, strict=True)
        ]
        return np.ravel_multi_index(bins, self.shape).astype(np.int32), None


@dataclass(frozen=True)
class Azimuths(Whole):
    """Values at azimuths of the light from the tangent, linear and periodic between them."""

    kind: ClassVar[str] = "azimuths"
    anisotropic: ClassVar[bool] = True

    phi_bins: int

    @property
    def shape(self):
        return (self.phi_bins,)

    def axes(self, normal, view, tangent):
        return normal, tangent, np.cross(normal, tangent)

    def cells(self, light, view, point):
        place = np.arctan2(light[:, 2], light[:, 1]) % (2 * np.pi) * self.phi_bins / (2 * np.pi)
        low = np.floor(place).astype(np.int32)
        share = place - low
        index = np.stack([low, low + 1], axis=-1) % self.phi_bins
        return index.astype(np.int32), np.stack([1 - share, share], axis=-1)


GRIDS = [Elevations(9, 10, 12), Azimuths(16), Directional(4, 12, 4, 12)]


@pytest.fixture(autouse=True)
def kinds(monkeypatch):
    for kind in (Elevations, Azimuths):
        monkeypatch.setitem(grids.KINDS, kind.kind, kind)


@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("scene", [SPHERE, BOTH])
def test_white_furnace(grid, scene):
    built = build(Scene(scene.objects), WHITE, grid, 16, 2048, 0)
    white = Table(np.full((3, *grid.shape), 1 / np.pi), grid)
    values = transport.render(built, white)[built.foreground][:, :3]
    assert len(values) > 20
    assert values.mean() == pytest.approx(1, abs=0.003)
    np.testing.assert_allclose(values, 1, atol=0.02)


def test_an_isotropic_material_looks_the_same_on_either_grid():
    """One without a highlight, so that the bins of neither are too wide for it."""
    fine, usual = Elevations(45, 45, 60), HalfDifference(45, 45, 90)
    theta_i, theta_o, phi = fine.centres
    between = np.cos(theta_i) * np.cos(theta_o) + np.sin(theta_i) * np.sin(theta_o) * np.cos(phi)
    squared = np.broadcast_to(np.cos(usual.theta_d[:, None]) ** 2, usual.shape)
    pictures = []
    for grid, cos_d2 in ((fine, (1 + between) / 2), (usual, squared)):
        built = build(SPHERE, LIGHT, grid, 16, 16384, 0)
        table = Table(np.stack([0.1 + 0.3 * cos_d2] * 3), grid)
        pictures.append(transport.render(built, table)[built.foreground])
    one, other = pictures
    np.testing.assert_allclose(one, other, rtol=0.03)
    assert one.mean() == pytest.approx(other.mean(), rel=2e-3)


def test_anisotropic_reflection_follows_the_tangent():
    """A pixel against a lattice of directions, about the meridian through it."""
    grid, resolution = Azimuths(16), 15
    table = Table(np.random.default_rng(6).random((3, 16)), grid)
    built = build(SPHERE, LIGHT, grid, resolution, 16384, 0)
    picture = transport.render(built, table)
    for row, column in [(7, 9), (3, 9), (12, 4)]:
        pixel = np.array([row * resolution + column])
        ray = CAMERA.directions(pixel, np.array([[0.5, 0.5]]), resolution)[0]
        normal = nearest(place(SPHERE), CAMERA.position[None], ray).shading[0]
        right = np.cross([0, 1, 0], normal)
        right /= np.linalg.norm(right)
        along = np.cross(normal, right)
        assert along[1] > 0
        z, phi = np.meshgrid((np.arange(200) + 0.5) / 200, (np.arange(800) + 0.5) * np.pi / 400)
        # Azimuths run from the tangent to normal x tangent, which is to the left.
        local = np.sqrt(1 - z**2) * np.array([np.cos(phi), -np.sin(phi)])
        light = np.einsum("krc,kx->rcx", np.array([*local, z]), np.array([along, right, normal]))
        nodes = np.arange(17) * np.pi / 8
        for channel, values in enumerate(table.values):
            brdf = np.interp(phi, nodes, np.append(values, values[0]))
            expected = (LIGHT.lookup(light)[..., channel] * brdf * z).mean() * 2 * np.pi
            assert picture[row, column, channel] == pytest.approx(expected, rel=0.01)


def brushed(light, view):
    """Lambert, and GGX without shadowing, four times as rough along y as along x."""
    half = light + view
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    x, y, z = np.moveaxis(half, -1, 0)
    return 0.5 + 1 / (1 + (x / 0.2) ** 2 / z**2 + (y / 0.8) ** 2 / z**2) ** 2 / z**4


def test_a_pixel_of_the_directional_grid_is_the_sum_of_its_lookups():
    """Against lookups along a lattice of directions, in the frame of the meridian."""
    light, view = np.broadcast_arrays(UTIA.light[:, :, None, None], UTIA.view)
    table = Table(brushed(light, view) * np.array([1, 0.5, 2]).reshape(3, 1, 1, 1, 1), UTIA)
    resolution = 15
    picture = transport.render(build(SPHERE, LIGHT, UTIA, resolution, 16384, 0), table)
    z, phi = np.meshgrid((np.arange(200) + 0.5) / 200, (np.arange(400) + 0.5) * np.pi / 200)
    local = np.stack([*(np.sqrt(1 - z**2) * [np.cos(phi), np.sin(phi)]), z], axis=-1)
    for row, column in [(7, 9), (3, 9), (12, 4)]:
        pixel = np.array([row * resolution + column])
        ray = CAMERA.directions(pixel, np.array([[0.5, 0.5]]), resolution)[0]
        normal = nearest(place(SPHERE), CAMERA.position[None], ray).shading[0]
        left = np.cross(normal, [0, 1, 0])
        left /= np.linalg.norm(left)
        frame = np.stack([np.cross(left, normal), left, normal])
        assert frame[0, 1] > 0
        view = np.broadcast_to(-frame @ ray[0], local.reshape(-1, 3).shape)
        brdf = table.lookup(local.reshape(-1, 3), view).reshape(3, *z.shape)
        radiance = LIGHT.lookup(local @ frame)
        expected = (radiance * np.moveaxis(brdf, 0, -1) * z[..., None]).mean((0, 1)) * 2 * np.pi
        np.testing.assert_allclose(picture[row, column, :3], expected, rtol=0.015)


def test_only_anisotropic_grids_pay_for_tangents(monkeypatch):
    def forbidden(normal):
        raise AssertionError("a tangent was asked for")

    monkeypatch.setattr(surfaces, "meridians", forbidden)
    build(SPHERE, WHITE, HalfDifference(9, 9, 18), 8, 16, 0)
    build(SPHERE, WHITE, Elevations(9, 10, 12), 8, 16, 0)
    with pytest.raises(AssertionError, match="a tangent was asked for"):
        build(SPHERE, WHITE, Azimuths(16), 8, 16, 0)


def test_meridians_are_unit_tangents_that_point_upwards():
    normal = np.random.default_rng(0).normal(size=(200, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    normal[:2] = [[0, 1, 0], [0, -1, 0]]
    tangent = surfaces.meridians(normal)
    np.testing.assert_allclose(np.linalg.norm(tangent, axis=1), 1)
    np.testing.assert_allclose(np.einsum("ij,ij->i", tangent, normal), 0, atol=1e-12)
    assert (tangent[2:, 1] > 0).all()
    np.testing.assert_allclose(tangent[:2], [[0, 0, -1]] * 2)


@pytest.mark.parametrize("grid", [*GRIDS, HalfDifference(4, 5, 6)])
def test_files_carry_kind_and_shape(grid, tmp_path):
    transport.save(tmp_path / "scene", build(SPHERE, WHITE, grid, 8, 16, 0))
    assert transport.load(tmp_path / "scene").grid == grid
    arrays = {"B": np.ones((3, 2), dtype=np.float32)}
    fits.save(tmp_path / "fit.npz", fits.Fit("bivariate", arrays, grid))
    assert fits.load(tmp_path / "fit.npz").grid == grid
    stored = np.load(tmp_path / "fit.npz").files
    assert ("grid_kind" in stored) == (grid.kind != "half-difference")


def test_a_table_on_another_kind_of_grid_is_refused():
    one = Elevations(4, 5, 6)
    built = build(SPHERE, WHITE, one, 8, 16, 0)
    other = HalfDifference(4, 5, 6)
    with pytest.raises(NpfmError, match=r"half-difference 4x5x6.*built for elevations 4x5x6"):
        transport.render(built, Table(np.ones((3, 4, 5, 6)), other))


@pytest.mark.parametrize(
    ("kind", "shape", "said"),
    [
        ("half-diference", (9, 9, 18), "unknown kind of grid.*did you mean half-difference"),
        ("half-difference", (9, 9), "does not have 2 axes"),
        ("half-difference", (9, 9, 18, 3), "does not have 4 axes"),
        ("azimuths", (9, 9), "does not have 2 axes"),
        ("directional", (6, 48), "does not have 2 axes"),
    ],
)
def test_a_grid_that_there_is_not_is_refused(kind, shape, said):
    with pytest.raises(NpfmError, match=said):
        grids.named(kind, shape)


def random_directions(count=500):
    light, view = np.random.default_rng(1).normal(size=(2, count, 3))
    for direction in (light, view):
        direction[:, 2] = np.abs(direction[:, 2])
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return light, view


def test_tables_are_looked_up_by_direction():
    light, view = random_directions()
    grid = HalfDifference(18, 18, 36)
    values = np.random.default_rng(3).random((3, *grid.shape)) - 0.1
    expected = np.maximum(values, 0).reshape(3, -1)[:, grid.cell(*half_difference(light, view))]
    np.testing.assert_array_equal(Table(values, grid).lookup(light, view), expected)
    table = Table(np.random.default_rng(3).random((3, 16)), Azimuths(16))
    phi = np.arctan2(light[:, 1], light[:, 0])
    for channel, found in enumerate(table.lookup(light, view)):
        periodic = np.interp(
            phi, np.arange(16) * np.pi / 8, table.values[channel], period=2 * np.pi
        )
        np.testing.assert_allclose(found, periodic)


@pytest.mark.parametrize("grid", GRIDS)
def test_every_strategy_of_scenes_serves_other_grids(grid):
    white = Table(np.full((3, *grid.shape), 1 / np.pi), grid)
    for name in registry.for_any_material():
        strategies = registry.make([name, "cosine"][: 1 + (name != "cosine")], Given(WHITE, grid))
        built = build(SPHERE, WHITE, grid, 8, 4096, 0, strategies)
        values = transport.render(built, white)[built.foreground][:, :3]
        assert values.mean() == pytest.approx(1, abs=0.01)
