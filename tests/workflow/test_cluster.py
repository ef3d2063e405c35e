"""What a cluster is told; tests/slurm/run.py runs the workflow on a real one."""

import re
from pathlib import Path

import pytest
from snakemake.cli import parse_args

ROOT = Path(__file__).parents[2]
TEXT = "".join(p.read_text() for p in sorted((ROOT / "workflow" / "rules").glob("*.smk")))
#: Rules by name: what they are made from, if from another, and their own text.
RULES = {
    match[2]: (match[1], match[3])
    for match in re.finditer(
        r"^(?:use rule (\w+) as|rule) (\w+)(?: with)?:\n((?:\n* .*\n?)*)", TEXT, re.MULTILINE
    )
}
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
    own = re.search(rf"^ {{8}}{key}=(\d+),$", text, re.MULTILINE)
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
