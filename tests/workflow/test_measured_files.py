"""Runs of materials that are not MERL's: files of the RGL database, and networks of other names."""

import csv
import io
import zipfile

import h5py
import numpy as np
from bsdf import of_brdf, tensor_file

from npfm.datasets import neural


def rows(path):
    with open(path) as file:
        return list(csv.DictReader(file))


def glossy(light, view):
    """Gloss on a base, in three colours, for unit vectors (n, 3)."""
    half = (light + view) / np.linalg.norm(light + view, axis=1)[:, None]
    colour = np.array([[0.3], [0.2], [0.1]])
    return colour + np.exp(-((np.arccos(np.minimum(half[:, 2], 1)) / 0.3) ** 2))


def test_a_run_of_files_of_the_rgl_database(fresh):
    folder = fresh.folder / "data" / "rgl"
    folder.mkdir(parents=True)
    (folder / "paint_rgb.bsdf").write_bytes(tensor_file(of_brdf(glossy)))
    (folder / "cut_rgb.bsdf").write_bytes(tensor_file(of_brdf(glossy))[:5000])
    dataset = {"kind": "rgl", "path": "rgl", "materials": ["paint_rgb"]}
    variants, scenes = ["bivariate"], {"A": fresh.config["scenes"]["A"]}
    fresh.configure(dataset=dataset, variants=variants, scenes=scenes, exports={})
    run = fresh.snakemake("tables", "where")
    assert run.returncode == 0, run.stdout + run.stderr
    assert (fresh.folder / "results/tiny/figures/where.png").exists()
    tables = fresh.folder / "results/tiny/tables"
    assert {row["variant"] for row in rows(tables / "where.csv")} == {"reciprocal", "bivariate"}
    (row,) = rows(tables / "psnr.csv")
    assert (row["material"], row["gap"]) == ("paint_rgb", "")
    assert float(row["psnr_db"]) > 30
    assert not {p for p in fresh.planned("tables", "where") if p}
    # A file that is cut off is told by the job that reads it, in one line.
    fresh.configure(
        dataset=dataset | {"materials": ["*"]}, variants=variants, scenes=scenes, exports={}
    )
    run = fresh.snakemake("results/tiny/materials/cut_rgb.binary")
    assert run.returncode != 0
    assert "cut_rgb.bsdf: cannot be read as a .bsdf file" in run.stdout + run.stderr


def network(seed):
    """A network of the published form that is in no archive, faint and positive."""
    rng, content = np.random.default_rng(seed), io.BytesIO()
    with h5py.File(content, "w") as file:
        for layer, shape in neural.LAYERS.items():
            file[f"{layer}/{layer}/kernel:0"] = rng.normal(0, 0.2, shape).astype("f4")
            file[f"{layer}/{layer}/bias:0"] = np.full(shape[1], 0.3, "f4")
    return content.getvalue()


def test_a_run_of_networks_that_are_no_merl_materials(fresh):
    """Published parameters and factors that such a material lacks are gaps, and break nothing."""
    folder = fresh.folder / "data"
    folder.mkdir()
    with zipfile.ZipFile(folder / "own.zip", "w") as file:
        for k, name in enumerate(("rgl_nbrdf/cc_nothern_aurora", "nielsen/nylon")):
            file.writestr(f"{name}.h5", network(k))
    (folder / "published_fits").mkdir()
    (folder / "published_fits" / "ngan_cooktorrance.fit").write_text(
        "nylon = Aggregate(Lambertian(albedo = [0.1, 0.1, 0.1]), "
        "NganCookTorrance(albedo = [1, 1, 1], eta = 0.5, roughness = 0.1))\n"
    )
    curves = {name: np.ones((1, 90, 3), "f4") for name in "DGF"}
    rho = {name: np.ones((1, 3), "f4") for name in ("rho_d", "rho_s")}
    np.savez(folder / "factors.npz", names=np.array(["nylon"]), **curves, **rho)
    fresh.configure(
        dataset={"kind": "neural", "path": "own.zip", "materials": ["*"]},
        variants=["bivariate", "independent-g", "cook-torrance-published"],
        models={"independent-g": {"starts": 1}},
        scenes={"A": fresh.config["scenes"]["A"]},
        published_factors="factors.npz",
        exports={},
    )
    figure06 = "results/tiny/figures/figure06.png"
    run = fresh.snakemake("tables", figure06)
    assert run.returncode == 0, run.stdout + run.stderr
    tables = fresh.folder / "results/tiny/tables"
    found = {(row["material"], row["variant"]): row for row in rows(tables / "psnr.csv")}
    assert {name for name, _ in found} == {"cc_nothern_aurora", "nylon"}
    assert float(found["cc_nothern_aurora", "bivariate"]["psnr_db"]) > 10
    missing = found.get(("cc_nothern_aurora", "cook-torrance-published"), {"psnr_db": ""})
    assert missing["psnr_db"] == ""
    assert (fresh.folder / figure06).exists()
