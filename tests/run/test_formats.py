"""The key `exports`: mistakes are told before anything runs."""

from pathlib import Path

import pytest
import yaml

from npfm.errors import NpfmError
from npfm.run.config import check
from npfm.run.exports import plan

DEFAULT = yaml.safe_load((Path(__file__).parents[2] / "config.yaml").read_text())


@pytest.mark.parametrize(
    ("exports", "message"),
    [
        ({"gtlf": ["naive"]}, r"exports: unknown format 'gtlf'; did you mean gltf"),
        ({"csv": ["nave"]}, r"exports/csv: unknown variant 'nave'; did you mean naive"),
        ({"gltf": ["naive"]}, r"gltf: 'naive' is of the model naive, .* ggx-fitted;"),
        ({"csv": ["measured"]}, r"exports/csv: it is made from fits, not from tables"),
        ({"texture": ["naive"]}, r"exports/texture: it holds all materials at once"),
        ({"bsdf": {"variants": ["naive"], "view": 4}}, r"unknown key 'view'; did you mean views"),
    ],
)
def test_mistakes_are_told_in_one_line(exports, message):
    with pytest.raises(NpfmError, match=message) as caught:
        check(DEFAULT | {"exports": exports})
    assert "\n" not in str(caught.value) and str(caught.value).startswith("config: exports")


def test_models_that_the_run_has_not_are_fitted_for_it():
    mine = {"name": "mine", "model": "ggx-fitted"}
    exports = {"gltf": ["mine", "ggx-fitted"], "bsdf": {"variants": ["measured"], "views": 4}}
    changes = {"variants": ["naive", mine], "exports": exports, "colors": {"mine": "#009E73"}}
    made = plan(check(DEFAULT | changes))
    # The same fit by two names is made once.
    assert made.source("mine", "chalk") == "results/default/fits/mine/chalk.npz"
    assert made.source("ggx-fitted", "chalk") == made.source("mine", "chalk")
    assert made.source("measured", "chalk") == "results/default/materials/chalk.binary"
    assert made.options("bsdf") == ["--to", "bsdf", "--views", "4"]
    written = list(made.written())
    assert len(written) == 3 * len(made.run.materials)
    assert "results/default/exports/gltf/mine/chalk.gltf" in written
