"""What a cluster is told; tests/slurm/run.py runs the workflow on a real one."""

import os
import re
from pathlib import Path

import pytest
from snakemake.cli import parse_args

from tests.outputs import untimed
from tests.slurm import fake

ROOT = Path(__file__).parents[2]
TEXT = "".join(p.read_text() for p in sorted((ROOT / "workflow" / "rules").glob("*.smk")))
#: Rules by name: what they are made from, if from another, and their own text.
RULES = {
    match[2]: (match[1], match[3])
    for match in re.finditer(
        r"^(?:use rule (\w+) as|rule) (\w+)(?: with)?:\n((?:\n* .*\n?)*)", TEXT, re.MULTILINE
    )
}
#: What the page of claims, figures and tables are asked for by: rules that are made from no other.
TARGETS = sorted(name for name, (base, text) in RULES.items() if not base and name != "npfm")
SLURM = ["--profile", "workflow/profiles/slurm", "--slurm-init-seconds-before-status-checks", "1"]
JOBS = sorted(name for name, (base, text) in RULES.items() if base)
LOCAL = {
    name
    for names in re.findall(r"^ *localrules:\n((?: +\w+,\n)+)", TEXT, re.MULTILINE)
    for name in re.findall(r"\w+", names)
}


def resource(name, key):
    """A resource of a rule: those of the rule it is made from count if it has none of its own."""
    base, text = RULES[name]
    if base and "    resources:\n" not in text:
        return resource(base, key)
    own = re.search(rf"^ {{8}}{key}=(?:lambda [\w, ]+: )?(\d+)\b.*,$", text, re.MULTILINE)
    return own and int(own[1])


def test_what_gathers_is_local_and_what_computes_is_not():
    assert {"psnr_table", "fits_table", "figure08", "material"} <= LOCAL <= set(JOBS)
    assert not LOCAL & {"fit", "scene", "render_measured", "render_fit"}


@pytest.mark.parametrize("name", JOBS)
def test_every_job_says_how_much_memory_and_how_many_minutes_it_needs(name):
    """The minutes of local ones go nowhere."""
    assert resource(name, "mem_mb") >= 500
    always_local = name in LOCAL - {"material"}
    assert (resource(name, "runtime") is None) == always_local, "add runtime to resources"


def test_the_profile_keeps_the_settings_of_the_default_one(monkeypatch):
    pytest.importorskip("snakemake_executor_plugin_slurm", reason="needs the extra slurm")
    monkeypatch.chdir(ROOT)
    _, settings = parse_args(["--profile", "workflow/profiles/slurm"])
    assert settings.executor == "slurm"
    assert settings.retries == 1
    assert settings.keep_going and settings.rerun_incomplete and settings.show_failed_logs
    assert settings.max_checksum_file_size > 34_992_012
    assert settings.scheduler == "greedy"


def test_no_group_waits_for_itself(fresh):
    """Whatever is made: what a job of a group waits for is in it, or needs nothing of it."""
    run = fresh.snakemake("--dry-run", *TARGETS)
    assert run.returncode == 0, run.stdout[-2000:] + run.stderr[-2000:]
    assert "Group job material" in run.stdout + run.stderr


def test_a_lost_group_is_submitted_again_and_ends_in_the_same_bytes(finished, fresh, monkeypatch):
    pytest.importorskip("snakemake_executor_plugin_slurm", reason="needs the extra slurm")
    cluster = fresh.folder.parent / "slurm"
    monkeypatch.setenv("PATH", f"{fake.installed(cluster)}:{os.environ['PATH']}")
    results = fresh.folder / "results" / "tiny"
    # A fit is there, so that others of the group are not, and no picture.
    (cluster / fake.LOSE).write_text(str(results / "fits" / "naive" / "chalk.npz"))
    run = fresh.snakemake("results/tiny/quality/chalk.csv", *SLURM)
    assert run.returncode == 0, run.stdout + run.stderr
    scene, lost, again = fake.submitted(cluster)
    for job, minutes in (
        (scene, 10 + 20),  # a light, then both of its scenes
        (lost, 10 + 2 * 15 + 2 * 10 + 15),  # a material, three fits, three pictures, their rows
        (again, 10 + 2 * 60 + 2 * 10 + 15),
    ):
        assert job[job.index("-t") + 1] == f"{minutes}"
        assert "--cpus-per-task=2" in job
    assert scene[scene.index("--mem") + 1] == "6000"
    assert again[again.index("--mem") + 1] == "4000"
    there, theirs = untimed(results), untimed(finished.folder / "results" / "tiny")
    assert {"quality/chalk.csv", "renders/C/chalk/naive.exr"} <= set(there)
    assert there == {name: theirs[name] for name in there}
    assert "Nothing to be done" in fresh.snakemake("results/tiny/quality/chalk.csv").stderr
