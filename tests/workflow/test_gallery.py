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


DEMO = {"gallery/demo.html", "gallery/figure.js", "gallery/tables/chalk.js"}
#: A picture that is not black, of the measurement and of a fit.
RENDERED = """
state.running = false;
state.size = 16;
await ready;
await choose({ left: "measured", right: "ggx" });
pass(64, [0.5, 0.5]);
const sums = new Float32Array(4 * 16 * 16);
gl.bindFramebuffer(gl.FRAMEBUFFER, front.frame);
gl.readPixels(0, 0, 16, 16, gl.RGBA, gl.FLOAT, sums);
const middle = 4 * (8 * 16 + 8);
return [byId("trouble").textContent, sums.slice(middle - 4, middle + 4).every((sum) => sum > 0)];
"""


def test_the_demo_is_made_where_a_model_has_a_function_of_glsl(project):
    project.configure(variants=[*project.config["variants"], "ggx"])
    assert project.planned("gallery") >= PAGES | DEMO
    run = project.snakemake(*(f"results/tiny/{name}" for name in sorted(DEMO)))
    assert run.returncode == 0, run.stdout + run.stderr
    page = project.folder / "results/tiny/gallery/demo.html"
    assert opened(page, RENDERED) == ["", True]
    project.edit("npfm/exports/shaders/facets.glsl", "// rho_d", "// As said: rho_d")
    made = [f"results/tiny/{name}" for name in sorted(DEMO)]
    assert project.planned(*made) == {"gallery/demo.html"}
    project.configure(variants=[*project.config["variants"], "ggx"], gallery={"measured": ["z*"]})
    assert project.planned("gallery").isdisjoint({"gallery/tables/chalk.js"})


def test_what_pages_are_made_from_is_there():
    for page in ("material", "overview", "demo"):
        assert all(path.is_file() for path in templates(page))
