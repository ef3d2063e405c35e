"""Where the error of fits sits, against sums by hand and properties that must hold."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from npfm.evaluation import tables
from npfm.evaluation.where import (
    COLUMNS,
    EDGES,
    RECIPROCAL,
    of_picture,
    of_table,
    reciprocal,
    where,
)
from npfm.figures import where as figure
from npfm.fitting.objective import Objective, channel_samples, evaluate, fold
from npfm.reflectance.table import Table
from npfm.rendering.scenes import Scene
from npfm.rendering.view_angles import NOTHING, view_angles
from npfm.storage.pictures import write_exr

OBJECTIVE = Objective()
SPHERE = Scene(("sphere",))


def worse(table):
    """A fit that is too bright by a tenth."""
    return Table(table.values * 1.1, table.grid)


def samples_of(table):
    return [channel_samples(table, channel, OBJECTIVE) for channel in range(3)]


def test_parts_sum_to_the_objective_of_a_fit(gappy):
    samples = samples_of(gappy)
    parts = of_table(samples, worse(gappy))
    model = [worse(gappy).values[k] / s.scale for k, s in enumerate(samples)]
    relative = [
        evaluate(s, m * (s.weight > 0)) / s.energy for s, m in zip(samples, model, strict=True)
    ]
    for part in parts.values():
        assert part.sum() == pytest.approx(100 * np.mean(relative))


def test_parts_lie_in_the_bins_of_their_angles(table):
    values = table.values.copy()
    # The highlight alone is wrong: bin 0 of theta_h, whose centre is at 90 / 36^2 degrees.
    values[:, 0] *= 2
    parts = of_table(samples_of(table), Table(values, table.grid))
    assert parts["theta_h"][0] > 0
    assert not parts["theta_h"][1:].any()
    assert (parts["theta_d"] > 0).all()


def test_the_reciprocal_table_has_the_objective_that_folding_takes_out(gappy):
    samples = samples_of(gappy)
    best = reciprocal(samples)
    exchanged = best.values[..., ::-1]
    np.testing.assert_array_equal(best.values, exchanged)
    folded = list(map(fold, samples))
    floor = 100 * np.mean([s.floor / s.energy for s in folded])
    assert floor > 0.01
    for part in of_table(samples, best).values():
        assert part.sum() == pytest.approx(floor)
    # No other table that exchanging leaves alone is nearer.
    for factor in (0.99, 1.01):
        other = Table(np.where(best.values > 0, best.values * factor, -1), best.grid)
        assert of_table(samples, other)["theta_h"].sum() > floor


def test_a_reciprocal_measurement_has_no_floor(table):
    values = np.maximum(table.values, 0) + np.maximum(table.values[..., ::-1], 0)
    even = Table(np.where(table.grid.above_horizon, values, -1), table.grid)
    samples = samples_of(even)
    parts = of_table(samples, reciprocal(samples))
    assert parts["theta_h"].sum() == pytest.approx(0, abs=1e-20)


def test_pixels_slant_as_a_sphere_does():
    slant = view_angles(SPHERE, 64)
    seen = slant[slant < NOTHING]
    assert slant[0, 0] == NOTHING
    assert seen.min() < 3
    # The camera is 4.4 radii away: the silhouette is where the view grazes.
    assert 85 < seen.max() <= 90
    # Against the angle at the sphere of the triangle camera, centre, point.
    row, column = 40, 20
    extent = np.tan(np.radians(15))
    x, y = ((k + 0.5) / 64 * 2 - 1 for k in (column, row))
    off = np.arctan(extent * np.hypot(x, y))
    assert slant[row, column] == pytest.approx(np.degrees(np.arcsin(4.4 * np.sin(off))), abs=1e-6)


def test_errors_of_pictures_lie_where_the_pixels_slant():
    slant = view_angles(SPHERE, 32)
    inside = slant < NOTHING
    reference, picture = np.ones((32, 32, 3)), np.ones((32, 32, 3))
    steep = inside & (slant >= 60) & (slant < 70)
    picture[steep] += 0.1
    picture[~inside] = 9
    found = of_picture(reference, picture, inside)
    assert found[EDGES["slant"].index(60)] == pytest.approx(100)
    assert np.isnan(of_picture(reference, reference, inside)).all()


@pytest.fixture
def gathered(tmp_path, table):
    alpha = (view_angles(SPHERE, 16) < NOTHING).astype("f4")[..., None]
    folder = tmp_path / "renders" / "A" / "paint"
    for name, level in (("measured", 1.0), ("one", 1.1), ("two", 1.2)):
        picture = np.concatenate([np.full((16, 16, 3), level, "f4"), alpha], axis=2)
        write_exr(folder / f"{name}.exr", picture)
    read = {"paint.binary": table, "paint.npz": worse(table)}
    fits = {"paint": ["one", "two"]}
    return where(tmp_path, ["A"], fits, OBJECTIVE, lambda path: read[path.name])


def test_a_run_is_gathered(gathered):
    assert tuple(gathered.columns) == COLUMNS
    sums = gathered.groupby(["variant", "angle"])["percent"].sum().unstack()
    assert set(sums.index) == {RECIPROCAL, "one", "two"}
    assert sums.loc["one", "slant"] == pytest.approx(100)
    for angle in ("theta_h", "theta_d", "lowest"):
        assert sums.loc["one", angle] == pytest.approx(sums.loc["two", angle])
        assert sums.loc[RECIPROCAL, angle] < sums.loc["one", angle]


def test_the_figure_shows_every_angle(gathered, tmp_path):
    tables.write(tmp_path / "where.csv", gathered)
    arguments = SimpleNamespace(table=str(tmp_path / "where.csv"), colors=[])
    drawn = figure.make(arguments)
    assert [ax.get_xlabel() for ax in drawn.axes] == list(figure.TITLES.values())
    assert [len(ax.get_lines()) for ax in drawn.axes] == [2, 2, 2, 2]
    assert [bool(ax.patches) for ax in drawn.axes] == [True, True, True, False]


def test_the_figure_shows_the_least_reciprocal_of_many(gathered):
    many = pd.concat(
        gathered.assign(material=f"m{k}", percent=gathered["percent"] * k) for k in range(9)
    )
    drawn = figure.draw(many)
    assert [ax.get_title(loc="left") for ax in drawn.axes[::4]] == [f"m{k}" for k in range(3, 9)]


def test_the_legend_has_what_only_some_materials_have(gathered):
    first = gathered["material"] + "-first"
    some = gathered.assign(material=first)[gathered["variant"] != "two"]
    some = some[some["angle"] != "slant"]  # as of a material that no picture was rendered of
    drawn = figure.draw(pd.concat([some, gathered]))
    [legend] = drawn.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels == ["one", "two", figure.LEFT]
    assert "nan" not in [label.get_text() for ax in drawn.axes for label in ax.get_xticklabels()]
