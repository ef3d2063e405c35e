"""The pages for a person's own material, light and object say what works."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import yaml
from snakemake.utils import update_config

from npfm.__main__ import VERBS
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.merl import read_binary
from npfm.run.config import check

ROOT = Path(__file__).parents[1]
MATERIAL, SCENE = ((ROOT / f"docs/my-own-{name}.md").read_text() for name in ("material", "scene"))


def block(page, language):
    """The one block of code of that language."""
    (text,) = re.findall(rf"```{language}\n(.*?)```", page, re.DOTALL)
    return text


def merged(preset):
    config = yaml.safe_load((ROOT / "config.yaml").read_text())
    update_config(config, preset)
    return config


def test_the_code_of_the_page_writes_a_table_that_a_run_takes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "code.py").write_text(block(MATERIAL, "python"))
    runpy.run_path("code.py")
    table = read_binary("red-paint.binary")
    assert (table.valid == MERL.above_horizon).all()
    np.testing.assert_allclose(table.values[:, MERL.above_horizon], 0.5 / np.pi)
    preset = yaml.safe_load(block(MATERIAL, "yaml"))
    preset["dataset"]["path"] = str(tmp_path)
    assert check(merged(preset)).materials == ("red-paint",)


def test_the_scene_of_the_page_is_the_only_one():
    run = check(merged(yaml.safe_load(block(SCENE, "yaml"))))
    assert run.scenes == ("dragon",)
    assert "visibility" in run.scene_options("dragon")
    assert run.warnings == []


def test_the_calls_of_the_pages_are_understood():
    calls = re.findall(r"^    python -m npfm (.*)$", MATERIAL + SCENE, re.MULTILINE)
    assert {call.split()[0] for call in calls} <= set(VERBS)
    for call in calls:
        words = [sys.executable, "-m", "npfm", *call.split()]
        done = subprocess.run(words, capture_output=True, text=True, cwd=ROOT / "docs")
        # None of the files is there: that is all that may be wrong with a call.
        assert "no such file" in done.stderr.lower(), done.stderr
