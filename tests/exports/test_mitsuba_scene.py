"""The folder that renders at once, from a place that knows nothing of it."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.exports import mitsuba_scene
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.reflectance.half_difference import MERL

ROOT = Path(__file__).parents[2]


def scene(folder, rho_d):
    """The folder of a fit that reflects evenly."""
    arrays = {"rho_d": [rho_d] * 3, "rho_s": [0] * 3, "alpha": [0.2], "f0": [0.04]}
    made = {name: np.array(value, dtype=np.float32) for name, value in arrays.items()}
    fits.save(folder / "fit.npz", Fit("ggx-fitted", made, MERL))
    call = ["export", str(folder / "fit.npz"), "--to", "mitsuba", "-o", str(folder / "scene")]
    assert main(call) == 0
    return folder / "scene"


def test_one_command_renders_it(tmp_path):
    mi = pytest.importorskip("mitsuba", reason="needs pip install npfm[mitsuba]")
    from npfm.exports.mitsuba import engine

    engine.start()
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    balls = []
    for rho_d in (0.0, 0.3):
        folder = scene(tmp_path, rho_d)
        (tmp_path / "away").mkdir(exist_ok=True)
        call = [sys.executable, str(folder / "render.py"), "2"]
        run = subprocess.run(
            call, cwd=tmp_path / "away", env=environment, capture_output=True, text=True
        )
        assert run.returncode == 0, run.stderr
        assert run.stdout == f"wrote {folder / 'picture.exr'}\n"
        picture = np.array(mi.Bitmap(str(folder / "picture.exr")))[..., :3]
        assert picture.shape == (256, 256, 3) and np.isfinite(picture).all()
        assert picture[220:].mean() > 0.05
        balls.append(picture[110:130, 120:140].mean())
    assert balls[0] == 0 and balls[1] > 0.2


def test_a_folder_with_something_else_in_it_is_kept(tmp_path, capsys):
    folder = scene(tmp_path, 0.3)
    assert mitsuba_scene.KIND.ours(folder)
    (folder / "notes.txt").write_text("mine")
    call = ["export", str(tmp_path / "fit.npz"), "--to", "mitsuba", "-o", str(folder)]
    assert main(call) == 1
    assert "a folder is there that is not a scene of Mitsuba" in capsys.readouterr().err
    assert (folder / "notes.txt").read_text() == "mine"
