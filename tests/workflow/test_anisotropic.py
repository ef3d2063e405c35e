"""A run of anisotropic materials, from tables to the page of claims."""

import numpy as np
import pandas as pd

from npfm.reflectance.directional import Directional
from npfm.reflectance.table import Table
from npfm.reflectance.utia import write_bin

CHANGES = {
    "dataset": {"kind": "synthetic-anisotropic", "materials": ["satin"], "shape": "3x12x3x12"},
    "variants": ["power-iteration", "ggx"],
    "models": {},
}


def test_a_run_of_made_materials(fresh):
    scene = fresh.config["scenes"]["A"] | {"objects": ["cloth"]}
    fresh.configure(**CHANGES, scenes={"A": scene})
    run = fresh.snakemake("reproduction", "results/tiny/figures/power_iterations_roughness.png")
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stderr.count("on a directional grid there is no Figure 3") >= 1
    results = fresh.folder / "results/tiny"
    assert (results / "materials/satin.bin").stat().st_size == 16 + 24 * 36**2
    fidelity = pd.read_csv(results / "tables/fidelity.csv")
    assert list(fidelity.variant) == ["power-iteration", "ggx"]
    assert np.isfinite(fidelity.drop(columns=["material", "variant"]).to_numpy()).all()
    surfaces = pd.read_csv(results / "tables/power_iterations_surfaces.csv")
    assert (surfaces[["alpha_x", "alpha_y"]] > 0).all(axis=None)
    page = (results / "reproduction.md").read_text()
    assert "figures/fidelity.png" in page
    assert "UTIA database" in page
    # All is made, and nothing is made again.
    assert not {p for p in fresh.planned("reproduction") if p}


def test_a_run_of_own_files_and_its_plan(fresh):
    grid = Directional(3, 12, 3, 12)
    (fresh.folder / "utia").mkdir()
    write_bin(fresh.folder / "utia" / "mine.bin", Table(np.ones((3, *grid.shape)), grid))
    dataset = {"kind": "utia", "path": "utia", "materials": ["*"]}
    fresh.configure(**CHANGES | {"dataset": dataset}, data=".")
    planned = fresh.planned()
    made = {"materials/mine.bin", "figures/fidelity.png", "fits/ggx/mine.npz", "scenes/C"}
    assert made <= planned
    assert not {name for name in planned if "figure03" in name or name.endswith(".binary")}
    run = fresh.snakemake("results/tiny/materials/mine.bin")
    assert run.returncode == 0, run.stdout + run.stderr
    assert (fresh.folder / "results/tiny/materials/mine.bin").is_symlink()


def test_a_variant_that_cannot_be_on_the_grid_ends_in_one_line(fresh):
    fresh.configure(**CHANGES | {"variants": ["naive"]})
    run = fresh.snakemake("--dry-run")
    assert run.returncode != 0
    said = "npfm: config: variants/naive: 'naive' is not for tables on a directional grid; choose"
    assert said in run.stderr
