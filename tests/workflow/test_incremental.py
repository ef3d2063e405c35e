"""What a change reruns, on the real Snakefile: the table in docs/reruns.md, row by row."""

import functools
import http.server
import os
import shutil
import threading

import yaml

#: Other figures of the paper: test_paper_figures.py.
TARGETS = (
    "tables",
    "results/tiny/figures/figure08_by_diffuseness.pdf",
    "results/tiny/figures/table1.csv",
)
GATHERED = {
    "tables/psnr.csv",
    "tables/summary.csv",
    "figures/figure08_by_diffuseness.pdf",
    "figures/figure08_by_diffuseness.png",
}


def renders(*variants, scenes=("A", "C"), material="chalk"):
    return {
        f"renders/{scene}/{material}/{variant}.{suffix}"
        for scene in scenes
        for variant in variants
        for suffix in ("exr", "png")
    }


def fits(*variants, material="chalk"):
    return {
        f"fits/{variant}/{material}.{suffix}" for variant in variants for suffix in ("npz", "json")
    }


PICTURES = "measured", "bivariate", "naive", "old"
TABLES = GATHERED | {"tables/fits.csv", "tables/materials.csv", "figures/table1.csv"}


def test_touching_code_or_copying_the_same_bytes_again_reruns_nothing(project):
    for path in project.folder.rglob("npfm/**/*.py"):
        os.utime(path)
    table = project.folder / "results/tiny/materials/chalk.binary"
    shutil.copy(table, table.with_suffix(".copy"))
    os.replace(table.with_suffix(".copy"), table)
    assert project.planned() == set()


def test_a_comment_a_docstring_or_the_wording_of_a_complaint_reruns_nothing(project):
    project.edit("npfm/models/naive.py", '"""The naive model', '"""This naive model')
    project.edit(
        "npfm/rendering/transport.py", "import numpy as np\n", "import numpy as np  # a comment\n"
    )
    project.edit("npfm/fitting/objective.py", " channel has entries", " channel holds entries")
    assert project.planned() == set()


def test_an_edit_of_a_model_reruns_its_fits_and_what_they_lead_to(project):
    project.edit("npfm/models/naive.py", "CLAMP = 1e-6", "CLAMP = 1e-5")
    expected = fits("naive", "old") | renders("naive", "old") | TABLES
    assert project.planned(*TARGETS) == expected


def test_an_edit_of_a_solver_reruns_the_variants_that_use_it(project):
    project.edit(
        "npfm/fitting/solvers/gauss_newton.py",
        "COARSE, COARSE_TOLERANCE = 6",
        "COARSE, COARSE_TOLERANCE = 5",
    )
    assert project.planned(*TARGETS) == fits("naive") | renders("naive") | TABLES


def test_an_edit_of_a_figure_reruns_that_figure(project):
    project.edit("npfm/figures/figure08.py", "def draw(", "UNUSED = 1\n\n\ndef draw(")
    assert project.planned(*TARGETS) == {name for name in GATHERED if name.startswith("figures")}


def test_another_colour_redraws_what_has_it(project):
    project.configure(colors={"naive": "#123456"})
    assert project.planned() == {name for name in GATHERED if name.startswith("figures")}


def test_another_seed_fits_again_what_starts_at_random(project):
    targets = [f"results/tiny/fits/{name}/chalk.npz" for name in ("naive", "independent-g")]
    chosen = {"variants": ["naive", "independent-g"]}
    project.configure(**chosen)
    run = project.snakemake(*targets)
    assert run.returncode == 0, run.stderr
    project.configure(**chosen, solver=project.config["solver"] | {"seed": 2})
    others = "results/tiny/scenes/A", "results/tiny/materials/chalk.binary"
    assert project.planned(*targets, *others) == fits("independent-g")


def test_another_exposure_renders_every_fit_again_and_builds_no_scene(project):
    """One job renders a fit in all scenes."""
    scenes = project.config["scenes"] | {"A": project.config["scenes"]["A"] | {"exposure": 0.5}}
    project.configure(scenes=scenes)
    assert project.planned(*TARGETS) == renders(*PICTURES) | GATHERED


def test_another_material_is_all_that_is_made(project):
    project.configure(dataset={"kind": "synthetic", "materials": ["chalk", "pink-felt"]})
    variants = "bivariate", "naive", "old"
    new = {"materials/pink-felt.binary"} | fits(*variants, material="pink-felt")
    new |= renders("measured", *variants, material="pink-felt")
    assert project.planned(*TARGETS) == new | TABLES


def test_another_scene_is_built_and_every_fit_rendered_in_all_scenes(project):
    project.configure(
        scenes=project.config["scenes"] | {"D": project.config["scenes"]["A"] | {"light": "grove"}}
    )
    new = {"lights/grove.exr", "scenes/D", "scenes/D.json"} | renders(*PICTURES, scenes="ACD")
    assert project.planned(*TARGETS) == new | GATHERED


def test_a_scene_less_builds_none_and_renders_every_fit_in_those_that_stay(project):
    project.configure(scenes={"A": project.config["scenes"]["A"]})
    assert project.planned(*TARGETS) == renders(*PICTURES, scenes="A") | GATHERED


def test_another_order_of_scenes_renders_nothing_again(project):
    """As where one of them is laid over the others."""
    scenes = dict(reversed(project.config["scenes"].items()))
    text = yaml.safe_dump(project.config | {"scenes": scenes}, sort_keys=False)
    (project.folder / "config.yaml").write_text(text)
    assert not {name for name in project.planned(*TARGETS) if name.startswith("renders")}


def test_a_lost_table_is_made_again_and_nothing_before_it(project):
    (project.folder / "results/tiny/tables/psnr.csv").unlink()
    assert project.planned(*TARGETS) == GATHERED


def test_a_download_makes_nothing_again(project, tmp_path):
    served = tmp_path / "served"
    served.mkdir()
    shutil.copy(project.folder / "results/tiny/materials/chalk.binary", served / "brass.binary")
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=str(served))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever).start()
        url = f"http://127.0.0.1:{server.server_port}/{{name}}.binary"
        dataset = {"kind": "merl", "path": "brdfs", "url": url, "materials": ["brass"]}
        project.configure(data="", dataset=dataset)
        fit = "results/tiny/fits/bivariate/brass.npz"
        run = project.snakemake(fit)
        server.shutdown()
    assert run.returncode == 0, run.stdout + run.stderr
    assert (project.folder / "brdfs/brass.binary").is_file()
    assert project.planned(fit) == set()
    with (project.folder / "brdfs/brass.binary").open("r+b") as file:
        file.seek(10_000)
        file.write(b"changed!")
    assert project.planned(fit) == fits("bivariate", material="brass")
