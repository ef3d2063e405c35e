import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import blended, blends
from npfm.fitting import fits
from npfm.fitting.basis import library
from npfm.fitting.factors.microfacet import G_NODES, tabulate_channel
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.rendering import assembly, products, transport
from npfm.rendering.lights.environment import Environment
from npfm.rendering.sampling import registry
from npfm.rendering.sampling.strategy import Given
from npfm.rendering.scenes import Scene

GRID = HalfDifference(8, 8, 16)
RESOLUTION = 10


def parameters(seed):
    rng = np.random.default_rng(seed)
    sizes = {"D": (3, 8), "F": (3, 8), "G": (3, G_NODES), "rho_s": (3,), "rho_d": (3,)}
    given = {name: rng.uniform(0.05, 1, shape).astype(np.float32) for name, shape in sizes.items()}
    given["D"] = (given["D"] * 2.0 ** -np.arange(8)).astype(np.float32)
    # Smooth: between its nodes G is linear, and not the logarithm.
    steps = np.linspace(0, 1, G_NODES)
    given["G"] = np.exp(-rng.uniform(0, 1, (3, 1)) * steps**2).astype(np.float32)
    return given


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fits")
    names = [f"{folder}/{k}.npz" for k in range(4)]
    for k, name in enumerate(names):
        fits.save(name, Fit("independent-g", parameters(k), GRID))
    return names


@pytest.fixture(scope="module")
def matrix():
    light = Environment(np.random.default_rng(2).uniform(0, 1, (8, 16, 3)))
    strategies = registry.make(["light", "half-vector"], Given(light, GRID))
    return assembly.build(Scene(("sphere",), ()), light, GRID, RESOLUTION, 64, 1, strategies)


@pytest.fixture(scope="module")
def parts():
    weights = np.random.default_rng(5).dirichlet(np.ones(4), RESOLUTION**2)
    weights[::3] = np.eye(4)[1]
    return weights


@pytest.mark.parametrize("name", blended.BLENDS)
def test_a_picture_is_that_of_a_table_for_each_pixel(matrix, files, parts, name):
    palette, blend = blended.palette(files), blended.BLENDS[name]
    picture = products.render_products(
        matrix, blended.reading(GRID), lambda pixels: blend(palette, parts[pixels])
    )
    dense = np.stack([rows.toarray() for rows in matrix.matrices]).astype(float)
    expected = matrix.backdrop.reshape(-1, 3).astype(float)
    for pixel, mixture in enumerate(parts):
        (table,) = blended.tabulated(blend(palette, mixture[None]), GRID)
        column = GRID.column_values(table.values)
        expected[pixel] += np.einsum("cn,cn->c", dense[:, pixel], column)
    np.testing.assert_allclose(picture[..., :3].reshape(-1, 3), expected, rtol=2e-5, atol=1e-7)
    np.testing.assert_array_equal(picture[..., 3], matrix.coverage)


def test_a_blend_of_one_material_is_its_fit(matrix, files):
    palette = blended.palette(files)
    for k, file in enumerate(files):
        p = {name: value.astype(float) for name, value in fits.load(file).parameters.items()}
        own = (p[name] for name in ("D", "F", "G", "rho_d", "rho_s"))
        expected = [tabulate_channel(GRID, *channel) for channel in zip(*own, strict=True)]
        for blend in blended.BLENDS.values():
            (table,) = blended.tabulated(blend(palette, np.eye(4)[[k]]), GRID)
            above = np.broadcast_to(GRID.above_horizon, table.values.shape)
            np.testing.assert_allclose(table.values[above], np.stack(expected)[above], rtol=1e-6)


def test_the_specular_part_is_the_geometric_mean_whatever_the_scales(files, tmp_path):
    half = np.array([[0.5, 0.5, 0.0, 0.0]])
    palette = blended.palette(files)
    ones = [blended.tabulated(palette.products(np.eye(4)[[k]]), GRID)[0].values for k in (0, 1)]
    (mixed,) = blended.tabulated(palette.products(half), GRID)
    rho_d = palette.rho_d[:2, :, None, None, None]
    above = np.broadcast_to(GRID.above_horizon, mixed.values.shape)
    speculars = [(one - d)[above] for one, d in zip(ones, rho_d, strict=True)]
    expected = np.sqrt(speculars[0] * speculars[1])
    np.testing.assert_allclose((mixed.values - rho_d.mean(axis=0))[above], expected, rtol=1e-4)

    p = parameters(0)
    scaled = p | {"D": 3 * p["D"], "G": 2 * p["G"], "F": 5 * p["F"], "rho_s": p["rho_s"] / 60}
    scaled = {name: value.astype(np.float32) for name, value in scaled.items()}
    fits.save(tmp_path / "scaled.npz", Fit("independent-g", scaled, GRID))
    again = blended.palette([str(tmp_path / "scaled.npz"), *files[1:]])
    (other,) = blended.tabulated(again.products(half), GRID)
    np.testing.assert_allclose(other.values, mixed.values, rtol=1e-5)


