"""Figures 7 and 15: what is fitted for them, and how they are drawn."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from npfm.errors import NpfmError
from npfm.figures import figure07, figure15, style
from npfm.figures.renderings import Row
from npfm.run import weighting
from npfm.run.config import check
from npfm.run.paper_figures import drawn
from npfm.storage.pictures import write_png

CONFIG = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())
SCENES, MATERIALS = ["A", "B"], ["chalk", "nylon"]
COLUMNS = {"naive": ("naive", "naive-to-89-unweighted")}


def run_of(*variants, **changes):
    materials = {"kind": "synthetic", "materials": ["chalk", "mirror-metal", "nylon"]}
    return check(CONFIG | {"dataset": materials, "variants": list(variants)} | changes)


@pytest.fixture
def run(tmp_path):
    for scene in SCENES:
        for material in MATERIALS:
            for k, variant in enumerate(["measured", *COLUMNS["naive"]]):
                folder = tmp_path / "renders" / scene / material
                folder.mkdir(parents=True, exist_ok=True)
                write_png(folder / f"{variant}.png", np.full((8, 8, 3), 70 * k, dtype=np.uint8))
    return tmp_path


@pytest.fixture
def psnr():
    rows = [
        (scene, material, variant, 40.0 + s + 3 * m - 10 * k * m)
        for s, scene in enumerate(SCENES)
        for m, material in enumerate(MATERIALS)
        for k, variant in enumerate(COLUMNS["naive"])
    ]
    return pd.DataFrame(rows, columns=["scene", "material", "variant", "psnr_db"])


def figure(run, psnr):
    return figure07.draw(run, psnr, [Row(m, "B") for m in MATERIALS], COLUMNS)


def test_fits_that_the_run_has_are_taken_from_it():
    plan = weighting.plan(run_of("bivariate", "independent-g", "naive"))
    assert plan.pictures[7] == {
        "independent-g": ("independent-g", "independent-g-to-89-unweighted"),
        "naive": ("naive", "naive-to-89-unweighted"),
    }
    assert plan.pictures[15] == {
        "up to 89 degrees": ("independent-g", "independent-g-to-89-unweighted"),
        "up to 80 degrees": ("independent-g-to-80-weighted", "independent-g-to-80-unweighted"),
    }
    assert plan.added == [
        "independent-g-to-89-unweighted",
        "naive-to-89-unweighted",
        "independent-g-to-80-weighted",
        "independent-g-to-80-unweighted",
    ]
    options = {name: " ".join(v.options) for name, v in plan.study.variants.items()}
    assert "--max-angle 80.0 --no-compressive" in options["independent-g-to-80-unweighted"]
    assert "--no-compressive" not in options["independent-g-to-80-weighted"]
    assert plan.folders["naive-to-89-unweighted"] == (
        "results/default/weighting/fits/naive-to-89-unweighted"
    )


def test_other_settings_of_the_run_are_fitted_anew():
    own = {"name": "naive", "model": "naive", "objective": {"compressive": False}}
    plan = weighting.plan(run_of(own))
    assert plan.pictures == {7: {"naive": ("naive-to-89-weighted", "naive")}}
    assert plan.added == ["naive-to-89-weighted"]


def test_a_run_draws_what_its_variants_allow():
    def names(run):
        return list(drawn(run, weighting.plan(run)))

    everywhere = ["figure03", "figure04"]
    assert names(run_of("bivariate")) == everywhere
    assert names(run_of("bivariate", "naive")) == [*everywhere, "figure05", "figure07"]
    assert names(run_of("independent-g")) == [
        *everywhere,
        *("figure05", "figure06", "figure07", "figure15", "figure16"),
    ]


def test_published_factors_are_drawn_where_the_configuration_names_them():
    run = run_of("independent-g", published_factors="reference.npz")
    figure = drawn(run, weighting.plan(run))["figure06"]
    assert "data/reference.npz" in figure.files
    assert figure.arguments[-2:] == ["--published", "data/reference.npz"]
    run = run_of("independent-g")
    assert "--published" not in drawn(run, weighting.plan(run))["figure06"].arguments


def test_pairs_stand_beside_the_measurement_with_their_gains(run, psnr):
    drawn_now = figure(run, psnr)
    headings = [ax.get_title() for ax in drawn_now.axes[:3]]
    assert headings == ["measured", "naive\nweighted", "naive\nnot weighted"]
    labels = [[text.get_text() for text in ax.texts] for ax in drawn_now.axes]
    assert labels == [[], ["41.0 dB"], ["41.0 dB"], [], ["44.0 dB"], ["34.0 dB"]]
    remark = " ".join(text.get_text() for text in drawn_now.texts)
    assert remark.endswith("mean over the scenes A, B: chalk +0.0; nylon +10.0")


@pytest.mark.mpl_image_compare(style=["default", style.SETTINGS], savefig_kwargs={"dpi": 50})
def test_figure07_looks_as_it_did(run, psnr):
    return figure(run, psnr)


def test_nothing_is_cut_off(run, psnr):
    drawn_now = figure(run, psnr)
    drawn_now.draw_without_rendering()
    boxes = [ax.get_tightbbox() for ax in drawn_now.axes]
    boxes += [text.get_window_extent() for text in drawn_now.texts]
    page = drawn_now.bbox
    assert all(page.contains(*box.min) and page.contains(*box.max) for box in boxes)
    assert drawn_now.get_figwidth() in (style.COLUMN_WIDTH, style.PAGE_WIDTH)


def test_columns_are_named_on_the_command_line():
    assert figure07.pairs(["a=b=c,d", "e=f,g"]) == {"a=b": ("c", "d"), "e": ("f", "g")}
    for wrong in ("a=b", "b,c", "a=b,c,d"):
        with pytest.raises(NpfmError, match="give it as heading=with,without"):
            figure07.pairs([wrong])
    assert figure15.draw is figure07.draw
