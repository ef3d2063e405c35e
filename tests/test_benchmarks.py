"""What benchmarks read and conclude; what they measure is not a test."""

import json
import shutil
import subprocess
import sys
from base64 import urlsafe_b64encode
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from npfm.errors import NpfmError
from npfm.reflectance import microsurfaces
from npfm.reflectance.half_difference import MERL, HalfDifference
from npfm.reflectance.table import Table

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


@pytest.fixture
def ggx_header(tmp_path):
    """Names of the authors' header, for a GGX surface of alpha 0.3 whatever the table."""
    path = tmp_path / "theirs.h"
    path.write_text(r"""
#include <cmath>
#include <vector>
namespace djb {
typedef float float_t;
struct vec3 {
    float x, y, z;
    vec3(float theta, float phi) : x(std::sin(theta) * std::cos(phi)), y(0), z(std::cos(theta)) {}
    vec3(float x, float y, float z) : x(x), y(y), z(z) {}
};
struct merl { merl(const char *) {} };
struct tabular {
    std::vector<float> slopes;
    tabular(const merl&, int count) {
        for (int k = 0; k < count; ++k) {
            const double root = k / (count - 1.0), slope = std::tan(root * root * std::acos(0.0));
            slopes.push_back(k < count - 1 ? std::pow(1 + slope * slope / 0.09, -2.0) : 0);
        }
        DJB_LOG("djb_verbose: Slope PDF norm. constant = %.9f\n", 1.0);
        DJB_LOG("djb_verbose: Fresnel function ready\n");
    }
    const std::vector<float>& get_p22v() const { return slopes; }
    float ndf(const vec3& h) const { return std::pow(1 - 0.91 * h.z * h.z, -2); }
    vec3 fresnel(float cosine) const { return vec3(cosine, cosine / 2, 1); }
};
}
""")
    return path


@pytest.mark.skipif(shutil.which("c++") is None, reason="no C++ compiler is on the PATH")
def test_the_program_of_the_papers_authors_is_asked_and_understood(ggx_header, tmp_path):
    import power_iterations as benchmark

    with benchmark.Authors(benchmark.compiled(ggx_header, tmp_path), "any.binary") as authors:
        first, second = authors(), authors()
    np.testing.assert_array_equal(first.D, second.D)
    assert 0 <= first.seconds[0] <= first.seconds[1] <= first.seconds[2]
    D = microsurfaces.ggx(np.cos(MERL.theta_h), 0.3)
    np.testing.assert_allclose(first.D / first.D[0], D / D[0], rtol=1e-3)
    there = microsurfaces.ggx(np.cos((np.arange(89) / 89) ** 2 * np.pi / 2), 0.3)
    np.testing.assert_allclose(first.samples[:-1], there / there[0], rtol=1e-3)
    assert first.samples[-1] == 0
    cosine = np.cos(MERL.theta_d)
    np.testing.assert_allclose(first.F, [cosine, cosine / 2, np.ones(90)], rtol=1e-5)


@pytest.mark.skipif(shutil.which("c++") is None, reason="no C++ compiler is on the PATH")
def test_another_header_than_the_papers_authors_is_one_line(tmp_path):
    header = tmp_path / "other.h"
    header.write_text("namespace djb {}\n")
    call = [sys.executable, ROOT / "benchmarks/power_iterations.py", header, "any.binary"]
    done = subprocess.run(call, capture_output=True, text=True)
    assert done.returncode == 1
    [line] = done.stderr.splitlines()
    assert line.startswith(f"power_iterations: {header}: not compiled (")


def test_neither_header_nor_compiler_is_one_line(ggx_header, tmp_path, monkeypatch):
    import power_iterations as benchmark

    with pytest.raises(NpfmError, match=r"none\.h: No such file"):
        benchmark.compiled(tmp_path / "none.h", tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(NpfmError, match="no C\\+\\+ compiler"):
        benchmark.compiled(ggx_header, tmp_path)


def test_distributions_and_fresnel_factors_are_compared_whatever_their_scale():
    import power_iterations as benchmark

    low, high = np.zeros((2, 90))
    low[3], high[40] = 1, 1
    assert benchmark.moved(low, 5 * low) == pytest.approx(0, abs=1e-12)
    assert benchmark.moved(low, high) == pytest.approx(1)
    F = np.full((3, 90), 0.5)
    # Beyond 1, and beyond the theta_d that is compared, it does not matter how far.
    other = np.where(np.arange(90) < 80, F, 7.0)
    assert benchmark.unlike(F, other) == 0
    assert benchmark.unlike(F, F + 9) == pytest.approx(1)


def test_a_table_is_read_as_the_papers_authors_read_it():
    import power_iterations as benchmark

    values = np.zeros((3, 90, 2, 4))
    values[:, :, 0, 0] = np.arange(1, 91)
    values[:, :, 1] = 1
    values[0, 7, 1, 2] = -1
    read = benchmark.as_they_read(Table(values, HalfDifference(90, 2, 4))).values
    expected = np.append(np.ones(5), np.arange(6, 91))
    np.testing.assert_allclose(read[:, :, 0], np.tile(expected[:, None], (3, 1, 4)))
    assert read[:, 7, 1].tolist() == [[1, 1, -1, 1]] * 3


def test_our_fit_has_the_seconds_of_its_parts():
    import power_iterations as benchmark

    grid = HalfDifference(10, 10, 12)
    surface = microsurfaces.ggx(np.cos(grid.theta_h), 0.3)[:, None, None]
    table = Table(np.tile(np.where(grid.above_horizon, surface, -1.0), (3, 1, 1, 1)), grid)
    made = benchmark.ours(table, benchmark.folded(table), {"kernel": "paper", "fresnel": "mean"})
    assert 0 < made.seconds[1] < made.seconds[2]
    assert made.D.shape == (10,) and made.F.shape == (3, 10)
