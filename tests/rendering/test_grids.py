"""Other kinds of grids than half-difference: from a table to a picture and through files.

Beside the directional grid, two small ones stand here for any: one of bins, and one that
interpolates and needs a tangent.
"""

from dataclasses import dataclass, replace
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
from npfm.rendering import geometry, surfaces, transport
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
    z, phi = np.meshgrid((np.arange(150) + 0.5) / 150, (np.arange(300) + 0.5) * np.pi / 150)
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
    """Neither for the tangents nor for the directions that they follow, on any object."""
    asked = []
    monkeypatch.setattr(surfaces, "across", lambda along, normal: asked.append(1) or along)
    monkeypatch.setattr(geometry, "_upwards", lambda normals: asked.append(2) or normals)
    scene = Scene(("figure", "sphere", "cloth"))
    for grid in (HalfDifference(9, 9, 18), Elevations(9, 10, 12)):
        build(scene, WHITE, grid, 8, 16, 0)
    assert not asked
    build(scene, WHITE, Azimuths(16), 8, 16, 0)
    assert set(asked) == {1, 2}


def unit(count=200, seed=0):
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_tangents_are_as_near_to_a_direction_as_the_surface_allows():
    normal, along = unit(seed=0), 3 * unit(seed=1)
    normal[:3] = [[0, 1, 0], [0, -1, 0], [0, 0, 1]]
    along[:3] = [[0, 2, 0], [0, 1, 0], [0, 0, -1]]
    tangent = surfaces.across(along, normal)
    np.testing.assert_allclose(np.linalg.norm(tangent, axis=1), 1)
    np.testing.assert_allclose(np.einsum("ij,ij->i", tangent, normal), 0, atol=1e-12)
    np.testing.assert_allclose(tangent[:3], [[0, 0, -1], [0, 0, -1], [1, 0, 0]], atol=1e-12)
    for other in (unit(seed=k) for k in range(2, 12)):
        flat = other - np.einsum("ij,ij->i", other, normal)[:, None] * normal
        flat /= np.linalg.norm(flat, axis=1, keepdims=True)
        nearness = [np.einsum("ij,ij->i", t, along)[3:] for t in (tangent, flat)]
        assert (nearness[0] >= nearness[1] - 1e-12).all()


@pytest.mark.parametrize("name", ["sphere", "figure", "cloth"])
def test_every_object_has_tangents_that_hang_together(name):
    """From pixel to pixel they turn no more than the surface does, but for its ends."""
    objects = place(Scene((name,)))
    offsets, side = np.array([[0.5, 0.5]]), 128
    surface, _, _ = surfaces.look(CAMERA, objects, WHITE, offsets, side, tangents=True)
    np.testing.assert_allclose(np.linalg.norm(surface.tangent, axis=1), 1, rtol=1e-6)
    dots = np.einsum("ij,ij->i", surface.tangent, surface.normal)
    np.testing.assert_allclose(dots, 0, atol=1e-6)
    field = np.full((side, side, 2, 3), np.nan)
    field.reshape(-1, 2, 3)[surface.pixel] = np.stack([surface.tangent, surface.normal], axis=1)
    cosines = np.einsum("rckx,rckx->rck", field[:, 1:], field[:, :-1])
    tangent, normal = np.degrees(np.arccos(np.minimum(np.moveaxis(cosines, -1, 0), 1)))
    # Where the normals of neighbours are farther apart, one thing is before another.
    beside = normal < 25
    assert beside.sum() > 2000
    apart = (tangent - normal)[beside]
    # One part of the knot may be before another that faces the same way.
    assert np.mean(apart > 5) < 0.03


def test_a_mesh_without_threads_is_brushed_upwards_as_far_as_its_surface_goes():
    """As a mesh of the user's is; continuous but where the surface faces up or down."""
    (figure,) = place(Scene(("figure",)))
    plain = replace(figure, threads=None)
    centre = np.array([[0.5, 0.5]])
    surface, _, _ = surfaces.look(CAMERA, (plain,), WHITE, centre, 64, tangents=True)
    up = np.broadcast_to([0.0, 1.0, 0.0], surface.normal.shape)
    np.testing.assert_allclose(surface.tangent, surfaces.across(up, surface.normal), atol=1e-12)
    assert (surface.tangent[:, 1] > 0).all()
    own, _, _ = surfaces.look(CAMERA, (figure,), WHITE, centre, 64, tangents=True)
    assert not np.allclose(own.tangent, surface.tangent)


