"""Run the smoke preset on a real Slurm of one node, and compare with a run without it.

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
    alone, clustered = (_copied(folder / name) for name in ("alone", "clustered"))
    with started(folder / "slurm", cpus) as environment:
        version = subprocess.check_output(["sinfo", "--version"], env=environment, text=True)
        tell(f"{version.strip()}, one node, {cpus} cpus, files in {folder}")
        _snakemake(alone, environment, "--cores", str(cpus))
        tell("the same run without Slurm is done")
        run = _snakemake(clustered, environment, *SLURM)
        tell(f"Slurm ran {_submitted(run)} jobs")
        _same(alone, clustered)
        for profile in (["--cores", "1"], SLURM):
            assert "Nothing to be done" in _snakemake(clustered, environment, "-n", *profile)
        tell("nothing is left to do, with the profile or without")
        _lose_and_resubmit(clustered, environment)
        _same(alone, clustered)
        _lose_and_call_again(clustered, environment)
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


def _lose_and_resubmit(folder: Path, environment: dict[str, str]) -> None:
    """Kill the process of one job and cancel another; the profile submits both again."""
    _lose(folder, "independent-g")
    process = _start(folder, environment, *SLURM)
    _while_it_runs("fit", environment, lambda job: _kill(job, environment))
    _while_it_runs("render_fit", environment, lambda job: _cancel(job, environment))
    output, _ = process.communicate()
    assert process.returncode == 0, output
    assert output.count("Trying to restart job") == 2, output
    tell(f"killed one job and cancelled another; both submitted again, {_submitted(output)} in all")


def _lose_and_call_again(folder: Path, environment: dict[str, str]) -> None:
    """Cancel a job that is not submitted again; the run fails, and the next one completes it."""
    _lose(folder, "naive")
    process = _start(folder, environment, *SLURM, "--retries", "0")
    _while_it_runs("fit", environment, lambda job: _cancel(job, environment))
    output, _ = process.communicate()
    assert process.returncode == 1, output
    assert len(list((folder / "results/smoke/fits/naive").glob("*.npz"))) == 1
    before = _submitted(output)
    output = _snakemake(folder, environment, *SLURM)
    tell(f"cancelled a job without retries: exit code 1, {before} jobs in the first call,")
    tell(f"{_submitted(output)} in the second")


def _while_it_runs(rule: str, environment: dict[str, str], act: Callable[[str], bool]) -> None:
    """Act on a job of a rule while its process of npfm runs."""

    def done() -> bool:
        listed = _client(["squeue", "--noheader", "--states=running", "--format=%i %k"])
        jobs = [line.split(maxsplit=1) for line in listed.splitlines()]
        return any(act(job) for job, comment in jobs if f"rule_{rule}" in comment)

    def _client(command: list[str]) -> str:
        return subprocess.check_output(command, env=environment, text=True)

    wait_for(done, f"a job of {rule}", seconds=600)


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