def test_a_geometric_mean_is_darker_and_its_albedo_can_be_kept(files, parts):
    palette = blended.palette(files)
    own = blended.specular_albedo(palette.products(np.eye(4)), GRID)
    made = blended.specular_albedo(palette.products(parts), GRID)
    assert (made <= np.exp(parts @ np.log(own)) * (1 + 1e-9)).all()  # Hoelder's inequality
    kept = blended.specular_albedo(palette.same_albedo(parts), GRID)
    np.testing.assert_allclose(kept, parts @ own, rtol=1e-9)


def test_the_albedo_of_a_constant_product():
    """2 pi rho_s: the cosines in the integral and in the product cancel."""
    ones = {"D": np.ones((1, 3, 90)), "F": np.ones((1, 3, 90)), "G": np.ones((1, 3, G_NODES))}
    flat = products.Products(**ones, rho_s=np.full((1, 3), 0.1), rho_d=np.zeros((1, 3)))
    np.testing.assert_allclose(blended.specular_albedo(flat, MERL), 0.2 * np.pi, rtol=2e-3)


def test_no_specular_part_at_all_is_blended_too(files, tmp_path):
    p = parameters(7)
    p |= {"rho_s": np.zeros(3, np.float32), "D": np.zeros((3, 8), np.float32)}
    fits.save(tmp_path / "matte.npz", Fit("independent-g", p, GRID))
    alone = blended.palette([str(tmp_path / "matte.npz")] * 4)
    for palette in (alone, blended.palette([str(tmp_path / "matte.npz"), *files[1:]])):
        for blend in blended.BLENDS.values():
            made = blend(palette, np.full((1, 4), 0.25))
            assert all(np.isfinite(value).all() for value in vars(made).values())


def test_scales_of_rho_s_may_lie_as_far_apart_as_they_like(files, tmp_path):
    """The F of a mirror can be 1 at grazing and 1e-6 elsewhere, with a rho_s as much larger."""
    p = parameters(9)
    p["F"][:, :-1] *= np.float32(1e-6)
    p["rho_s"] *= np.float32(1e9)
    fits.save(tmp_path / "mirror.npz", Fit("independent-g", p, GRID))
    palette = blended.palette([str(tmp_path / "mirror.npz"), *files[1:]])
    (table,) = blended.tabulated(palette.products(np.eye(4)[[1]]), GRID)
    (alone,) = blended.tabulated(blended.palette(files).products(np.eye(4)[[1]]), GRID)
    np.testing.assert_allclose(table.values, alone.values, rtol=1e-9)


def test_other_fits_are_refused(tmp_path, files):
    B = np.ones((3, 8, 8), np.float32)
    fits.save(tmp_path / "b.npz", Fit("bivariate", {"B": B}, GRID))
    with pytest.raises(NpfmError, match=r"b.npz: a fit of bivariate has no single D"):
        blended.palette([files[0], str(tmp_path / "b.npz")])
    fits.save(tmp_path / "g.npz", Fit("independent-g", parameters(0), HalfDifference(8, 8, 18)))
    with pytest.raises(NpfmError, match=r"g.npz: on the grid"):
        blended.palette([files[0], str(tmp_path / "g.npz")])


@pytest.mark.parametrize("steps", [1, 3, 8])
def test_weights_in_whole_steps(parts, steps):
    whole = blends.whole_steps(parts, steps)
    assert (whole.sum(axis=1) == steps).all() and (whole >= 0).all()
    assert np.abs(whole - steps * parts).max() < 1
    np.testing.assert_array_equal(blends.whole_steps(whole / steps, steps), whole)


@pytest.mark.parametrize("steps", ["0", "256", "9" * 30])
def test_more_steps_than_a_texture_has_are_refused(capsys, steps):
    assert main(["blends", "scene", "--steps", steps]) == 1
    assert f"'{steps}': give a whole number from 1 to 255" in capsys.readouterr().err


def test_a_table_for_each_mixture_is_exact_where_weights_are_whole_steps(matrix, files, parts):
    way = blends.ways(files)["log-factors"]
    whole = blends.whole_steps(parts, 2) / 2
    found, tables = blends.render_in_steps(matrix, way, whole, 2)
    at = blended.reading(GRID)
    exact = products.render_products(matrix, at, lambda p: way.blend(way.palette, whole[p]))
    np.testing.assert_allclose(found, exact[..., :3], rtol=1e-4)
    assert tables == len(np.unique(whole[np.diff(matrix.indptr) > 0], axis=0))


