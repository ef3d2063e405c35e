import csv

from browser import opened

from npfm.exports.gallery.page import templates

PAGES = {"gallery/index.html", "gallery/materials/chalk.html", "gallery/materials/chalk.jpg"}
NUMBERS = """
await ready;
return Object.fromEntries(DATA.metrics.map((m) => [m.name, m.values]));
"""


def test_the_target_makes_pages_of_the_tables(project):
    assert project.planned("gallery") == PAGES
    run = project.snakemake("gallery")
    assert run.returncode == 0, run.stdout + run.stderr
    results = project.folder / "results" / "tiny"
    assert {f"{p.relative_to(results)}" for p in results.glob("gallery/**/*.*")} == PAGES
    shown = opened(results / "gallery/materials/chalk.html", NUMBERS)
    with open(results / "tables/quality.csv") as file:
        for row in csv.DictReader(file):
            there = shown[row["metric"]][row["scene"]][row["variant"]]
            assert there == (float(row["value"]) if row["value"] else None)
    assert project.planned("gallery") == set()
    script = project.folder / "npfm/exports/gallery/templates/overview.js"
    script.write_text(script.read_text() + "// Changed.\n")
    assert project.planned("gallery") == {"gallery/index.html"}


def test_what_pages_are_made_from_is_there():
    for page in ("material", "overview"):
        assert all(path.is_file() for path in templates(page))
