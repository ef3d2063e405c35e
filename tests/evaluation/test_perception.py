"""Correlations with opinions, against scipy and against a route through pandas of its own."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from npfm.__main__ import main
from npfm.commands.perception import GROUPS
from npfm.datasets import opinions
from npfm.evaluation import perception, quality, tables
from npfm.papers.lavoue2021 import SHOWN

VARIANTS = ["abc-published", "ward-published", "ggx", "beckmann", "abc-e2"]
VARIANTS += ["lafortune-published", "lafortune", "independent-g-published", "independent-g"]
#: Materials with published factors.
FEW = [f"stuff-{k}" for k in range(2, 6)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A made-up run of twelve materials, and opinions that some metrics follow."""
    folder = tmp_path_factory.mktemp("study")
    rng = np.random.default_rng(5)
    materials = [f"stuff-{k}" for k in range(12)]
    truth = {(m, v): rng.random() for m in materials for v in VARIANTS}
    for material in set(materials) - set(FEW):
        del truth[material, "independent-g-published"]
    rows = []
    for (material, variant), bad in truth.items():
        for name, metric in quality.METRICS.items():
            sign = -1 if metric.better == "higher" else 1
            for scene in ["all"] if name in quality.TABLES else ["A", "B"]:
                noise = rng.normal(scale=2.0 if name == "psnr" else 0.3)
                value = sign * (bad + noise) + 10
                rows.append((scene, material, variant, name, value, metric.unit, metric.better))
    tables.write(folder / "quality.csv", pd.DataFrame(rows, columns=quality.COLUMNS))
    # Opinions come in steps, so that some are equal.
    said = {}
    for (material, variant), bad in truth.items():
        said.setdefault((SHOWN[variant][0], material), round(8 * bad) / 8)
    del said["GGX", "stuff-3"]
    lines = [f'"{method}";"{material}";{value}' for (method, material), value in said.items()]
    (folder / opinions.DISTANCES).write_text("\n".join(['"METHOD";"BRDF";"DISTANCE"', *lines, ""]))
    kinds = [f"{name};{'Metal' if k % 3 else 'Cloth'}" for k, name in enumerate(materials)]
    (folder / opinions.CLASSES).write_text("\n".join(["BRDF;Type", *kinds, ""]))
    for call in (
        f"pairs --quality {folder}/quality.csv --opinions {folder} -o {folder}/pairs.csv",
        f"correlations --quality {folder}/quality.csv --opinions {folder}"
        f" -o {folder}/perception.csv",
    ):
        assert main(["perception", *call.split()]) == 0
    return folder


def by_hand(folder, quality_csv="quality.csv"):
    """Correlations from the same files, by pandas and scipy alone."""
    values = pd.read_csv(folder / quality_csv)
    values["value"] *= values.better.map({"higher": -1.0, "lower": 1.0})
    wide = values.pivot_table(index=["variant", "material"], columns="metric", values="value",
                              aggfunc="mean").dropna().reset_index()  # fmt: skip
    wide["METHOD"] = wide.variant.map({name: method for name, (method, _) in SHOWN.items()})
    wide["made"] = wide.variant.map({name: made for name, (_, made) in SHOWN.items()})
    said = pd.read_csv(folder / "PerceptualDistances.csv", sep=";")
    kinds = pd.read_csv(folder / "MaterialType.csv", sep=";").drop_duplicates()
    joined = wide.merge(said, left_on=["METHOD", "material"], right_on=["METHOD", "BRDF"])
    joined = joined.merge(kinds, on="BRDF")
    found = {}
    for models, made in GROUPS.items():
        chosen = joined[joined.made.isin(made)]
        # What people were shown counts once, by what was published of it if there is something.
        both = chosen.METHOD + chosen.BRDF
        published = both[chosen.made == "published"]
        if "published" in made:
            chosen = chosen[(chosen.made == "published") | ~both.isin(published)]
        for kind in ("all", *chosen.Type.unique()):
            rows = chosen if kind == "all" else chosen[chosen.Type == kind]
            for metric in values.metric.unique():
                rho = stats.spearmanr(rows[metric], rows.DISTANCE).statistic
                found[models, kind, metric] = len(rows), rows.BRDF.nunique(), rho
    return found


def test_the_same_by_an_independent_route(folder):
    table = perception.read(folder / "perception.csv")
    expected = by_hand(folder)
    # The verb leaves classes of one material out; here are none.
    assert {(r.models, r["class"], r.metric) for _, r in table.iterrows()} == set(expected)
    for _, row in table.iterrows():
        pairs, materials, rho = expected[row.models, row["class"], row.metric]
        assert (row.pairs, row.materials) == (pairs, materials)
        assert row.spearman == pytest.approx(rho, abs=1e-5)
        assert row.low <= row.spearman <= row.high


