import re
import shutil
from pathlib import Path

from npfm import variants

TESTS = Path(__file__).parents[1]


def planned(project):
    run = project.snakemake("stability", "--dry-run")
    assert run.returncode == 0, run.stdout + run.stderr
    outputs = re.findall(r"^ +output: (.*)$", run.stdout + run.stderr, re.MULTILINE)
    return {name.removeprefix("results/tiny/") for name in outputs}


def test_the_target_fits_every_model_and_follows_its_code(project):
    """Not run here: it would take longer than all other tests."""
    (project.folder / "tests").mkdir()
    for name in ("hard_cases.py", "stability.py"):
        shutil.copy(TESTS / name, project.folder / "tests")
    tables = {f"stability/{model}.csv" for model in variants.non_parametric()}
    assert planned(project) == tables | {"tables/stability.csv"}
    for name in tables | {"tables/stability.csv"}:
        path = project.folder / "results" / "tiny" / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("case\n")
    assert project.snakemake("stability", "--touch").returncode == 0
    assert planned(project) == set()
    project.edit("npfm/models/naive.py", "CLAMP = 1e-6", "CLAMP = 1e-5")
    assert planned(project) == {"stability/naive.csv", "tables/stability.csv"}
