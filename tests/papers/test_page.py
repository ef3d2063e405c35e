import itertools
import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import main
from npfm.evaluation import psnr_level, tables
from npfm.fitting import fits
from npfm.fitting.fits import ChannelRecord, Fit, Trace
from npfm.papers import authors_distance, page
from npfm.papers.evidence import starts
from npfm.papers.page import TOPICS
from npfm.reflectance.half_difference import MERL
from npfm.storage.pictures import write_png

MATERIALS, VARIANTS = ["alum-bronze", "nylon"], ["bivariate", "independent-g"]


def record(channel, ends):
    traces = tuple(
        Trace(f"start-{k}", "converged", 1, 0, (0.0, 1.0), (1.0, end)) for k, end in enumerate(ends)
    )
    best = f"start-{int(np.argmin(ends))}"
    return ChannelRecord(channel, 1.0, best, min(ends), 0.0, "converged", traces)


def save_record(folder, material, *records):
    (folder / "fits" / "independent-g").mkdir(parents=True, exist_ok=True)
    fit = Fit("independent-g", {"D": np.ones(3, dtype=np.float32)}, MERL, records)
    fits.save(folder / "fits" / "independent-g" / f"{material}.npz", fit)


@pytest.fixture
def run(tmp_path):
    folder = tmp_path / "results" / "tiny"
    rows = []
    for scene, material in itertools.product("AB", MATERIALS):
        for k, variant in enumerate(["measured", *VARIANTS]):
            picture = np.full((8, 8, 3), 60 + k, dtype=np.uint8)
            write_png(folder / "renders" / scene / material / f"{variant}.png", picture)
        rows += [(scene, material, variant, 50.0) for variant in VARIANTS]
    for material in MATERIALS:
        save_record(folder, material, record("red", [0.1, 0.2, 0.21]), record("blue", [1.0]))
    (folder / "tables").mkdir()
    psnr = pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])
    tables.write(folder / "tables" / "psnr.csv", psnr)
    summary = pd.DataFrame({"variant": VARIANTS, "bytes": [97200, 3264]})
    tables.write(folder / "tables" / "summary.csv", summary)
    rows = [("nylon", c, 0.02, 0.03, 0.01, 0.01, 0.05, 0.1) for c in ("red", "green", "blue")]
    distance = pd.DataFrame(rows, columns=authors_distance.COLUMNS)
    tables.write(folder / "tables" / "published.csv", distance)
    return folder


def call(run, *more):
    options = [f"--{name}={run}/tables/{name}.csv" for name in ("psnr", "summary", "published")]
    output = run / "reproduction.md"
    arguments = ["reproduction", "--run", str(run), "--dataset", "neural", *options, *more]
    assert main([*arguments, "-o", str(output)]) == 0
    return output.read_text()


@pytest.mark.parametrize(
    ("ends", "spread"),
    [
        ([0.010, 0.030, 0.0301], 2.01),  # the two that lost agree with each other only
        ([0.3, 0.2, 0.21], 0.5),
        ([0.0, 0.0, 0.0], 0.0),  # a black channel
        ([0.0, 1e-17, 1e-15], 0.001),  # met but for rounding
        ([0.0, 0.1], 1e11),
    ],
)
def test_the_spread_of_starts_is_that_of_all_of_them(tmp_path, ends, spread):
    save_record(tmp_path, "chrome", record("red", ends))
    table = starts(str(tmp_path), ["chrome"])
    assert table["spread"].tolist() == pytest.approx([spread])


def test_a_start_that_saw_more_samples_is_compared_on_those_that_all_saw(tmp_path):
    channel = record("red", [0.1, 0.2, 0.21])
    winner = replace(channel.traces[0], compared=0.19)
    save_record(tmp_path, "chrome", replace(channel, traces=(winner, *channel.traces[1:])))
    assert starts(str(tmp_path), ["chrome"])["spread"].tolist() == pytest.approx([0.02 / 0.19])


def test_a_single_start_agrees_with_none(run):
    assert starts(run, MATERIALS)["channel"].tolist() == ["red", "red"]