def test_what_follows_opinions_is_told_from_what_does_not(folder):
    table = perception.read(folder / "perception.csv")
    rows = table[(table.models == "as shown") & (table["class"] == "all")].set_index("metric")
    # Six approximations of twelve materials, but for one.
    assert rows.pairs.unique() == [6 * 12 - 1]
    assert (rows.spearman.drop("psnr") > 0.6).all() and rows.spearman["psnr"] < 0.5
    assert (rows.gain_low.drop("psnr") > 0).sum() > 4 and rows.gain["psnr"] == 0
    assert (rows.within.drop("psnr") > rows.within["psnr"]).all()


def test_what_was_shown_counts_once(folder):
    """By what was published of it, where something was; each kind by itself has all of its own."""
    table = perception.read(folder / "perception.csv")
    rows = table[(table["class"] == "all") & (table.metric == "ssim")].set_index("models").pairs
    assert rows["published"] == 3 * 12 + len(FEW)
    assert rows["made again"] == 3 * 12 - 1
    assert rows["as shown"] == rows["published"] + rows["made again"] - len(FEW)
    assert rows["our fits"] == 2 * 12
    shifted = pd.read_csv(folder / "pairs.csv")
    shifted.loc[shifted.variant == "independent-g", "value"] *= 1e3
    shifted = shifted[shifted.material.isin(FEW)]
    groups = {"as shown": GROUPS["as shown"]}
    again = perception.correlations(shifted, groups)
    left_out = perception.correlations(shifted[shifted.variant != "independent-g"], groups)
    pd.testing.assert_frame_equal(again, left_out)


def test_pairs_have_one_value_a_metric_and_the_means_of_scenes(folder):
    pairs = pd.read_csv(folder / "pairs.csv")
    assert list(pairs.columns) == list(perception.PAIRS)
    assert len(pairs) == (12 * (len(VARIANTS) - 1) + len(FEW) - 1) * len(quality.METRICS)
    table = quality.read(folder / "quality.csv").set_index(["metric", "variant", "material"])
    one = pairs[(pairs.variant == "ggx") & (pairs.material == "stuff-1")].set_index("metric")
    scenes = table.sort_index().loc[("ssim", "ggx", "stuff-1"), "value"]
    assert one.value["ssim"] == pytest.approx(scenes.mean(), rel=1e-5)


def test_a_fit_that_some_metric_has_no_value_of_is_left_out(folder):
    table = quality.read(folder / "quality.csv")
    gap = (table.metric == "ssim") & (table.variant == "ggx") & (table.scene == "A")
    gap &= table.material == "stuff-1"
    table.loc[gap, "value"] = np.nan
    said = opinions.read(folder / opinions.DISTANCES)
    pairs = perception.pairs(table, said, {}, SHOWN)
    assert pairs[(pairs.variant == "ggx") & (pairs.material == "stuff-1")].empty
    assert len(pairs) == (12 * (len(VARIANTS) - 1) + len(FEW) - 2) * len(quality.METRICS)
    assert set(pairs["class"]) == {"unknown"}


def test_intervals_are_of_materials_not_of_pairs():
    """The same pairs many times under one name say no more than once."""
    rng = np.random.default_rng(0)
    values = rng.random((6, 1))
    opinion = np.clip(values[:, 0] + rng.normal(scale=0.2, size=6), 0, 1)
    few = perception._resampled(values, opinion, [np.array([k]) for k in range(6)], 1)
    many = perception._resampled(
        np.repeat(values, 9, axis=0), np.repeat(opinion, 9), list(np.arange(54).reshape(6, 9)), 1
    )
    np.testing.assert_allclose(many, few, atol=1e-12)


def test_spearman_with_ties_and_constants():
    rng = np.random.default_rng(1)
    values, opinion = rng.integers(5, size=(40, 3)).astype(float), rng.integers(4, size=40)
    values[:, 2] = 7
    found = perception.spearman(values, opinion)
    for k in range(2):
        expected = stats.spearmanr(values[:, k], opinion).statistic
        assert found[k] == pytest.approx(expected, abs=1e-12)
    assert np.isnan(found[2])


def test_a_run_that_nobody_was_shown_is_told_in_a_line(folder, capsys, tmp_path):
    row = ("A", "felt", "naive", "ssim", 1.0, "1", "higher")
    tables.write(tmp_path / "quality.csv", pd.DataFrame([row], columns=quality.COLUMNS))
    call = f"perception pairs --quality {tmp_path}/quality.csv --opinions {folder}"
    assert main([*call.split(), "-o", f"{tmp_path}/a.csv"]) == 1
    said = capsys.readouterr().err
    assert "no fit in the table is of a model and a material that people were shown" in said
    assert said.count("\n") == 1


def test_what_was_shown_are_methods_of_the_published_file(data):
    methods = set(opinions.read(data / "perceptual" / opinions.DISTANCES).method)
    assert {method for method, _ in SHOWN.values()} <= methods
