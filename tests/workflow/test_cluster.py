"""What a cluster is told; tests/slurm/run.py runs the workflow on a real one."""

import re
from pathlib import Path

import pytest
from snakemake.cli import parse_args

ROOT = Path(__file__).parents[2]
RULES = {
    match[1]: match[2]
    for path in sorted((ROOT / "workflow" / "rules").glob("*.smk"))
    for match in re.finditer(r"^rule (\w+):\n((?:\n* .*\n?)*)", path.read_text(), re.MULTILINE)
    if "    shell:\n" in match[2]
}
LOCAL = {
    name
    for path in sorted((ROOT / "workflow" / "rules").glob("*.smk"))
    for names in re.findall(r"^localrules:\n((?: {4}\w+,\n)+)", path.read_text(), re.MULTILINE)
    for name in re.findall(r"\w+", names)
}


def test_what_gathers_is_local_and_what_computes_is_not():
    assert {"psnr_table", "fits_table", "figure08"} <= LOCAL <= set(RULES)
    assert not LOCAL & {"fit", "scene", "render_measured", "render_fit"}


@pytest.mark.parametrize("name", sorted(RULES))
def test_every_job_says_how_much_memory_and_how_many_minutes_it_needs(name):
    """The minutes of local ones go nowhere."""
    assert re.search(r"^ {8}mem_mb=\d+,$", RULES[name], re.MULTILINE), "add mem_mb to resources"
    timed = re.search(r"^ {8}runtime=\d+,$", RULES[name], re.MULTILINE)
    assert bool(timed) == (name not in LOCAL), "add runtime to resources, or name it in localrules"


def test_the_profile_keeps_the_settings_of_the_default_one(monkeypatch):
    pytest.importorskip("snakemake_executor_plugin_slurm", reason="needs the extra slurm")
    monkeypatch.chdir(ROOT)
    _, settings = parse_args(["--profile", "workflow/profiles/slurm"])
    assert settings.executor == "slurm"
    assert settings.retries == 1
    assert settings.keep_going and settings.rerun_incomplete and settings.show_failed_logs
    assert settings.max_checksum_file_size > 34_992_012
    assert settings.scheduler == "greedy"