def test_every_claim_stands_on_the_page_with_its_verdict(run):
    text = call(run)
    for topic in TOPICS:
        assert topic.title in text
        for claim in topic.claims:
            assert f"| {claim.text} | {claim.paper} |" in text
    verdicts = re.findall(r"\| \*\*(holds|differs|cannot be tested here)\*\*", text)
    counts = [verdicts.count(verdict) for verdict in (page.HOLDS, page.DIFFERS, page.UNTESTABLE)]
    assert all(counts)
    claims, *told = re.search(
        r"Of (\d+) claims (\d+) hold, (\d+) differ and (\d+) cannot", text
    ).groups()
    assert [*map(int, told)] == counts
    assert int(claims) == sum(counts) == sum(len(topic.claims) for topic in TOPICS)
    assert "The run has 2 materials and 2 scenes" in text


def test_it_says_what_stands_in_for_the_measured_tables_and_how_far_it_is(run):
    text = call(run)
    assert "The tables are not the measured ones" in text
    assert "2.00 times that of our own" in text
    assert "| nylon | 0.0200 | 0.0300 | 0.0100 | 0.0100 | +5.1 % | 10.5 % |" in text
    assert "1.50 times as great in the median, and greater in 3 of 3 channels" in text
    assert "0.50 times as great in the median, and greater in 0 of 3 channels" in text


def test_figures_stand_beside_their_claims_where_the_run_has_them(run):
    text = call(run, "--figures", f"{run}/figures/figure12.png", f"{run}/figures/figure03.png")
    assert "![figure12](figures/figure12.png)" in text
    assert text.count("![") == 1
    assert text.index("Against parametric models") < text.index("![figure12]")


def test_a_reason_is_given_where_a_claim_differs_and_nowhere_else(run):
    text = call(run)
    for block in text.split("## ")[1:]:
        assert ("\nWhy: " in block) == ("**differs**" in block)


def test_the_same_tables_give_the_same_page(run):
    assert call(run) == call(run)


def test_every_row_has_as_many_columns_as_its_head(run):
    for table in re.findall(r"(?:^\|.*\n)+", call(run), re.MULTILINE):
        assert len({row.count("|") for row in table.splitlines()}) == 1


def test_a_run_without_the_models_has_a_page_too(run):
    psnr = tables.read_psnr(run / "tables" / "psnr.csv").replace("independent-g", "mine")
    tables.write(run / "tables" / "psnr.csv", psnr)
    assert "average of independent-g" in call(run)


def test_a_missing_table_is_told_in_one_line(run, capsys):
    (run / "tables" / "summary.csv").unlink()
    names = [f"--{name}={run}/tables/{name}.csv" for name in ("psnr", "summary")]
    arguments = ["reproduction", "--run", str(run), "--dataset", "merl", *names]
    assert main([*arguments, "-o", str(run / "x.md")]) == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "summary.csv" in error
    assert not (run / "x.md").exists()


def test_absolute_levels_are_counted_apart_from_what_models_show_against_each_other(run):
    text = call(run)
    told = re.search(r"of (\d+) such claims (\d+) hold.*: of (\d+) claims (\d+) hold\.", text)
    levels, others = text.split("## 2. Average PSNR: absolute levels")[1].split("## 3.")[0], text
    counts = [levels.count("| **"), levels.count("**holds**")]
    counts += [others.count("| **") - counts[0], others.count("**holds**") - counts[1]]
    assert [*map(int, told.groups())] == counts
    assert counts[0] == 9


def test_levels_stand_beside_what_other_foregrounds_make_of_them(run, tmp_path):
    rows = [
        (setting, scene, "naive", 8, value, 56.71 if scene == "all" else np.nan, np.nan)
        for setting, value in (("as-configured", 43.2), ("touched", 53.1))
        for scene in ("all", "A")
    ]
    tables.write(tmp_path / "levels.csv", pd.DataFrame(rows, columns=psnr_level.LEVELS))
    text = call(run, "--levels", f"{tmp_path}/levels.csv")
    table = text.split("absolute levels")[2 if "absolute levels**" in text else 1]
    assert "| setting | naive |\n|---|---|\n| in the paper | 56.71 |\n" in table
    assert "| as-configured | 43.20 |\n| touched | 53.10 |\n" in table
    assert "of at most 8 pictures" in text
    assert "| setting |" not in call(run)