def test_the_cloth_has_the_directions_of_its_threads():
    (cloth,) = place(Scene(("cloth",)))
    surface, _, _ = surfaces.look(
        CAMERA, (cloth,), WHITE, np.array([[0.5, 0.5]]), 32, tangents=True
    )
    # Threads run along lines of equal u: two neighbours on one differ by a tangent.
    lattice = cloth.vertices.reshape(241, 241, 3)
    steps = np.diff(lattice, axis=0)
    steps /= np.linalg.norm(steps, axis=-1, keepdims=True)
    middles = ((lattice[1:] + lattice[:-1]) / 2).reshape(-1, 3)
    nearest_step = np.argmin(
        np.linalg.norm(surface.position[:, None, :2] - middles[None, ::7, :2], axis=-1), axis=1
    )
    expected = steps.reshape(-1, 3)[::7][nearest_step]
    assert np.einsum("ij,ij->i", surface.tangent, expected).min() > 0.98
    # Which the y axis would not give: the threads spread with the folds.
    assert np.abs(surface.tangent[:, 0]).max() > 0.03


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
    ("words", "grid"),
    [
        ("half-difference", HalfDifference()),
        ("directional", UTIA),
        ("directional 12x96x9x36", Directional(12, 96, 9, 36)),
        ("half-difference 9x9x18", HalfDifference(9, 9, 18)),
    ],
)
def test_grids_are_named_by_kind_and_shape(words, grid):
    assert grids.parse(words.split()) == grid
    assert grids.parse(grid.name.split()) == grid


@pytest.mark.parametrize(
    "words",
    [
        "directional 6x48",
        "directional 6x48x6x0",
        "directional 6x48x6x-48",
        "directional 6x48x6x48x",
        "directional 6 48 6 48",
        "directional ²x48x6x48",
        "directional 999x999x999x999",
        "directonal",
        "directional 1e9x1x1x1",
    ],
)
def test_words_that_name_no_grid_are_refused_in_one_line(words):
    with pytest.raises(NpfmError) as error:
        grids.parse(words.split())
    assert "\n" not in str(error.value)


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


def isotropic(between):
    """A BRDF without a highlight, of the cosine of the angle between light and view."""
    return 0.1 + 0.15 * (1 + between)


def test_an_isotropic_material_differs_by_what_interpolation_and_bins_allow():
    """The bound is that of linear interpolation, h^2 / 8 of the second derivative in each angle.

    No second derivative of the cosine between two directions by one of their angles is above 1.
    Beyond the last theta a line goes wrong by h * 2h / 2 of it at most. A half-difference cell
    stands for its centre: half a bin of theta_d, the cosine of which moves by less than twice that.
    """
    usual = HalfDifference(45, 45, 90)
    cos_d2 = np.broadcast_to(np.cos(usual.theta_d[:, None]) ** 2, usual.shape)
    cells = Table(np.stack([isotropic(2 * cos_d2 - 1)] * 3), usual)
    reference = transport.render(build(SPHERE, LIGHT, usual, 8, 8192, 0), cells)
    errors = {}
    for grid in (UTIA, Directional(12, 96, 12, 96)):
        between = np.einsum("abx,cdx->abcd", grid.light, grid.view)
        built = build(SPHERE, LIGHT, grid, 8, 8192, 0)
        picture = transport.render(built, Table(np.stack([isotropic(between)] * 3), grid))
        white = transport.render(built, Table(np.ones((3, *grid.shape)), grid))
        theta, phi = np.pi / 2 / grid.theta_i_count, 2 * np.pi / grid.phi_i_count
        bound = 0.15 * 2 * (theta**2 / 8 + phi**2 / 8 + theta**2)
        bound += 0.15 * 2 * np.pi / 4 / usual.theta_d_bins
        shown = built.foreground
        off = np.abs(picture - reference)[shown][:, :3]
        # Two per cent of the value for the samples, which are not the same for the two matrices.
        assert (off <= bound * white[shown][:, :3] + 0.02 * reference[shown][:, :3]).all()
        errors[grid] = table_error(grid)
    usual_error, fine_error = errors.values()
    # A fourth of the error, 12 dB, for half the step.
    assert 20 * np.log10(usual_error / fine_error) == pytest.approx(12, abs=0.5)


def table_error(grid):
    """Root mean square error of lookups of the isotropic BRDF, none of them extrapolated."""
    light, view = random_directions(4000)
    inside = np.minimum(light[:, 2], view[:, 2]) > np.cos(np.radians(75))
    light, view = light[inside], view[inside]
    between = np.einsum("abx,cdx->abcd", grid.light, grid.view)
    found = Table(np.stack([isotropic(between)] * 3), grid).lookup(light, view)
    return np.sqrt(np.mean((found - isotropic(np.einsum("ij,ij->i", light, view))) ** 2))


@pytest.mark.parametrize("grid", GRIDS)
def test_every_strategy_of_scenes_serves_other_grids(grid):
    white = Table(np.full((3, *grid.shape), 1 / np.pi), grid)
    for name in registry.for_any_material():
        strategies = registry.make([name, "cosine"][: 1 + (name != "cosine")], Given(WHITE, grid))
        built = build(SPHERE, WHITE, grid, 8, 4096, 0, strategies)
        values = transport.render(built, white)[built.foreground][:, :3]
        assert values.mean() == pytest.approx(1, abs=0.01)
