"""Gauss-Newton against AWLS, on one core: objectives, seconds and memory.

    python benchmarks/solvers.py results/neural-10/materials/*.binary -o solvers.csv

For each material and model, Gauss-Newton fits all channels from all starts, as `npfm fit` does.
AWLS then gets the same samples and starts and `BUDGET` times the seconds, shared evenly by the
starts. Seconds are of processor time.
A row of the table is a channel:

seconds             what Gauss-Newton took, all starts and preparations included
objective           what it reached, a share of the zero model's
awls_objective      the best that AWLS reached from any start in `GENEROUS` times the seconds
excess              objective / awls_objective - 1: at most 0.001, negative where it is lower
speed_up            seconds in which AWLS, all starts side by side, came within 0.1 % of
                    `objective`, over `seconds`; infinite if `BUDGET` was not enough
read_and_fit        seconds of the whole material, reading its file included
peak_mb             of a process that reads and fits the material
"""

import argparse
import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")

import pandas as pd

from npfm.fitting import registry
from npfm.fitting.objective import Objective
from npfm.fitting.solvers import awls
from npfm.fitting.solvers.choice import chosen
from npfm.fitting.solvers.problem import SolverSettings
from npfm.reflectance.merl import read_binary

MODELS = ("independent-g", "g-from-d", "naive", "bivariate")
GENEROUS, BUDGET, NEAR = 10, 25, 1e-3


class OutOfTime(Exception):
    """The seconds of a run are over."""


class Watched:
    """A problem that notes the objective after each iteration of AWLS, until time is over."""

    def __init__(self, problem, seconds):
        self.problem, self.deadline = problem, time.process_time() + seconds
        self.began, self.points = time.process_time(), []

    def __getattr__(self, name):
        return getattr(self.problem, name)

    def normalised(self, state):
        """End an iteration; called once in each."""
        state = self.problem.normalised(state)
        now = time.process_time()
        self.points.append((now - self.began, self.objective(state) / self.energy))
        if now > self.deadline:
            raise OutOfTime
        return state


def awls_points(problem, starts, seconds):
    """Points (seconds, objective) of AWLS from each start, of as many seconds each."""
    runs = []
    for name, start in starts.items():
        watched = Watched(problem, seconds)
        with suppress(OutOfTime):
            awls.minimise(watched, name, start, SolverSettings("awls", 1e-9, 10**9))
        runs.append(watched.points)
    return runs


def compare(path, model):
    """Rows of one material and model, one a channel."""
    asked = []
    solve = chosen(SolverSettings())

    def remembering(problem, starts):
        asked.append((problem, dict(starts)))
        return solve(problem, asked[-1][1])

    began = time.process_time()
    fit = registry.model(model).fit(read_binary(path), Objective(), remembering, 1)
    read_and_fit = time.process_time() - began
    for k, record in enumerate(fit.records):
        row = {"channel": record.channel, "read_and_fit": read_and_fit, "seconds": record.seconds}
        row["objective"] = record.objective
        if asked:
            # independent-g asks for g-from-d first: of each channel the last question counts
            problem, starts = asked[(k + 1) * len(asked) // len(fit.records) - 1]
            share = record.seconds / len(starts)
            runs = awls_points(problem, starts, BUDGET * share)
            within = [v for points in runs for t, v in points if t <= GENEROUS * share]
            enough = record.objective * (1 + NEAR)
            reached = [t for points in runs for t, v in points if v <= enough]
            row |= {
                "awls_objective": min(within),
                "excess": record.objective / min(within) - 1,
                "speed_up": min(reached, default=float("inf")) / share,
            }
        yield row


def peak_megabytes(path, model):
    """Peak memory of `npfm fit`, in a process of its own."""
    with TemporaryDirectory() as folder:
        call = [sys.executable, "-m", "npfm", "fit", path, "--model", model]
        process = subprocess.Popen([*call, "-o", f"{folder}/fit.npz"], stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{path}: npfm fit failed for {model}")
    return usage.ru_maxrss / 1024


def main():
    """Print the rows of each material and model while it goes, then medians and extremes."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("tables", nargs="+", help="MERL .binary files")
    parser.add_argument("--models", nargs="+", default=MODELS)
    parser.add_argument("-o", "--output", required=True, help="CSV to write")
    arguments = parser.parse_args()
    rows = []
    for path in arguments.tables:
        for model in arguments.models:
            head = {"material": Path(path).stem, "model": model}
            head["peak_mb"] = peak_megabytes(path, model)
            rows += [head | row for row in compare(path, model)]
            last = pd.DataFrame(rows[-3:])
            print(last.to_string(index=False, header=len(rows) == 3), flush=True)
            pd.DataFrame(rows).to_csv(arguments.output, index=False, float_format="%.6g")
    table = pd.DataFrame(rows).groupby("model", sort=False)
    print(
        table.agg(
            median_seconds=("read_and_fit", "median"),
            worst_seconds=("read_and_fit", "max"),
            median_excess=("excess", "median"),
            worst_excess=("excess", "max"),
            median_speed_up=("speed_up", "median"),
            peak_mb=("peak_mb", "max"),
        ).to_string()
    )


if __name__ == "__main__":
    main()
