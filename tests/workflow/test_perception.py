import csv

import pytest

from npfm.evaluation import perception

PAIRS = ("GGX;chalk;0.5", "BECKMAN;chalk;1", "GGX;pink-felt;0", "BECKMAN;pink-felt;0")
SAID = "\n".join(["METHOD;BRDF;DISTANCE", *PAIRS, ""])


def study(project, *variants):
    """Some variants of two materials in one scene."""
    return {
        "perceptual": "said",
        "variants": list(variants),
        "dataset": {"kind": "synthetic", "materials": ["chalk", "pink-felt"]},
        "scenes": {"A": project.config["scenes"]["A"]},
    }


def opinions(project, text):
    folder = project.folder / "data" / "said"
    folder.mkdir(parents=True)
    (folder / "PerceptualDistances.csv").write_text(text)
    (folder / "MaterialType.csv").write_text("BRDF;Type\nchalk;Stone\npink-felt;Cloth\n")


def test_the_target_makes_tables_and_a_figure(fresh):
    opinions(fresh, SAID)
    fresh.configure(**study(fresh, "ggx", "beckmann"))
    run = fresh.snakemake("perception")
    assert run.returncode == 0, run.stdout + run.stderr
    results = fresh.folder / "results" / "tiny"
    with open(results / "tables" / "perception.csv") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(perception.CORRELATIONS)
    assert {row["pairs"] for row in rows} == {"4"}
    # Pictures of 8 pixels have none.
    assert "ssim" not in {row["metric"] for row in rows}
    assert (results / "tables" / "perception_pairs.csv").exists()
    assert (results / "figures" / "perception.png").exists()


@pytest.mark.parametrize(
    ("text", "variant", "message"),
    [
        (None, "ggx", "data/said/PerceptualDistances.csv: no such file"),
        (SAID + "GGX;chalk;1\n", "ggx", "line 6: 'GGX' of 'chalk' is there already"),
        (SAID, "naive", "no variant of the run is of a model that people were shown"),
    ],
)
def test_mistakes_are_one_line_before_anything_runs(fresh, text, variant, message):
    if text:
        opinions(fresh, text)
    fresh.configure(**study(fresh, variant))
    run = fresh.snakemake("--dry-run")
    assert run.returncode != 0
    [said] = [line for line in run.stderr.splitlines() if "npfm:" in line]
    assert message in said
