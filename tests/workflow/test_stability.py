import re

from npfm.fitting import registry


def test_the_target_fits_every_model(finished):
    """Not run here: it would take longer than all other tests."""
    run = finished.snakemake("stability", "--dry-run")
    assert run.returncode == 0, run.stdout + run.stderr
    outputs = set(re.findall(r"^ +output: (.*)$", run.stdout + run.stderr, re.MULTILINE))
    tables = {f"results/tiny/stability/{model}.csv" for model in registry.fitted()}
    assert outputs == tables | {"results/tiny/tables/stability.csv"}
