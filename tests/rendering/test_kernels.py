"""Compiled passes against what defines them: strategies, grids and sums, in array operations."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_array

from npfm.reflectance.directional import Directional
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.rendering import fused, kernels, row_sums
from npfm.rendering.assembly import build
from npfm.rendering.directions import Combined, unit_square
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling.half_vector import HalfVectorSampling
from npfm.rendering.sampling.light import LightSampling
from npfm.rendering.scenes import CAMERA, Scene, camera_offsets, place
from npfm.rendering.surfaces import look

SCENES = [
    Scene(("sphere",)),
    Scene(("figure", "sphere"), ("visibility", "antialiasing")),
]
GRIDS = [MERL, HalfDifference(18, 7, 12), Directional(4, 12, 5, 8)]


def light(rows=16, dark=0.3):
    """Texels of all brightnesses, a part of them black, and a row too."""
    rng = np.random.default_rng(3)
    radiance = rng.random((rows, 2 * rows, 3)) ** 6
    radiance[rng.random(radiance.shape[:2]) < dark] = 0
    radiance[rows // 3] = 0
    radiance[rows // 4, 5] = 300
    return Environment(radiance)


def surface(scene, environment, grid, resolution=9):
    offsets = camera_offsets(scene)
    return look(CAMERA, place(scene), environment, offsets, resolution, tangents=grid.anisotropic)[
        0
    ], len(offsets)


@pytest.fixture(params=GRIDS, ids=lambda grid: grid.name)
def grid(request):
    return request.param


@pytest.mark.parametrize("scene", SCENES)
def test_the_fused_pass_draws_what_the_strategies_draw(scene, grid):
    environment = light()
    strategies = LightSampling(environment), HalfVectorSampling(grid)
    assert fused.serves(environment, strategies, 1)
    points, rays = surface(scene, environment, grid)
    count = np.random.default_rng(1).choice([4, 8, 600], size=len(points))
    shifts = np.random.default_rng(2).random((2, 81, 2))
    general = Combined(environment, strategies, 1, rays, shifts)(points, count)
    drawn = fused.Fused(environment, strategies, rays, shifts, np.unique(count))(points, count)
    np.testing.assert_array_equal(np.sort(drawn.point), drawn.point)
    # In a point they come in another order.
    ours, others = (in_order(each) for each in (drawn, general))
    np.testing.assert_array_equal(ours.point, others.point)
    np.testing.assert_array_equal(ours.texel, others.texel)
    np.testing.assert_allclose(ours.vectors, others.vectors, atol=1e-10)
    np.testing.assert_allclose(ours.weight, others.weight, rtol=1e-7)
    assert len(ours.weight) > count.sum() / 2


def in_order(drawn):
    return drawn[np.lexsort((drawn.vectors[0].round(9), drawn.vectors[1].round(9), drawn.point))]


def test_other_strategies_are_not_taken_for_those_of_the_pass():
    environment, other = light(), light()
    pair = LightSampling(environment), HalfVectorSampling(MERL)

    class Another(LightSampling):
        pass

    assert not fused.serves(environment, pair, 2)
    assert not fused.serves(environment, pair[::-1], 1)
    assert not fused.serves(environment, pair[:1], 1)
    assert not fused.serves(environment, (Another(environment), pair[1]), 1)
    assert not fused.serves(other, pair, 1)


class Slow(LightSampling):
    """The same strategy, for which there is no pass."""


@pytest.mark.parametrize("scene", SCENES)
def test_matrices_are_those_of_array_operations(scene, grid, monkeypatch):
    """All of it: by another way of drawing, of finding columns and of adding them up."""
    environment = light()
    quick = build(scene, environment, grid, 12, 256, 4)
    monkeypatch.setattr(row_sums, "row_sums", sums_by_scipy)
    monkeypatch.setattr(kernels, "half_difference_cells", cells_by_grid(grid))
    strategies = Slow(environment), HalfVectorSampling(grid)
    slow = build(scene, environment, grid, 12, 256, 4, strategies)
    for name in ("indptr", "indices", "coverage", "backdrop"):
        np.testing.assert_array_equal(getattr(quick, name), getattr(slow, name))
    np.testing.assert_allclose(quick.weights, slow.weights, rtol=1e-6, atol=1e-12)
    assert quick.indices.size > 1000


def cells_by_grid(grid):
    def cells(vectors, point, normal, view, across, shape):
        axes = normal, view, across
        along = np.stack([(axis[point] * vectors.T).sum(axis=1) for axis in axes], axis=-1)
        seen = np.stack([(axis * view).sum(axis=1) for axis in axes], axis=-1)
        return grid.cells(along, seen, point)[0]

    return cells


def sums_by_scipy(ends, column, share, texel, weight, radiance, bits):
    """As `row_sums`, in double precision to the end."""
    row = np.repeat(np.arange(len(ends)), np.diff(ends, prepend=0))
    row = np.repeat(row, column.shape[1])
    share = share if share.size else np.ones(column.shape)
    value = radiance[texel].T[:, :, None] * weight[:, None] * share
    # A sum that is 0 has its place all the same.
    sums = []
    for channel in (*value, np.ones(column.shape)):
        matrix = coo_array((channel.ravel(), (row, column.ravel())), shape=(len(ends), 1 << bits))
        matrix.sum_duplicates()
        sums.append(matrix.data)
    entries = np.bincount(matrix.coords[0], minlength=len(ends))
    order = np.lexsort((matrix.coords[1], matrix.coords[0]))
    sums = np.stack(sums[:3])[:, order].astype(np.float32)
    return entries, matrix.coords[1][order].astype(np.int32), sums


def test_rows_are_summed_by_column_whatever_their_lengths():
    rng = np.random.default_rng(0)
    ends = np.cumsum([0, 1, 700, 0, 30])
    for columns, taps in ((5, 1), (2000, 3), (1 << 23, 2)):
        column = rng.integers(0, columns, (ends[-1], taps)).astype(np.int32)
        share, weight = rng.random(column.shape), rng.random(ends[-1])
        texel = rng.integers(0, 9, ends[-1]).astype(np.int32)
        given = (ends, column, share, texel, weight, rng.random((9, 3)), columns.bit_length())
        found, expected = row_sums.row_sums(*given), sums_by_scipy(*given)
        for ours, other in zip(found, expected, strict=True):
            np.testing.assert_allclose(ours, other, rtol=1e-6)


def test_highlights_show_the_mean_of_what_half_vectors_mirror(grid):
    environment = light()
    points, _ = surface(SCENES[0], environment, grid)
    square = unit_square(1, 64)[0] * [0.2, 1.0]
    strategy = HalfVectorSampling(grid)
    mirrored = strategy.sample(np.broadcast_to(square, (len(points), *square.shape)), points)
    expected = (environment.lookup(mirrored) @ [0.2126, 0.7152, 0.0722]).mean(axis=1)
    found = fused.highlights(points, square, environment, grid)
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_series_are_those_of_the_library():
    """Over all they are asked for, the ends and axes included."""
    angles = np.concatenate([np.linspace(-np.pi, np.pi, 1001), np.arange(-2, 3) * np.pi / 2])
    for angle in angles:
        sine, cosine = kernels._sin_cos(angle)
        assert sine == pytest.approx(math.sin(angle), abs=2e-14)
        assert cosine == pytest.approx(math.cos(angle), abs=2e-14)
        for length in (1e-200, 1.0, 1e200):
            found = kernels._arctan2(length * math.sin(angle), length * math.cos(angle))
            turn = abs(found - math.atan2(math.sin(angle), math.cos(angle)))
            assert min(turn, 2 * math.pi - turn) < 2e-14
    assert kernels._arctan2(0.0, 0.0) == 0
    for cosine in np.linspace(-1, 1, 501):
        assert kernels._arccos(cosine) == pytest.approx(math.acos(cosine), rel=1e-12)


@pytest.mark.parametrize("module", [kernels, row_sums], ids=lambda module: module.__name__)
def test_kernels_call_nothing_of_other_files(module):
    """Numba would not notice a change there."""
    source = Path(module.__file__).read_text()
    imported = [
        line for line in source.splitlines() if line.startswith(("from npfm", "import npfm"))
    ]
    assert imported == ["from npfm.compilation import ARITHMETIC, compiled, inner"]
