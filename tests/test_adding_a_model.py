"""The example of docs/adding-a-model.md, exactly as printed, in a copy of the project."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import read_binary, write_binary
from npfm.reflectance.table import INVALID, Table

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "adding-a-model.md").read_text()
(EXAMPLE,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
(FILE,) = re.findall(r"Save it as `(.*?)`", PAGE)


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A copy of the project with the file of the page, and nothing else, added to it."""
    folder = tmp_path_factory.mktemp("project")
    for name in ("npfm", "workflow", "tests/models"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "config.yaml", "tests/conftest.py"):
        shutil.copy(ROOT / name, folder / name)
    (folder / FILE).write_text(EXAMPLE)
    return folder


def run(project, *arguments):
    """Run Python in the copy; return what it printed."""
    done = subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=project,
        env=os.environ | {"PYTHONPATH": str(project)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_example_passes_the_harness(project):
    harness = "tests/models/test_harness.py"
    said = run(project, "-m", "pytest", harness, "-k", "schlick", "-p", "no:cacheprovider")
    assert int(re.search(r"(\d+) passed", said)[1]) >= 20
    assert "skipped" not in said


def test_the_calls_of_the_page_fit_a_table_of_its_form(project, tmp_path):
    """Of a table that the model can meet exactly, so that the parameters are known."""
    rho_d, rho_s = 0.1, 2.0
    value = rho_d + rho_s * (1 - np.cos(MERL.theta_d[:, None])) ** 5
    values = np.where(MERL.above_horizon, value, INVALID)
    write_binary(project / "chrome.binary", Table(np.stack([values] * 3)))
    calls = re.findall(r"^    python (-m npfm (?:fit|tabulate) .*)$", PAGE, re.MULTILINE)
    assert len(calls) == 2
    for call in calls:
        run(project, *call.split())
    fitted = read_binary(project / "chrome-fitted.binary")
    assert (fitted.valid == MERL.above_horizon).all()
    np.testing.assert_allclose(
        fitted.values[fitted.valid], np.tile(values[values > 0], 3), rtol=1e-6
    )


def test_the_line_of_the_page_is_all_that_a_configuration_needs(project):
    line = re.search(r"^    (variants: .*schlick.*)$", PAGE, re.MULTILINE)[1]
    changes = yaml.safe_load(line) | {"name": "mine"}
    configuration = yaml.safe_load((ROOT / "config.yaml").read_text()) | changes
    (project / "mine.yaml").write_text(yaml.safe_dump(configuration))
    code = (
        "import yaml; from npfm.run import config, provenance;"
        "run = config.check(yaml.safe_load(open('mine.yaml')));"
        "print(run.fit_code('schlick')); print(*run.variants['schlick'].options);"
        "print(*provenance.closure(['npfm.models.schlick']))"
    )
    before, options, closure = run(project, "-c", code).splitlines()
    assert options.startswith("--model schlick ")
    assert "npfm.fitting.channels" in closure.split()
    assert "npfm.fitting.solvers.gauss_newton" not in closure.split()
    (project / FILE).write_text(EXAMPLE.replace("** 5", "** 4"))
    after = run(project, "-c", code).splitlines()[0]
    assert before != after
