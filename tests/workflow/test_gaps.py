"""One material that is black, among others, through the whole workflow."""

import csv
import shutil

import numpy as np

from npfm.datasets import synthetic
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import write_binary
from npfm.reflectance.table import Table

MATERIALS = ["black", "chalk"]


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def test_a_black_material_takes_nothing_from_the_others(project):
    for made in ("fits", "renders", "tables", "figures"):  # all but what no material matters to
        shutil.rmtree(project.folder / "results" / "tiny" / made)
    folder = project.folder / "data" / "brdfs"
    folder.mkdir(parents=True)
    write_binary(folder / "black.binary", Table(np.zeros((3, *MERL.shape))))
    for name in MATERIALS[1:]:
        write_binary(folder / f"{name}.binary", synthetic.load(name, 1))
    project.configure(
        dataset={"kind": "merl", "path": "brdfs", "materials": MATERIALS},
        variants=["bivariate", "independent-g"],
        scenes={"A": project.config["scenes"]["A"]},
        models={"independent-g": {"starts": 1}},
    )
    run = project.snakemake("tables", "figures", "pages", "reproduction")
    assert run.returncode == 0, run.stdout + run.stderr
    tables = project.folder / "results" / "tiny" / "tables"
    psnr = rows(tables / "psnr.csv")
    assert len(psnr) == 2 * 2
    for row in psnr:
        black = row["material"] == "black"
        assert (row["psnr_db"] == "") == black
        assert row["gap"] == black * "the largest foreground value of the reference is 0"
    summary = rows(tables / "summary.csv")
    assert {(row["materials"], row["gaps"]) for row in summary} == {("1", "1")}
    assert all(float(row["mean_psnr_db"]) > 10 for row in summary)
    page = (tables.parent / "reproduction.md").read_text()
    assert " nan" not in page
    assert {path.stem for path in (tables.parent / "figures").glob("*.png")} >= {
        "figure08_by_error",
        "figure07",
        "figure11",
    }