def test_the_tables_of_costs_and_of_what_is_half_way(matrix, files, parts, tmp_path):
    measured = [
        blended.tabulated(blended.palette([f]).products(np.ones((1, 1))), GRID)[0] for f in files
    ]
    chosen = blends.ways(files)
    made = blends.render_all(matrix, parts, measured, files, chosen, [2])
    table = blends.costs("A", made, matrix.foreground, 4)
    assert list(table["way"]) == list(made) == [
        "measured", "tables", "log-factors", "same-albedo", "log-factors-2-steps",
    ]  # fmt: skip
    costs = table.set_index("way")
    assert costs.loc["tables", "held_bytes"] == 4 * 3 * GRID.size * 4
    assert costs.loc["log-factors", "held_bytes"] == 4 * 3 * (8 + 8 + G_NODES + 2) * 4
    assert costs.loc["tables", "psnr_db"] > 80  # the fits are the measurements
    pictures = np.stack([transport.render(matrix, t)[..., :3].reshape(-1, 3) for t in measured])
    expected = np.einsum("pm,mpc->pc", parts, pictures).reshape(RESOLUTION, RESOLUTION, 3)
    np.testing.assert_allclose(made["measured"].picture, expected, rtol=1e-4)
    half, ends = blends.half_way(list("abcd"), matrix, measured, chosen)
    assert len(half) == len(ends) == 3 * 5
    tables = half[half["way"] == "tables"]
    np.testing.assert_allclose(tables["brightness"], 1, rtol=1e-4)
    assert (half.loc[half["way"] == "log-factors", "brightness"] < 1).all()
    table.to_csv(tmp_path / "a.csv", index=False)
    half.to_csv(tmp_path / "b.csv", index=False)
    read, _ = blends.read(f"{tmp_path}/a.csv", f"{tmp_path}/b.csv")
    pd.testing.assert_series_equal(read["way"], table["way"])


def test_what_is_compiled_once_is_no_part_of_a_time(monkeypatch, matrix, files, parts):
    begun = []

    def now():
        begun.append("time")
        return 0.0

    monkeypatch.setattr(blends, "compiled", lambda: begun.append("compiled"))
    monkeypatch.setattr(blends.registry, "tabulated", _noted(blends.registry.tabulated, begun))
    chosen = blends.ways(files)
    measured = [blends.registry.tabulated(file) for file in files]
    begun.clear()
    monkeypatch.setattr(blends.time, "process_time", now)
    blends.render_all(matrix, parts, measured, files, chosen, [])
    assert begun[:3] == ["compiled", "tabulated", "time"]


def _noted(function, noted):
    def called(*arguments):
        noted.append(function.__name__)
        return function(*arguments)

    return called


def test_half_way_between_black_materials_there_is_no_share(matrix, files):
    black = Table(np.zeros((3, *GRID.shape)), GRID)
    half, _ = blends.half_way(list("abcd"), matrix, [black] * 4, blends.ways(files))
    assert half["brightness"].isna().all()


def test_cells_without_a_measurement_are_black_in_all_ways(matrix, files):
    palette = blended.palette(files)
    (whole,) = blended.tabulated(palette.products(np.eye(4)[[0]]), GRID)
    assert blends.where_measured(matrix, [whole]) is matrix
    values = whole.values.copy()
    values[1, :2] = INVALID
    holed = Table(values, GRID)
    seen = blends.where_measured(matrix, [whole, holed])
    np.testing.assert_allclose(
        transport.render(seen, whole), transport.render(matrix, holed), rtol=1e-5
    )


@pytest.mark.parametrize("width", [2.0, 8.0])
def test_how_far_a_highlight_reaches(width):
    angles = np.degrees(MERL.theta_h)[:, None, None]
    profile = 0.1 + np.exp(-0.5 * (angles / width) ** 2)
    table = Table(np.broadcast_to(profile, (3, *MERL.shape)), MERL)
    for part in (0.5, 0.01):
        expected = width * np.sqrt(-2 * np.log(part))
        assert blends.reach(table, part) == pytest.approx(expected, rel=0.01)


def test_as_many_curves_as_there_are_factors_change_nothing(files, tmp_path, matrix, parts):
    loaded = {file: fits.load(file) for file in files}
    library.save(tmp_path / "factors.npz", library.gather(loaded, Objective()))
    (whole,) = blends.in_basis(files, str(tmp_path / "factors.npz"), 90).values()
    (small,) = blends.in_basis(files, str(tmp_path / "factors.npz"), 2).values()
    free = blends.ways(files)["log-factors"]
    assert small.own == 3 * (2 * 3 + 2) < free.own
    assert small.held == 4 * small.own + 3 * (8 + 8 + G_NODES)
    at = blended.reading(GRID)
    shown = [
        products.render_products(
            matrix, at, lambda pixels, way=way: way.blend(way.palette, parts[pixels])
        )
        for way in (free, whole, small)
    ]
    np.testing.assert_allclose(shown[1], shown[0], rtol=1e-3)
    assert np.abs(shown[2] - shown[0]).max() > 1e-3 * shown[0].max()
    alone = np.eye(4)
    albedos = [blended.specular_albedo(w.palette.products(alone), GRID) for w in (free, small)]
    np.testing.assert_allclose(*albedos, rtol=1e-9)
    library.save(
        tmp_path / "other.npz",
        library.gather(
            {"a": Fit("independent-g", parameters(1), HalfDifference(8, 8, 18))}, Objective()
        ),
    )
    with pytest.raises(NpfmError, match="of another model or grid"):
        blends.in_basis(files, str(tmp_path / "other.npz"), 2)
