"""The target `exports`: what it writes, and what it writes again after an edit."""

EXPORTS = {
    "csv": ["g-from-d"],
    "glsl": ["g-from-d"],
    "merl": ["naive"],
    "mitsuba": ["naive"],
    "bsdf": {"variants": ["measured", "old"], "views": 4, "size": 8},
}
CSV = "exports/csv/g-from-d/chalk.csv"
GLSL = "exports/glsl/g-from-d/chalk.glsl"
MERL = "exports/merl/naive/chalk.binary"
BSDF = {f"exports/bsdf/{name}/chalk.bsdf" for name in ("measured", "old")}
SCENE = "exports/mitsuba/naive/chalk"
FIT = {f"exports/fits/g-from-d/chalk.{end}" for end in ("npz", "json")}


def test_the_target_writes_what_is_asked_for_and_again_what_an_edit_changes(project):
    project.configure(exports=EXPORTS)
    results = project.folder / "results" / "tiny"
    assert project.planned("exports") >= {CSV, GLSL, MERL, SCENE, *BSDF, *FIT}
    run = project.snakemake("exports")
    assert run.returncode == 0, run.stdout + run.stderr
    for path in (CSV, GLSL, MERL, *BSDF, f"{SCENE}/scene.xml", f"{SCENE}/material.npz"):
        assert (results / path).is_file()
    assert project.planned("exports") == set()
    module = project.folder / "npfm/exports/factors_csv.py"
    module.write_text(module.read_text() + "\nUNUSED = 1\n")
    assert project.planned("exports") == {CSV}
    project.edit("npfm/exports/shaders/lobes.glsl", "// rho_d", "// As said: rho_d")
    assert project.planned("exports") == {CSV, GLSL}
    module = project.folder / "npfm/models/naive.py"
    module.write_text(module.read_text() + "\nUNUSED = 1\n")
    # The measured table is written by no model.
    assert "exports/bsdf/measured/chalk.bsdf" not in project.planned("exports")
