"""The workflow run from a folder that is not the project's."""

import os
import subprocess
import sys

import pytest


@pytest.mark.parametrize("arguments", [[], ["--directory", "there"]])
def test_config_is_beside_the_snakefile_and_results_are_where_it_runs(fresh, tmp_path, arguments):
    """Without npfm on any path: it is found beside the Snakefile as well."""
    start = tmp_path / "start"
    (start / "there").mkdir(parents=True)
    snakefile = ["--snakefile", str(fresh.folder / "Snakefile")]
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    run = subprocess.run(
        [
            *(sys.executable, "-P", "-m", "snakemake", "--cores", "1"),
            *("results/tiny/materials/chalk.binary", *snakefile, *arguments),
        ],
        cwd=start,
        env=environment,
        capture_output=True,
        text=True,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert "profiles/default" in run.stderr
    worked_in = start / arguments[-1] if arguments else start
    assert (worked_in / "results/tiny/materials/chalk.binary").is_file()
    assert not (fresh.folder / "results").exists()
