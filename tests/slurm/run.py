"""Run the smoke preset on a real Slurm of one node, and compare with runs without it or its groups.

    python -m tests.slurm.run [cpus]

from the root of the repository, where npfm is installed with its extra `slurm`; the programs are
Debian's `slurm-wlm` and `munge`. It makes a temporary folder, keeps it if something is wrong, and
takes 10 minutes or more. Exit code 0: all results are the same, byte for byte.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from tests.outputs import untimed
from tests.slurm.cluster import started, wait_for

ROOT = Path(__file__).parents[2]
SMOKE = ["--configfile", "workflow/presets/smoke.yaml"]
#: This Slurm keeps no accounts, and its only node shares the disk with Snakemake.
SLURM = ["--profile", "workflow/profiles/slurm", "--slurm-no-account", "--slurm-status-command"]
SLURM += ["squeue", "--slurm-init-seconds-before-status-checks", "2", "--latency-wait", "5"]
BEGAN = time.monotonic()


def main(cpus: int) -> None:
    """Run everything, and tell of it."""
    folder = Path(tempfile.mkdtemp(prefix="npfm-slurm-"))
    folder.chmod(0o755)
    alone, clustered, apart = (_copied(folder / name) for name in ("alone", "clustered", "apart"))
    _ungroup(apart)
    slurm = [*SLURM, "--cores", str(cpus)]
    with started(folder / "slurm", cpus) as environment:
        version = subprocess.check_output(["sinfo", "--version"], env=environment, text=True)
        tell(f"{version.strip()}, one node, {cpus} cpus, files in {folder}")
        _, least = _timed(alone, environment, "--cores", str(cpus))
        tell(f"the same run without Slurm is done, in {least:.0f} s")
        grouped, seconds = _timed(clustered, environment, *slurm)
        _same(alone, clustered)
        single, longer = _timed(apart, environment, *slurm)
        _same(alone, apart)
        jobs = _submitted(single)
        for output, taken in ((grouped, seconds), (single, longer)):
            tell(
                f"{jobs} jobs in {_submitted(output)} submissions: {taken:.0f} s, "
                f"{(taken - least) / jobs:.2f} s a job more than without Slurm"
            )
        for profile in (["--cores", "1"], slurm):
            assert "Nothing to be done" in _snakemake(clustered, environment, "-n", *profile)
        tell("nothing is left to do, with the profile or without")
        _lose_and_resubmit(clustered, environment, slurm)
        _same(alone, clustered)
        _lose_and_call_again(clustered, environment, slurm)
        _same(alone, clustered)
    shutil.rmtree(folder)


def tell(what: str) -> None:
    """Print a line with the seconds since the start."""
    print(f"{time.monotonic() - BEGAN:6.0f} s  {what}", flush=True)


def _copied(folder: Path) -> Path:
    """Copy the code of the project."""
    for name in ("npfm", "workflow", "profiles"):
        shutil.copytree(ROOT / name, folder / name)
    for name in ("Snakefile", "config.yaml"):
        shutil.copy(ROOT / name, folder)
    return folder


def _ungroup(folder: Path) -> None:
    """Have every job submitted by itself."""
    for rules in (folder / "workflow" / "rules").glob("*.smk"):
        rules.write_text(re.sub(r"\n    group:\n {8}.*", "", rules.read_text()))


def _start(folder: Path, environment: dict[str, str], *arguments: str) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-m", "snakemake", *SMOKE, *arguments],
        cwd=folder,
        env=environment | {"PYTHONPATH": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def _snakemake(folder: Path, environment: dict[str, str], *arguments: str) -> str:
    """Run Snakemake to a good end; return what it wrote."""
    process = _start(folder, environment, *arguments)
    output, _ = process.communicate()
    assert process.returncode == 0, output
    return output


def _timed(folder: Path, environment: dict[str, str], *arguments: str) -> tuple[str, float]:
    """Run Snakemake to a good end; return what it wrote, and its seconds."""
    began = time.monotonic()
    return _snakemake(folder, environment, *arguments), time.monotonic() - began


def _submitted(output: str) -> int:
    return len(re.findall("has been submitted with SLURM jobid", output))


def _same(alone: Path, clustered: Path) -> None:
    one, other = (untimed(folder / "results" / "smoke") for folder in (alone, clustered))
    differing = [name for name in sorted({*one, *other}) if one.get(name) != other.get(name)]
    assert not differing, differing
    tell(f"{len(one)} files are the same, byte for byte")


def _lose(folder: Path, variant: str) -> None:
    """Remove the fits of a variant and what they lead to."""
    results = folder / "results" / "smoke"
    shutil.rmtree(results / "fits" / variant)
    shutil.rmtree(results / "tables")
    for picture in results.glob(f"renders/*/*/{variant}.*"):
        picture.unlink()


def _lose_and_resubmit(folder: Path, environment: dict[str, str], slurm: list[str]) -> None:
    """Kill a process of one group and cancel another group; the profile submits both again."""
    _lose(folder, "independent-g")
    process = _start(folder, environment, *slurm)
    killed = _while_one_runs(environment, lambda job: _kill(job, environment))
    _while_one_runs(environment, lambda job: job != killed and _cancel(job, environment))
    output, _ = process.communicate()
    assert process.returncode == 0, output
    assert output.count("Trying to restart job") == 2, output
    tell(f"killed one group, cancelled another; both submitted again, {_submitted(output)} in all")


def _lose_and_call_again(folder: Path, environment: dict[str, str], slurm: list[str]) -> None:
    """Cancel a group that is not submitted again; the run fails, and the next one completes it."""
    _lose(folder, "naive")
    process = _start(folder, environment, *slurm, "--retries", "0")
    _while_one_runs(environment, lambda job: _cancel(job, environment))
    output, _ = process.communicate()
    assert process.returncode == 1, output
    assert len(list((folder / "results/smoke/fits/naive").glob("*.npz"))) == 1
    before = _submitted(output)
    output = _snakemake(folder, environment, *slurm)
    tell(f"cancelled a group without retries: exit code 1, {before} submissions in the first call,")
    tell(f"{_submitted(output)} in the second")


def _while_one_runs(environment: dict[str, str], act: Callable[[str], bool]) -> str:
    """Act on the group of a material while a process of npfm runs in it; return its number."""
    acted: list[str] = []

    def done() -> bool:
        command = ["squeue", "--noheader", "--states=running", "--format=%i %k"]
        listed = subprocess.check_output(command, env=environment, text=True)
        jobs = [line.split(maxsplit=1) for line in listed.splitlines()]
        acted.extend(job for job, comment in jobs if "rule_material" in comment and act(job))
        return bool(acted)

    wait_for(done, "the group of a material", seconds=600)
    return acted[0]


def _processes(job: str, environment: dict[str, str]) -> list[int]:
    """Process ids of npfm in a job."""
    command = ["scontrol", "listpids", job]
    listed = subprocess.run(command, env=environment, capture_output=True, text=True).stdout
    found = []
    for line in listed.splitlines()[1:]:
        pid = int(line.split()[0])
        try:
            words = Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
        except FileNotFoundError:
            continue
        if words[1:3] == [b"-m", b"npfm"]:
            found.append(pid)
    return found


def _kill(job: str, environment: dict[str, str]) -> bool:
    found = _processes(job, environment)
    for pid in found:
        os.kill(pid, signal.SIGKILL)
    return bool(found)


def _cancel(job: str, environment: dict[str, str]) -> bool:
    return bool(_processes(job, environment)) and not subprocess.call(
        ["scancel", job], env=environment
    )


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("terminated"))  # ends the daemons as well
    main(int(sys.argv[1]) if len(sys.argv) > 1 else len(os.sched_getaffinity(0)))
