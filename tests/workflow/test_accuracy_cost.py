import re


def test_the_target_is_asked_for_by_name_and_fits_nothing_twice(finished):
    """Not run here: it would take as long as all other tests of the workflow."""
    run = finished.snakemake("accuracy_cost", "--dry-run")
    assert run.returncode == 0, run.stdout + run.stderr
    outputs = re.findall(r"^ +output: (.*)$", run.stdout + run.stderr, re.MULTILINE)
    made = {name for line in outputs for name in line.split(", ")}
    folder = "results/tiny/accuracy_cost"
    assert f"{folder}/fits/starts-1/chalk.npz" in made
    assert f"{folder}/fits/model-naive-awls/chalk.npz" in made
    # The run itself has naive by gauss-newton, and starts-8 is the same as independent-g.
    assert f"{folder}/fits/model-naive-gauss-newton/chalk.npz" not in made
    assert f"{folder}/fits/model-independent-g-gauss-newton/chalk.npz" in made
    assert f"{folder}/fits/starts-8/chalk.npz" not in made
    assert f"{folder}/scenes/half-vector-4" in made
    assert f"{folder}/scenes/reference.json" in made
    assert "results/tiny/tables/accuracy_cost.csv" in made
    figures = {name for name in made if name.startswith("results/tiny/figures/")}
    assert len(figures) == 2 * 4
