"""How cost grows with the number of materials, the size of pictures, and samples.

    python benchmarks/scaling.py scenes results/neural-10 B chrome -o scenes.csv
    python benchmarks/scaling.py runs results/ten results/thirty results/neural -o runs.csv
    python benchmarks/scaling.py draw --scenes scenes.csv --runs runs.csv -o scaling.pdf scaling.png
    python benchmarks/scaling.py predict runs.csv --materials 10000 --cores 200

`scenes` builds a scene of a finished run at other picture sizes and samples, and renders a material
in each. `runs` sums up the jobs of finished runs, rule by rule, from what Snakemake recorded; a run
should have been made in one go, from nothing. `draw` fits lines to both, and `predict` extends
those of the runs. The columns of the tables:

build_seconds, render_seconds   of CPU time
bytes                           of T, or of all files of a rule's outputs
jobs, seconds                   how many jobs of a rule, and the seconds of all of them together
wall_seconds                    from the first job of the run to its last, on `cores` cores
"""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from records import jobs, size

from npfm.figures import style
from npfm.reflectance.merl import read_binary
from npfm.rendering import transport

SIZES = (32, 64, 128, 192)
SHARES = (1 / 8, 1 / 4, 1 / 2, 1)
#: What the rules of a run do, for the figure; others are gathers.
KINDS = {
    "material": "tables",
    "fit": "fits",
    "light": "scenes",
    "scene": "scenes",
    "render_measured": "pictures",
    "render_fit": "pictures",
}


def scenes(run, scene, material):
    """Seconds and bytes of a scene, at other sizes and at other samples than its own."""
    run = Path(run)
    [command] = [
        record["shellcmd"]
        for record in jobs(run).values()
        if record["rule"] == "scene" and f"/scenes/{scene} " in f"{record['shellcmd']} "
    ]
    table = read_binary(run / "materials" / f"{material}.binary")
    pixels, samples = (
        int(re.search(rf"--{name} (\d+)", command)[1]) for name in ("resolution", "samples")
    )
    settings = [("size", n, samples) for n in SIZES]
    settings += [("samples", pixels, int(samples * share)) for share in SHARES]
    rows = []
    for varied, n, count in settings:
        options = re.sub(r"--resolution \d+", f"--resolution {n}", command.partition(" 2> ")[0])
        options = re.sub(r"--samples \d+", f"--samples {count}", options)
        options = re.sub(r" --record \S+| -o \S+", "", options)
        rows.append({"varied": varied, "size": n, "samples": count, **built(options, run, table)})
        print(rows[-1], file=sys.stderr)
    return pd.DataFrame(rows)


def built(command, run, table):
    """Seconds and bytes of a scene that a command builds, and seconds of a picture in it."""
    with TemporaryDirectory() as folder:
        words = [sys.executable, *shlex.split(command)[1:]]
        words += ["--record", f"{folder}/T.json", "-o", f"{folder}/T"]
        subprocess.run(words, cwd=run.resolve().parents[1], check=True)
        record = json.loads(Path(f"{folder}/T.json").read_text())
        matrix = transport.load(f"{folder}/T")
        times = []
        for _ in range(3):
            began = time.process_time()
            transport.render(matrix, table)
            times.append(time.process_time() - began)
    return {
        "build_seconds": record["seconds"],
        "render_seconds": min(times),
        "nonzeros": record["nonzeros"],
        "bytes": record["bytes"],
    }


def runs(folders, cores):
    """Jobs, seconds and bytes of each rule of some runs, and the wall time of each run."""
    rows = []
    for folder in map(Path, folders):
        records = pd.DataFrame(jobs(folder).values())
        wall = records["endtime"].max() - records["starttime"].min()
        count = len(list((folder / "materials").glob("*.binary")))
        for rule, made in records.groupby("rule"):
            rows.append(
                {
                    "run": folder.name,
                    "materials": count,
                    "cores": cores,
                    "wall_seconds": wall,
                    "rule": rule,
                    "jobs": len(made),
                    "seconds": (made["endtime"] - made["starttime"]).sum(),
                    "bytes": sum(size(path) for paths in made["outputs"] for path in paths),
                }
            )
    return pd.DataFrame(rows)


def line(x, y):
    """Intercept and slope of a straight line through points."""
    slope, intercept = np.polyfit(x, y, 1)
    return intercept, slope


def exponent(x, y):
    """Power of x that y grows with."""
    return line(np.log(x), np.log(y))[1]


def draw(scene_table, run_table):
    """Draw all of it; a line states how it grows."""
    with style.context():
        rows = 1 if run_table is None else 2
        figure = Figure(figsize=(style.PAGE_WIDTH, 2.7 * rows), layout="constrained")
        axes = figure.subplots(rows, 2, squeeze=False)
        if run_table is not None:
            draw_runs(axes[0], run_table)
        for ax, varied in zip(axes[-1], ("size", "samples"), strict=True):
            draw_scenes(ax, scene_table[scene_table["varied"] == varied], varied)
        for ax in axes.flat:
            style.plain_logarithmic(ax.xaxis)
            ax.set_xticks(ax.get_lines()[0].get_xdata())
            style.plain_logarithmic(ax.yaxis)
            ax.legend(frameon=False, loc="lower left", bbox_to_anchor=(0, 1))
            ax.grid(True)
            ax.set_axisbelow(True)
    return figure


