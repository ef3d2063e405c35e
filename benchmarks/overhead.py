"""What a job costs before its work begins, and how processes share a transport matrix.

    python benchmarks/overhead.py results/neural-10

repeats one job of every rule and variant of a finished run, its outputs sent elsewhere, and prints
a row for each:

rule            name of the rule, and the variant if it fits one
jobs            how many such jobs the run has
start           seconds of CPU time that the interpreter takes alone
overhead        the same with all that the job imports, at any time
job             seconds of CPU time of the whole job
peak_mb         largest resident set of the job

`start` and `overhead` are the least of `REPEATS`, which other work on the machine disturbs least.
Then come the median of the overhead over all jobs, and the memory of processes that render in the
largest scene side by side: their resident sets, and how much of them is shared.
"""

import argparse
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd
from records import jobs

REPEATS, SIDE_BY_SIDE = 5, 3
#: Options that name a file or folder to write.
WRITTEN = ("-o", "--record", "--pictures")
RENDERING = """
import sys
import numpy as np
from npfm.rendering import transport
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
matrix = transport.load(sys.argv[1])
transport.render(matrix, Table(np.full((3, *MERL.shape), 0.1)))
print("rendered", flush=True)
sys.stdin.read()
"""
IMPORTING = """
import importlib, sys
for name in sys.argv[1:]:
    importlib.import_module(name)
"""


def kinds(run):
    """One command of each kind of job of a run, and the number of such jobs."""
    found = {}
    for command, record in jobs(run).items():
        variant = re.findall(r"--model \S+", command)
        found.setdefault(" ".join([record["rule"], *variant]), []).append(command)
    return {kind: (min(commands), len(commands)) for kind, commands in sorted(found.items())}


def redirected(command, folder):
    """Arguments of the Python of a command, with what it writes in a folder."""
    words = shlex.split(command.partition(" 2> ")[0])[1:]
    option = ""
    for k, word in enumerate(words):
        if word.startswith("-"):
            option = word
        elif option in WRITTEN:
            # Of several outputs, each has a place of its own, whatever its name.
            words[k] = str(Path(folder) / str(k) / Path(word).name)
    return words


def measured(arguments):
    """Seconds of CPU time and largest resident set (MB) of a Python, and what it wrote."""
    with subprocess.Popen(
        [sys.executable, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as process:
        written = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(f"{shlex.join(arguments)}: {written}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, written


def least(arguments):
    """Least seconds of CPU time of a Python."""
    return min(measured(arguments)[0] for _ in range(REPEATS))


def imports(written):
    """Modules that were imported first hand, in order, as -X importtime tells."""
    return re.findall(r"^import time: .*\| ([\w.]+)$", written, re.MULTILINE)


def row(rule, command, count):
    """A row of the table."""
    with TemporaryDirectory() as folder:
        arguments = redirected(command, folder)
        seconds, peak, _ = measured(arguments)
        modules = imports(measured(["-X", "importtime", *arguments])[2])
    return {
        "rule": rule,
        "jobs": count,
        "start": least(["-c", "pass"]),
        "overhead": least(["-c", IMPORTING, *modules]),
        "job": seconds,
        "peak_mb": peak,
    }


def memory(pid):
    """Resident, proportional and private memory of a process in MB."""
    text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    kb = {name: int(size) for name, size in re.findall(r"^(\w+): +(\d+) kB", text, re.MULTILINE)}
    private = kb["Private_Clean"] + kb["Private_Dirty"]
    return {"rss_mb": kb["Rss"] / 1024, "pss_mb": kb["Pss"] / 1024, "private_mb": private / 1024}


def sharing(scene):
    """Memory of each of some processes that have rendered in a scene, before any of them ends."""
    command = [sys.executable, "-c", RENDERING, str(scene)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    processes = [subprocess.Popen(command, **pipes) for _ in range(SIDE_BY_SIDE)]
    for process in processes:
        process.stdout.readline()
    found = pd.DataFrame([memory(process.pid) for process in processes])
    for process in processes:
        process.communicate()
    return found


def main():
    """Measure, and print."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("run", help="folder of a finished run, results/<name>")
    parser.add_argument("--rules", nargs="+", help="only these rules")
    arguments = parser.parse_args()
    commands = kinds(arguments.run)
    os.chdir(Path(arguments.run).parents[1])
    rows = []
    for rule, (command, count) in commands.items():
        if not arguments.rules or rule.split()[0] in arguments.rules:
            rows.append(row(rule, command, count))
            print(f"{rule} measured", file=sys.stderr)
    table = pd.DataFrame(rows)
    print(table.round(2).to_string(index=False))
    every = table["overhead"].repeat(table["jobs"])
    print(f"\nmedian overhead of all {len(every)} jobs: {every.median():.2f} s")
    scenes = Path(*Path(arguments.run).parts[-2:]).glob("scenes/*/weights.npy")
    largest = max(scenes, key=lambda path: path.stat().st_size).parent
    size = sum(path.stat().st_size for path in largest.iterdir()) / 2**20
    print(f"\n{SIDE_BY_SIDE} processes that render in {largest} ({size:.0f} MB) side by side:")
    print(sharing(largest).round(0).to_string(index=False))


if __name__ == "__main__":
    main()
