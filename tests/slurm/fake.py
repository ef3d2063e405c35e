"""A Slurm that starts at once whatever is submitted, on this machine, for tests without a real one.

`installed` makes its programs; each is this file, called with the name of one.
"""

import os
import shlex
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

PROGRAMS = ("sbatch", "srun", "sacct", "sinfo", "scancel")
#: File that names another: the first job of the group is lost when that one is there.
LOSE = "lose"
GROUP = "material"


def installed(folder: Path) -> Path:
    """Make the programs in a new folder, which is to be the first of PATH, and return that."""
    binaries = folder / "bin"
    binaries.mkdir(parents=True)
    for name in PROGRAMS:
        command = shlex.join([sys.executable, __file__, name, str(folder)])
        (binaries / name).write_text(f'#!/bin/sh\nexec {command} "$@"\n')
        (binaries / name).chmod(0o755)
    return binaries


def submitted(folder: Path) -> list[list[str]]:
    """Return the arguments of all submissions, in order."""
    jobs = sorted(folder.glob("[0-9]*"), key=lambda job: int(job.name))
    return [(job / "arguments").read_text().split("\0") for job in jobs]


def sbatch(folder: Path, *arguments: str) -> None:
    """Start a job, and print its number."""
    job = _new(folder)
    (job / "arguments").write_text("\0".join(arguments))
    (job / "state").write_text("RUNNING")
    lost = ""
    if any(f"rule_{GROUP}" in word for word in arguments):
        with suppress(FileNotFoundError):
            lost = (folder / LOSE).read_text()
            (folder / LOSE).unlink()
    [wrapped] = [word.removeprefix("--wrap=") for word in arguments if word.startswith("--wrap=")]
    with open(job / "log", "w") as log:
        subprocess.Popen(
            [sys.executable, __file__, "node", str(job), wrapped, lost],
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            start_new_session=True,
        )
    print(job.name)


def node(job: Path, wrapped: str, lost: str) -> None:
    """Run a job to its end, or until the file is there at which it is lost."""
    environment = os.environ | {"SLURM_JOB_ID": job.name}
    process = subprocess.Popen(wrapped, shell=True, env=environment, start_new_session=True)
    (job / "process").write_text(str(process.pid))
    while process.poll() is None:
        if lost and Path(lost).exists():
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            state = "NODE_FAIL"
            break
        time.sleep(0.02)
    else:
        state = "FAILED" if process.returncode else "COMPLETED"
    (job / "state").write_text(state)


def srun(folder: Path, *arguments: str) -> None:
    """Become the command that stands behind the options."""
    first = next(k for k, word in enumerate(arguments) if not word.startswith("-"))
    os.execvp(arguments[first], arguments[first:])


def sacct(folder: Path, *arguments: str) -> None:
    """Print the number and state of every job, if that is asked; there are no accounts."""
    if "--format=JobIdRaw,State" not in arguments:
        return
    for job in folder.glob("[0-9]*"):
        with suppress(FileNotFoundError):
            print(f"{job.name}|{(job / 'state').read_text()}")


def sinfo(folder: Path, *arguments: str) -> None:
    """Print the default partition."""
    print("all*")


def scancel(folder: Path, *arguments: str) -> None:
    """End all that still runs."""
    for job in folder.glob("[0-9]*"):
        if (job / "state").read_text() == "RUNNING":
            os.killpg(int((job / "process").read_text()), signal.SIGKILL)


def _new(folder: Path) -> Path:
    """Make the folder of the next job; Snakemake submits two at a time."""
    number = 1
    while True:
        try:
            (folder / f"{number}").mkdir()
            return folder / f"{number}"
        except FileExistsError:
            number += 1


if __name__ == "__main__":
    program, where, *words = sys.argv[1:]
    globals()[program](Path(where), *words)
