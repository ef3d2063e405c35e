"""What benchmarks read and conclude; what they measure is not a test."""

import json
import subprocess
import sys
from base64 import urlsafe_b64encode
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(autouse=True)
def scripts(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")


def note(project, outputs, rule, command, start, end):
    """Record a job as Snakemake 9 does: a file an output, its long name in pieces."""
    for output in outputs:
        coded = urlsafe_b64encode(output.encode()).decode()
        pieces = [coded[k : k + 20] for k in range(0, len(coded), 20)]
        names = [*("@" + piece for piece in pieces[:-1]), pieces[-1]]
        path = project.joinpath(".snakemake", "metadata", *names)
        path.parent.mkdir(parents=True, exist_ok=True)
        record = {"rule": rule, "shellcmd": command, "starttime": start, "endtime": end}
        path.write_text(json.dumps(record))


@pytest.fixture
def run(tmp_path):
    """The folder of a run of two materials, beside another run of the same project."""
    folder = tmp_path / "results" / "two"
    for name in ("materials/a.binary", "materials/b.binary", "fits/a.npz", "fits/a.json"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(b"12345")
    fits = ["results/two/fits/a.npz", "results/two/fits/a.json"]
    note(tmp_path, fits, "fit", "python -m npfm fit a --model x -o a.npz", 10.0, 14.0)
    note(tmp_path, ["results/two/materials/a.binary"], "material", "npfm material a", 8.0, 9.0)
    note(tmp_path, ["results/two/materials/b.binary"], "material", "npfm material b", 8.0, 10.0)
    note(tmp_path, ["results/twofold/fits/a.npz"], "fit", "npfm fit of another run", 0.0, 90.0)
    return folder


def test_jobs_of_a_run_count_once_with_all_they_made(run):
    import scaling

    table = scaling.runs([run], cores=2).set_index("rule")
    assert table["jobs"].to_dict() == {"fit": 1, "material": 2}
    assert table["seconds"].to_dict() == {"fit": 4, "material": 3}
    assert table["bytes"].to_dict() == {"fit": 10, "material": 10}
    assert set(table["materials"]) == {2}
    assert set(table["wall_seconds"]) == {6}


def test_jobs_are_repeated_with_outputs_of_their_own(run, tmp_path):
    import overhead

    kinds = overhead.kinds(run)
    assert {kind: count for kind, (_, count) in kinds.items()} == {
        "fit --model x": 1,
        "material": 2,
    }
    command = "python -m npfm scene --light in/l.exr --record out/s.json -o out/s 2> out/log"
    expected = "-m npfm scene --light in/l.exr --record /tmp/new/6/s.json -o /tmp/new/8/s"
    assert " ".join(overhead.redirected(command, "/tmp/new")) == expected


def test_what_grows_is_spread_over_cores_and_what_gathers_is_not(capsys):
    import scaling

    rows = [
        {"rule": rule, "materials": n, "jobs": jobs, "seconds": seconds, "bytes": n * 1e6}
        for n in (10, 30, 100)
        for rule, jobs, seconds in (
            ("fit", 4 * n, 36.0 * n),
            ("scene", 4, 900.0),
            ("psnr_table", 1, 60 + 0.12 * n),
        )
    ]
    scaling.predict(pd.DataFrame(rows), materials=1000, cores=100)
    *_, jobs, hours = capsys.readouterr().out.splitlines()
    assert jobs == "4005 jobs, 3 GB"
    # (36 000 + 900) s spread over 100 cores, then 180 s on one.
    assert hours == "10.3 core hours; on 100 cores at least 9 minutes, 3 of them on one core"


def test_the_exponent_of_a_power_is_found():
    import scaling

    assert scaling.exponent([1, 2, 4], [3.0, 12.0, 48.0]) == pytest.approx(2)


def test_fits_of_two_runs_are_compared_byte_by_byte(tmp_path):
    for run, last in (("before", b"1"), ("after", b"2")):
        for name, content in (("naive/a", b"0"), ("naive/b", last), (f"ggx/{run}", b"0")):
            path = tmp_path / run / "fits" / f"{name}.npz"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
    call = [
        sys.executable,
        ROOT / "benchmarks/same_fits.py",
        tmp_path / "before",
        tmp_path / "after",
    ]
    done = subprocess.run(call, capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stdout.splitlines() == [
        "ggx: 0 equal; in one run alone: ggx/after ggx/before",
        "naive: 1 equal; different: naive/b",
    ]
    assert subprocess.run([*call[:3], call[2]], capture_output=True).returncode == 0
