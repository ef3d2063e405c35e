"""Runs that end too early, on the real Snakefile: what is there is whole, the next run goes on."""

import os
import resource
import shutil
import signal
import subprocess
import time

from tests.outputs import untimed

#: All but most figures, which are made from the same tables.
TARGETS = ("tables", "results/tiny/figures/table1.csv", "results/tiny/figures/figure07.png")


def visible(project):
    """Outputs by name, without the hidden ones that a killed writer leaves."""
    found = untimed(project.folder / "results" / "tiny")
    return {
        name: content
        for name, content in found.items()
        if not any(part.startswith(".") for part in name.split("/"))
    }


def run_and_kill_when(project, there):
    """Start a run; kill all its processes, without warning, as soon as some file is there."""
    quiet = subprocess.DEVNULL
    with project.start(*TARGETS, stdout=quiet, stderr=quiet, start_new_session=True) as run:
        while run.poll() is None and not any((project.folder / "results" / "tiny").glob(there)):
            time.sleep(0.001)
        assert run.poll() is None, "the run was over before it could be killed"
        os.killpg(run.pid, signal.SIGKILL)


def test_a_run_on_a_full_disk_or_killed_is_taken_up_where_it_stopped(finished, fresh):
    """Same seed, same bytes: whatever happens to a run, it ends as one that nothing disturbed."""
    whole = visible(finished)
    assert len(whole) > 20

    def limited():
        # The system refuses the rest of a file as on a full disk; tables of 35 MB do not fit.
        resource.setrlimit(resource.RLIMIT_FSIZE, (2**24, 2**24))

    run = fresh.snakemake(*TARGETS, preexec_fn=limited)
    assert run.returncode == 1
    message = "npfm material: results/tiny/materials/chalk.binary: no room to write it; "
    assert message + "free some space, run again" in run.stdout + run.stderr
    partial = visible(fresh)
    assert "lights/cathedral.exr" in partial and "scenes/C/indices.npy" in partial
    assert not list((fresh.folder / "results/tiny").glob("materials/*"))
    assert partial.items() <= whole.items()

    for there in ("materials/.chalk.*.binary", "renders/*/*/*.png"):
        run_and_kill_when(fresh, there)
        assert partial.items() <= visible(fresh).items() <= whole.items()
        partial = visible(fresh)
        assert fresh.snakemake("--unlock").returncode == 0

    left = fresh.planned(*TARGETS)
    assert "materials/chalk.binary" not in left
    assert "figures/table1.csv" in left
    done = [fresh.folder / "results" / "tiny" / name for name in partial if name not in left]
    before = [file.stat().st_mtime_ns for file in done]
    run = fresh.snakemake(*TARGETS)
    assert run.returncode == 0, run.stdout + run.stderr
    assert {"tables/psnr.csv", "figures/figure07.pdf"} <= set(visible(fresh))
    assert visible(fresh).items() <= whole.items()
    assert not fresh.planned(*TARGETS)
    assert [file.stat().st_mtime_ns for file in done] == before


def test_a_broken_file_of_the_user_stops_no_other_material(project):
    brdfs = project.folder / "brdfs"
    brdfs.mkdir()
    table = project.folder / "results/tiny/materials/chalk.binary"
    shutil.copy(table, brdfs / "good.binary")
    (brdfs / "broken.binary").write_bytes(table.read_bytes()[:-8])
    materials = {"kind": "merl", "path": str(brdfs), "materials": ["broken", "good"]}
    project.configure(dataset=materials, scenes={"A": project.config["scenes"]["A"]})
    run = project.snakemake()
    assert run.returncode == 1
    said = [line.strip() for line in run.stderr.splitlines() if "npfm material:" in line]
    assert len(said) == 1
    assert said[0] == (
        f"npfm material: {brdfs}/broken.binary: 34992004 bytes, a MERL file has 34992012; "
        "the file is cut off or damaged, copy or download it again"
    )
    results = project.folder / "results" / "tiny"
    for variant in ("bivariate", "naive", "old"):
        assert (results / "fits" / variant / "good.npz").exists()
        assert (results / "renders" / "A" / "good" / f"{variant}.exr").exists()
    assert not list(results.rglob("*broken*.np*"))
    os.replace(brdfs / "good.binary", brdfs / "broken.binary")
    shutil.copy(brdfs / "broken.binary", brdfs / "good.binary")
    assert {name for name in project.planned() if "good" in name} == set()
