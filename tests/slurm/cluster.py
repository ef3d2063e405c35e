"""A Slurm of one node, on this machine, from Debian's packages slurm-wlm and munge."""

import os
import secrets
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
KillWait=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory={megabytes}
PartitionName=all Nodes={host} Default=YES MaxTime=1440 State=UP
"""
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "srun", "squeue", "scancel", "sinfo")


@contextmanager
def started(folder: Path, cpus: int) -> Iterator[dict[str, str]]:
    """Start the daemons with all their files in `folder`; yield the environment for clients.

    The folder is made; munge asks that everybody may look into those above it.
    The daemons are ended by their process ids when the block ends.
    """
    missing = [program for program in PROGRAMS if shutil.which(program) is None]
    if missing:
        raise SystemExit(f"{', '.join(missing)}: not found; apt install slurm-wlm munge")
    configuration = _configure(folder, cpus)
    environment = os.environ | {
        "SLURM_CONF": str(configuration),
        "PATH": f"{_wrapped(folder / 'bin', configuration)}:{os.environ['PATH']}",
    }
    host, key = socket.gethostname().split(".")[0], folder / "munge.key"
    munge = [f"--socket={folder}/munge.socket", f"--key-file={key}"]
    munge += [f"--{kind}-file={folder}/munge.{kind}" for kind in ("pid", "log", "seed")]
    with ExitStack() as stack:
        for command in (
            ["munged", "--foreground", *munge],
            ["slurmctld", "-D", "-i", "-L", f"{folder}/slurmctld.log"],
            ["slurmd", "-D", "-N", host, "-L", f"{folder}/slurmd.log"],
        ):
            stack.enter_context(_daemon(command, environment, folder))
        wait_for(lambda: _state(environment) == "idle", "an idle node", seconds=60)
        yield environment


def wait_for(condition, what: str, seconds: float) -> None:
    """Ask again and again until the condition holds."""
    deadline = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > deadline:
            raise SystemExit(f"waited {seconds} s for {what}, in vain")
        time.sleep(0.2)


def _configure(folder: Path, cpus: int) -> Path:
    for name in (".", "state", "spool"):
        (folder / name).mkdir()
    (folder / "munge.key").write_bytes(secrets.token_bytes(128))
    (folder / "munge.key").chmod(0o400)
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    path = folder / "slurm.conf"
    path.write_text(
        CONFIGURATION.format(
            host=socket.gethostname().split(".")[0],
            user=subprocess.check_output(["id", "-un"], text=True).strip(),
            folder=folder,
            cpus=cpus,
            megabytes=memory // 2**20,
            controller_port=_free_port(),
            node_port=_free_port(),
        )
    )
    return path


def _wrapped(folder: Path, configuration: Path) -> Path:
    """Make an srun that finds the configuration: Snakemake's jobs drop SLURM_CONF."""
    folder.mkdir()
    srun = folder / "srun"
    srun.write_text(f'#!/bin/sh\nSLURM_CONF={configuration} exec {shutil.which("srun")} "$@"\n')
    srun.chmod(0o755)
    return folder


def _free_port() -> int:
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        return listening.getsockname()[1]


@contextmanager
def _daemon(command: list[str], environment: dict[str, str], folder: Path) -> Iterator[None]:
    with open(folder / f"{command[0]}.out", "w") as output:
        process = subprocess.Popen(command, env=environment, stdout=output, stderr=output)
    try:
        # Clients and the next daemon need the socket of munge and the port of the controller.
        time.sleep(1)
        if process.poll() is not None:
            raise SystemExit((folder / f"{command[0]}.out").read_text())
        yield
    finally:
        process.terminate()
        process.wait(timeout=60)


def _state(environment: dict[str, str]) -> str:
    run = subprocess.run(
        ["sinfo", "--noheader", "--format=%T"], env=environment, capture_output=True, text=True
    )
    return run.stdout.strip()
