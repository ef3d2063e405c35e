"""Names and paths that a shell or Snakemake reads otherwise, through the real Snakefile."""

import shutil

import numpy as np
import pytest
import trimesh

from npfm.errors import NpfmError
from npfm.run.config import check
from npfm.storage.pictures import write_exr

#: A blank, an apostrophe, both kinds of braces' trouble, what a shell expands or ends a command at.
ODD = "it's {material} {x} $HOME; & (ü) #1"
FIT = (
    "chalk = Aggregate(Lambertian(albedo = [0, 0, 0]), "
    "NganCookTorrance(albedo = [1, 1, 1], eta = 0.5, roughness = 0.1))\n"
)


def test_files_of_the_user_may_have_any_path(fresh, finished):
    """In a working directory of any path: tables, light, figure and published fits."""
    folder = fresh.folder.with_name(ODD)
    fresh.folder.rename(folder)
    project = type(fresh)(folder)
    tables, published = (folder / f"{first}{ODD}" for first in "-@")
    tables.mkdir()
    published.mkdir()
    shutil.copy(finished.folder / "results/tiny/materials/chalk.binary", tables)
    write_exr(folder / f"@{ODD}.exr", np.ones((16, 32, 3), np.float32))
    trimesh.creation.icosphere(1).export(folder / f"-{ODD}.ply")
    (published / "ngan_cooktorrance.fit").write_text(FIT)
    scene = project.config["scenes"]["C"] | {"light": "own", "mesh": f"-{ODD}.ply"}
    before = set(folder.iterdir())
    project.configure(
        data="",
        published_fits=published.name,
        dataset={"kind": "merl", "path": tables.name, "materials": ["*"]},
        lights={"own": {"file": f"@{ODD}.exr", "layout": "lat-long"}},
        scenes={"A": scene},
        variants=["bivariate", "cook-torrance-published"],
    )
    run = project.snakemake("tables")
    assert run.returncode == 0, run.stdout + run.stderr
    assert project.planned("tables") == set()
    table = (folder / "results/tiny/tables/psnr.csv").read_text()
    assert table.count("\n") == 3
    made = {path.name for path in {*folder.iterdir()} - before}
    assert made == {"results", ".snakemake"}
    (published / "ngan_cooktorrance.fit").write_text(FIT.replace("eta = 0.5", "eta = 0.6"))
    assert "fits/cook-torrance-published/chalk.npz" in project.planned("tables")


def with_file(project, name):
    """Changes of the configuration: a folder of tables that has a file of this name."""
    brdfs = project.folder / "brdfs"
    brdfs.mkdir()
    (brdfs / f"{name}.binary").touch()
    return {"data": "", "dataset": {"kind": "merl", "path": "brdfs", "materials": [name]}}


@pytest.mark.parametrize(
    "name", ["Red Paint", "-red", "it's", "a$(touch X)", "{x}", "a;b", "a&b", "rot-grün", ".red"]
)
def test_a_file_that_names_no_material_is_refused(fresh, monkeypatch, name):
    changes = with_file(fresh, name)
    monkeypatch.chdir(fresh.folder)
    with pytest.raises(NpfmError) as refused:
        check(fresh.config | changes)
    said = str(refused.value)
    if name.startswith("."):  # such files are still being written
        assert "no material matches '.red'" in said
    else:
        assert "\n" not in said
        assert said.startswith(f"config: the material {name!r}: a name is of A-Z")
        assert said.endswith(f"rename {f'{name}.binary'!r} in brdfs")


def test_a_refusal_is_one_line_before_anything_runs(fresh):
    fresh.configure(**with_file(fresh, "a$(touch X)"))
    run = fresh.snakemake()
    assert run.returncode != 0
    said = [line for line in run.stderr.splitlines() if line.startswith("npfm")]
    assert len(said) == 1
    assert said[0].startswith("npfm: config: the material 'a$(touch X)': a name is of A-Z")
    assert not (fresh.folder / "results").exists()
