import numpy as np
import pandas as pd
import pytest

from npfm.errors import NpfmError
from npfm.evaluation import psnr_level as study
from npfm.evaluation import tables
from npfm.evaluation.metrics import psnr
from npfm.reflectance.half_difference import HalfDifference
from npfm.reflectance.table import INVALID, Table
from npfm.rendering import assembly, transport
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene
from npfm.rendering.view_angles import view_angles

GRID = HalfDifference(6, 5, 8)
PIXELS = 12


def a_table(seed):
    values = np.random.default_rng(seed).uniform(0.1, 1, (3, *GRID.shape))
    values[0, 0, 0, 0] = INVALID
    return Table(values, GRID)


MEASURED, FITS = a_table(1), {"naive": a_table(2), "bivariate": a_table(3)}


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Scenes of a sphere: one ray a pixel, sixteen, and in another light."""
    folder = tmp_path_factory.mktemp("scenes")
    radiance = np.arange(1.0, 97).reshape(4, 8, 3)
    for name, effects, light in (
        ("plain", (), radiance),
        ("smooth", ("antialiasing",), radiance),
        ("turned", (), np.roll(radiance, 4, axis=1)),
    ):
        scene = Scene(("sphere",), effects)
        built = assembly.build(scene, Environment(light), GRID, PIXELS, 64, 1)
        transport.save(folder / name, built)
    return folder


def builds(folders):
    angles = view_angles(Scene(("sphere",)), PIXELS)
    return [
        study.Build("A", "configured", str(folders / "plain"), angles),
        study.Build("A", "antialiased", str(folders / "smooth")),
        study.Build("A", "turned-180", str(folders / "turned")),
    ]


def rendered(folder, variant):
    """As npfm render --measured does."""
    fit = FITS[variant].where_measured(MEASURED)
    matrix = transport.load(folder)
    return [transport.render(matrix, table) for table in (fit, MEASURED)]


def test_each_setting_compares_its_own_pixels(folders):
    found = study.measure("stone", MEASURED, FITS, builds(folders))
    assert tuple(found.columns) == study.MEASURED
    settings = {
        "as-configured": ("plain", lambda coverage, angles: coverage == 1),
        "to-80-degrees": ("plain", lambda coverage, angles: (coverage == 1) & (angles <= 80)),
        "antialiased": ("smooth", lambda coverage, angles: coverage == 1),
        "covered-half": ("smooth", lambda coverage, angles: coverage >= 0.5),
        "touched": ("smooth", lambda coverage, angles: coverage > 0),
        "turned-180": ("turned", lambda coverage, angles: coverage == 1),
    }
    assert found["setting"].unique().tolist() == list(settings)
    angles = view_angles(Scene(("sphere",)), PIXELS)
    for setting, (name, chosen) in settings.items():
        for variant in FITS:
            picture, reference = rendered(folders / name, variant)
            inside = chosen(reference[..., 3], angles)
            rows = found[(found["setting"] == setting) & (found["variant"] == variant)]
            expected = psnr(picture[..., :3], reference[..., :3], inside)
            assert rows["psnr_db"].item() == pytest.approx(expected, abs=1e-3)
            assert rows["peak"].item() == pytest.approx(reference[inside][:, :3].max(), rel=1e-5)
    assert found.groupby("setting")["psnr_db"].first().nunique() == len(settings)


def test_the_share_of_the_error_at_grazing_angles_is_what_leaving_them_out_saves(folders):
    found = study.measure("stone", MEASURED, FITS, builds(folders)[:1])
    angles = view_angles(Scene(("sphere",)), PIXELS)
    picture, reference = rendered(folders / "plain", "naive")
    squared = ((picture - reference)[..., :3].astype(float) ** 2).sum(axis=-1)
    covered = reference[..., 3] == 1
    expected = squared[covered & (angles > 80)].sum() / squared[covered].sum()
    rows = found[found["variant"] == "naive"].set_index("setting")["grazing_share"]
    assert 0 < expected < 1
    assert rows["as-configured"] == pytest.approx(expected, rel=1e-4)
    assert np.isnan(rows["to-80-degrees"])


def test_without_angles_none_are_left_out_and_those_of_other_pixels_are_refused(folders):
    build = study.Build("A", "configured", str(folders / "plain"))
    found = study.measure("stone", MEASURED, FITS, [build])
    assert found["setting"].unique().tolist() == ["as-configured"]
    wrong = study.Build("A", "configured", str(folders / "plain"), np.zeros((6, 6)))
    with pytest.raises(
        NpfmError, match="12 pixels along one side, and the angles of view are of 6"
    ):
        study.measure("stone", MEASURED, FITS, [wrong])


def test_a_scene_without_foreground_is_told(tmp_path, folders):
    matrix = transport.load(folders / "plain")
    arrays = {name: np.array(getattr(matrix, name)) for name in vars(matrix) if name != "grid"}
    arrays["coverage"] *= 0.5
    transport.save(tmp_path / "few", transport.Transport(**arrays, grid=GRID))
    with pytest.raises(NpfmError, match="no pixel is foreground in the setting pixels-4"):
        study.measure(
            "stone", MEASURED, FITS, [study.Build("A", "pixels-4", str(tmp_path / "few"))]
        )


def found_of(material, decibels):
    rows = [
        (setting, scene, material, "naive", value + shift, 1.0, share)
        for setting, shift, share in (("as-configured", 0, 0.25), ("touched", 10, np.nan))
        for scene, value in zip("AB", decibels, strict=True)
    ]
    return pd.DataFrame(rows, columns=study.MEASURED)


def test_levels_are_means_over_finite_pictures_beside_what_the_paper_printed(tmp_path):
    tables.write(tmp_path / "a.csv", found_of("a", [40, 50]))
    tables.write(tmp_path / "b.csv", found_of("b", [44, np.inf]))
    levels = study.levels(study.read([tmp_path / "a.csv", tmp_path / "b.csv"]), {"naive": 56.7})
    assert tuple(levels.columns) == study.LEVELS
    rows = [tuple(row) for row in levels[["setting", "scene", "pictures"]].to_numpy()]
    assert rows == [
        (setting, scene, count)
        for setting in ("as-configured", "touched")
        for scene, count in (("all", 3), ("A", 2), ("B", 1))
    ]
    assert levels["psnr_db"].tolist() == pytest.approx([134 / 3, 42, 50, 164 / 3, 52, 60])
    assert levels["paper_db"].fillna(0).tolist() == [56.7, 0, 0, 56.7, 0, 0]
    assert levels["grazing_share"].fillna(-1).tolist() == [0.25] * 3 + [-1] * 3
    tables.write(tmp_path / "levels.csv", levels)
    pd.testing.assert_frame_equal(
        study.read_levels(tmp_path / "levels.csv"), levels.astype({"pictures": float}), rtol=1e-5
    )
