import fcntl
import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
SCENE = {"objects": ["sphere"], "effects": [], "samples": 64, "exposure": 0.02, "gamma": 2.2}
CONFIG = {
    "name": "tiny",
    "data": "data",
    "published_fits": "published_fits",
    "dataset": {"kind": "synthetic", "materials": ["chalk"]},
    "objective": {"compressive": True, "max_angle": 89.0},
    "solver": {"method": "gauss-newton", "tolerance": 1e-3, "max_iterations": 5, "seed": 1},
    "models": {"independent-g": {"starts": 8}},
    "variants": [
        "bivariate",
        "naive",
        {"name": "old", "model": "naive", "solver": {"method": "awls"}},
    ],
    "colors": {},
    "lights": {name: {"generate": name} for name in ("cathedral", "grove")},
    "light_height": 16,
    "scenes": {
        "A": SCENE | {"light": "cathedral"},
        "C": SCENE
        | {"light": "cathedral", "objects": ["figure", "sphere"], "effects": ["visibility"]},
    },
    "resolution": 8,
    "accuracy_cost": {
        "materials": ["chalk"],
        "awls_iterations": 2,
        "scene": "A",
        "resolution": 8,
        "samples": [2, 4],
        "reference_samples": 16,
    },
    "gallery": {"measured": ["*"]},
    "video": {"variants": ["independent-g", "naive"], "turns": 3, "resolution": 8, "samples": 32},
    "blends": {"materials": ["chalk"], "variant": "independent-g", "curves": 2, "steps": [2]},
    "bounces": {
        "materials": ["chalk"],
        "resolution": 4,
        "paths": 8,
        "seconds": 0.01,
        "reference_paths": 8,
    },
    "exports": {"csv": ["g-from-d"]},
    "importance": {
        "materials": ["chalk", "no-such"],
        "formulas": [],
        "resolution": 6,
        "points": 16,
        "samples": [4, 8],
        "repetitions": 2,
    },
    "psnr_level": {
        "materials": ["ch*", "no-such"],
        "variants": ["naive", "no-such"],
        "resolutions": [12],
        "turns": [180],
    },
    "stability": {"starts": 1, "awls_iterations": 2},
}


@dataclass(frozen=True)
class Project:
    """A copy of the project that tests may edit."""

    folder: Path
    config = CONFIG

    def start(self, *arguments: str, **options) -> subprocess.Popen:
        """Start Snakemake in the copy, on the copied package; `options` are those of Popen."""
        return subprocess.Popen(
            [sys.executable, "-m", "snakemake", "--cores", "2", *arguments],
            cwd=self.folder,
            env=os.environ | {"PYTHONPATH": str(self.folder)},
            text=True,
            **options,
        )

    def snakemake(self, *arguments: str, **options) -> subprocess.CompletedProcess:
        """Run Snakemake to its end."""
        pipe = subprocess.PIPE
        with self.start(*arguments, stdout=pipe, stderr=pipe, **options) as run:
            output, errors = run.communicate()
        return subprocess.CompletedProcess(run.args, run.returncode, output, errors)

    def configure(self, **changes) -> None:
        """Write config.yaml anew, with top-level keys replaced."""
        text = yaml.safe_dump(CONFIG | changes, allow_unicode=True)
        (self.folder / "config.yaml").write_text(text)

    def edit(self, file: str, old: str, new: str) -> None:
        """Replace text in a file of the copy."""
        path = self.folder / file
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))

    def planned(self, *targets: str) -> set[str]:
        """Files that a run would make now, below results/tiny, for some targets or for all."""
        run = self.snakemake("--dry-run", *targets)
        assert run.returncode == 0, run.stdout + run.stderr
        outputs = re.findall(r"^ +output: (.*)$", run.stdout + run.stderr, re.MULTILINE)
        return {name.removeprefix("results/tiny/") for line in outputs for name in line.split(", ")}


def copied(folder: Path) -> Project:
    """Copy the project's code, and what numba has compiled of it, but no half-written file."""
    ignore = shutil.ignore_patterns("*.tmp.*", "*.pyc*")
    for name in ("npfm", "workflow", "profiles"):
        shutil.copytree(ROOT / name, folder / name, ignore=ignore)
    shutil.copy(ROOT / "Snakefile", folder)
    project = Project(folder)
    project.configure()
    return project


@pytest.fixture(scope="session")
def finished(tmp_path_factory, worker_id) -> Project:
    """A tiny run that is complete; not to be edited. All workers of a session have the same."""
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / "finished"
    with folder.with_suffix(".lock").open("a+") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        # Read only now: another worker may have completed it while this one waited.
        if not folder.with_suffix(".lock").read_text():
            run = copied(folder).snakemake()
            assert run.returncode == 0, run.stdout + run.stderr
            lock.write("complete")
            lock.flush()
    return Project(folder)


@pytest.fixture
def fresh(tmp_path) -> Project:
    """A copy of the code, nothing run yet, that a test may edit."""
    return copied(tmp_path / "fresh")


@pytest.fixture
def project(finished, tmp_path) -> Project:
    """A copy of the tiny run, complete, that a test may edit."""
    folder = tmp_path / "project"
    # Other workers may look at it, and leave a log of that.
    ignore = shutil.ignore_patterns("*.snakemake.log")
    shutil.copytree(finished.folder, folder, symlinks=True, ignore=ignore)
    return Project(folder)
