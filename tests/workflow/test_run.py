import csv
import re
import shutil

import numpy as np

from npfm.evaluation import quality
from npfm.storage.pictures import read_exr


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def test_a_run_makes_tables_with_the_promised_columns(finished):
    tables = finished.folder / "results" / "tiny" / "tables"
    psnr = rows(tables / "psnr.csv")
    assert list(psnr[0]) == ["scene", "material", "variant", "psnr_db", "gap"]
    assert len(psnr) == 2 * 1 * 3
    assert all(float(row["psnr_db"]) > 10 for row in psnr)
    fits = rows(tables / "fits.csv")
    assert list(fits[0]) == [
        "material",
        "variant",
        "channel",
        "seconds",
        "iterations",
        "gss_calls",
        "starts",
        "best_start",
        "objective",
        "objective_floor",
        "status",
    ]
    assert len(fits) == 1 * 3 * 3
    summary = rows(tables / "summary.csv")
    assert list(summary[0]) == (
        [
            "variant",
            "scene",
            "materials",
            "mean_psnr_db",
            "median_psnr_db",
            "exact",
            "gaps",
            "parameters",
            "bytes",
            "paper_psnr_db",
        ]
    )
    sizes = {row["variant"]: int(row["bytes"]) for row in summary}
    assert sizes == {"bivariate": 97200, "naive": 4344, "old": 4344}


def test_scenes_come_first_and_then_all_that_the_first_material_needs(fresh):
    fresh.configure(dataset={"kind": "synthetic", "materials": ["chalk", "car-paint"]})
    run = fresh.snakemake("--dry-run", "results/tiny/tables/quality.csv")
    assert run.returncode == 0, run.stdout + run.stderr
    ranks: dict[str, list[int]] = {}
    for job in re.split(r"\n *(?:local)?rule ", run.stdout + run.stderr)[1:]:
        material = re.search(r"material=([\w-]+)", job)
        rank = re.search(r"priority: (\d+)", job)
        who = material[1] if material else job.partition(":")[0]
        ranks.setdefault(who, []).append(int(rank[1]) if rank else 0)
    scenes, first, second = ranks["light"] + ranks["scene"], ranks["car-paint"], ranks["chalk"]
    assert [*map(len, (scenes, first, second))] == [3, 9, 9]
    assert min(scenes) > max(first) and min(first) > max(second)


def test_a_run_compares_by_every_metric(finished):
    folder = finished.folder / "results" / "tiny" / "tables"
    found = rows(folder / "quality.csv")
    assert list(found[0]) == list(quality.COLUMNS)
    assert len(found) == 2 * 1 * 3 * len(quality.PICTURES) + 1 * 3 * len(quality.TABLES)
    psnr = {(r["scene"], r["variant"]): r["psnr_db"] for r in rows(folder / "psnr.csv")}
    same = {(r["scene"], r["variant"]): r["value"] for r in found if r["metric"] == "psnr"}
    assert same == psnr
    # Pictures of 8 pixels are smaller than the window of SSIM; all else has a number.
    assert {r["metric"] for r in found if not r["value"]} == {"ssim"}
    summary = rows(folder / "quality_summary.csv")
    assert list(summary[0]) == list(quality.SUMMARY)


def test_figure_8_by_another_metric(finished):
    name = "figures/figure08_hyab_by_diffuseness.png"
    assert finished.planned(f"results/tiny/{name}") == {name, name.replace("png", "pdf")}


def test_a_run_makes_figures_and_pictures(finished):
    results = finished.folder / "results" / "tiny"
    assert (results / "figures" / "figure08_by_diffuseness.pdf").stat().st_size > 1000
    assert (results / "figures" / "figure08_by_diffuseness.png").stat().st_size > 1000
    assert (results / "figures" / "table1.csv").exists()
    folder = results / "renders" / "A" / "chalk"
    pictures = {path.stem: read_exr(path) for path in folder.glob("*.exr")}
    assert set(pictures) == {"measured", "bivariate", "naive", "old", "naive-to-89-unweighted"}
    assert all(np.isfinite(picture).all() for picture in pictures.values())
    assert all((folder / f"{name}.png").exists() for name in pictures)


def test_a_finished_run_has_nothing_to_do(finished):
    assert finished.planned() == set()


def test_a_mistake_in_the_configuration_is_one_line_and_makes_nothing(finished, tmp_path):
    folder = tmp_path / "mistaken"
    ignored = shutil.ignore_patterns("results", ".snakemake")
    shutil.copytree(finished.folder, folder, ignore=ignored)
    project = type(finished)(folder)
    project.configure(variants=["niave"])
    run = project.snakemake()
    assert run.returncode != 0
    lines = [line for line in run.stderr.splitlines() if "npfm" in line]
    assert lines == ["npfm: config: variants: unknown model 'niave'; did you mean naive?"]
    assert not (folder / "results").exists()
