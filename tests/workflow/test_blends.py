import numpy as np
import pandas as pd
from PIL import Image

from npfm.storage.pictures import read_exr_parts


def test_the_target_blends_and_builds_no_scene_again(project):
    (project.folder / "data").mkdir(exist_ok=True)
    Image.fromarray(np.full((2, 4, 4), 255, np.uint8)).save(project.folder / "data/weights.png")
    asked = project.config["blends"] | {"weights": "weights.png", "scene": "C"}
    project.configure(blends=asked)
    planned = project.planned("blends")
    assert {name for name in planned if name.startswith("blends/") and name.endswith(".npz")} == {
        "blends/fits/independent-g/chalk.npz",
        "blends/factors.npz",
    }
    run = project.snakemake("blends")
    assert run.returncode == 0, run.stdout + run.stderr
    results = project.folder / "results/tiny"
    table = pd.read_csv(results / "tables/blends.csv")
    assert (table["scene"] == "C").all()
    assert table["way"].tolist()[:2] == ["measured", "tables"]
    half = pd.read_csv(results / "tables/blends_half_way.csv")
    assert (half["first"] == "chalk").all() and len(half) == 3 * 6
    parts = read_exr_parts(results / "blends/pictures.exr")
    assert set(table["way"]) < set(parts)
    assert parts["weights"].min() >= 0 and (parts["weights"] == 0.25).any()
    assert (results / "figures/blends.pdf").stat().st_size > 0


def test_what_has_no_factors_is_refused(project):
    project.configure(blends=project.config["blends"] | {"variant": "naive"})
    run = project.snakemake("--dry-run")
    assert run.returncode != 0
    assert "blends/variant: 'naive' has no D, F and G to be blended" in run.stderr
