import re
import shutil
from pathlib import Path

from npfm.fitting import registry

TESTS = Path(__file__).parents[1]


def test_the_target_fits_every_model(project):
    """Not run here: it would take longer than all other tests."""
    (project.folder / "tests").mkdir()
    for name in ("hard_cases.py", "stability.py"):
        shutil.copy(TESTS / name, project.folder / "tests")
    run = project.snakemake("stability", "--dry-run")
    assert run.returncode == 0, run.stdout + run.stderr
    outputs = set(re.findall(r"^ +output: (.*)$", run.stdout + run.stderr, re.MULTILINE))
    tables = {f"results/tiny/stability/{model}.csv" for model in registry.non_parametric()}
    assert outputs == tables | {"results/tiny/tables/stability.csv"}