def looks_of(names):
    """How each line is drawn."""
    return dict(zip(names, [*style.LOOKS.values(), *style.looks(names).values()], strict=False))


def draw_scenes(ax, table, varied):
    """Draw seconds and bytes of scenes against one setting."""
    columns = {
        "build_seconds": ("seconds to build T", 1),
        "render_seconds": ("seconds to render a material", 1),
        "bytes": ("GB of T", 1e9),
    }
    looks = looks_of(columns)
    for column, (label, unit) in columns.items():
        power = exponent(table[varied], table[column])
        label = f"{label} ~ {varied}^{power:.2f}"
        look = looks[column]
        ax.plot(
            table[varied], table[column] / unit, color=look.color, marker=look.marker, label=label
        )
    labels = {"size": "pixels along one side", "samples": "samples a pixel"}
    ax.set_xlabel(labels[varied])


def draw_runs(axes, table):
    """Draw seconds and bytes of runs against the number of their materials."""
    table = table.assign(kind=table["rule"].map(KINDS).fillna("gathers"))
    looks = looks_of(table["kind"].unique())
    for ax, (column, label, unit) in zip(
        axes, (("seconds", "s", 1.0), ("bytes", "MB", 1e6)), strict=True
    ):
        for kind, rows in table.groupby("kind", sort=False):
            sums = rows.groupby("materials")[column].sum() / unit
            fixed, each = np.round(line(sums.index, sums), 2) + 0.0  # no negative zero
            text = f"{kind}: {fixed:g} {each:+g} n {label}"
            ax.plot(
                sums.index, sums, color=looks[kind].color, marker=looks[kind].marker, label=text
            )
        ax.set_xlabel("materials, n")
    axes[0].set_ylabel("seconds of all jobs")
    axes[1].set_ylabel("MB of results")


def predict(table, materials, cores):
    """Jobs, seconds and bytes of each rule for another number of materials, and what that means.

    Scenes, and rules whose number of jobs grows with the materials, are spread over the cores;
    gathers wait for them and for each other. Snakemake's own time is not in it.
    """
    rows = []
    for rule, found in table.groupby("rule", sort=False):
        row = {"rule": rule}
        for column in ("jobs", "seconds", "bytes"):
            fixed, each = line(found["materials"], found[column])
            row[column] = max(fixed + each * materials, 0.0)
        row["spread"] = rule in KINDS or found["jobs"].nunique() > 1
        rows.append(row)
    table = pd.DataFrame(rows)
    spread, alone = (table.loc[table["spread"] == kind, "seconds"].sum() for kind in (True, False))
    print(table.round({"jobs": 0, "seconds": 0, "bytes": -6}).to_string(index=False))
    print(f"{table['jobs'].sum():.0f} jobs, {table['bytes'].sum() / 1e9:.0f} GB")
    print(f"{(spread + alone) / 3600:.1f} core hours; on {cores} cores at least", end=" ")
    print(f"{(spread / cores + alone) / 60:.0f} minutes, {alone / 60:.0f} of them on one core")


def arguments_of(parser):
    """Declare the arguments."""
    parts = parser.add_subparsers(dest="part", required=True)
    part = parts.add_parser("scenes")
    part.add_argument("run")
    part.add_argument("scene")
    part.add_argument("material")
    part = parts.add_parser("runs")
    part.add_argument("runs", nargs="+")
    part.add_argument("--cores", type=int, default=2)
    part = parts.add_parser("draw")
    part.add_argument("--scenes", required=True)
    part.add_argument("--runs")
    part = parts.add_parser("predict")
    part.add_argument("table")
    part.add_argument("--materials", type=int, required=True)
    part.add_argument("--cores", type=int, required=True)
    for name in ("scenes", "runs", "draw"):
        parts.choices[name].add_argument("-o", "--output", nargs="+", required=True)
    return parser.parse_args()


def main():
    """Measure, draw or predict."""
    a = arguments_of(argparse.ArgumentParser(description=__doc__.split("\n")[0]))
    match a.part:
        case "scenes":
            scenes(a.run, a.scene, a.material).to_csv(a.output[0], index=False)
        case "runs":
            runs(a.runs, a.cores).to_csv(a.output[0], index=False)
        case "draw":
            found = pd.read_csv(a.runs) if a.runs else None
            style.save(draw(pd.read_csv(a.scenes), found), a.output)
        case "predict":
            predict(pd.read_csv(a.table), a.materials, a.cores)


if __name__ == "__main__":
    main()
