import json
import shutil

import pytest

from npfm.run.bounces import REFERENCE, SAMPLERS
from tests.workflow.conftest import Project


@pytest.fixture
def small(finished, tmp_path):
    """The tiny run, and a still life of a few paths."""
    shutil.copytree(finished.folder, tmp_path / "project", symlinks=True)
    project = Project(tmp_path / "project")
    project.configure(
        bounces={
            "materials": [],
            "resolution": 8,
            "paths": 64,
            "seconds": 0.01,
            "reference_paths": 64,
        }
    )
    return project


def test_the_target_renders_every_sampler_and_fits_what_they_follow(small):
    made = small.planned("bounces")
    assert {f"bounces/{name}.exr" for name in (REFERENCE, *SAMPLERS)} <= made
    assert "tables/bounces.csv" in made and "figures/bounces.png" in made
    assert "bounces/fits/factored/chalk.npz" in made
    assert not {name for name in made if name.startswith(("renders", "scenes"))}


def test_a_picture_has_its_record(small):
    pytest.importorskip("mitsuba", reason="needs the extra mitsuba")
    run = small.snakemake("results/tiny/bounces/cosine.exr")
    assert run.returncode == 0, run.stdout + run.stderr
    record = json.loads((small.folder / "results/tiny/bounces/cosine.json").read_text())
    assert record["paths"] > 0
