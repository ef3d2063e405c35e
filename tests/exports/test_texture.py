from dataclasses import replace

import numpy as np
import OpenEXR
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.exports.texture import rows, texture
from npfm.fitting import fits
from npfm.fitting.fits import Fit
from npfm.models.independent_g import parameter_count
from npfm.reflectance.half_difference import MERL, HalfDifference


def fit(seed):
    rng = np.random.default_rng(seed)
    shapes = {"D": (3, 90), "F": (3, 90), "G": (3, 90), "rho_d": (3,), "rho_s": (3,)}
    arrays = {name: rng.random(shape).astype(np.float32) for name, shape in shapes.items()}
    return Fit("independent-g", arrays, MERL)


def test_every_parameter_is_there_exactly():
    made = {"chrome": fit(1), "nylon": fit(2)}
    pixels, places = texture(made), rows(made["nylon"])
    assert pixels.shape == (parameter_count(MERL) // 3, 2, 3)
    assert pixels.dtype == np.float32
    for k, one in enumerate(made.values()):
        for name, place in places.items():
            stored = one.parameters[name].reshape(3, -1)
            np.testing.assert_array_equal(pixels[place, k].T, stored)


def test_the_verb_writes_floats_and_a_header(tmp_path):
    for seed, name in enumerate(["chrome", "nylon"]):
        fits.save(tmp_path / f"{name}.npz", fit(seed))
    output = tmp_path / "texture.exr"
    call = [str(tmp_path / f"{name}.npz") for name in ("chrome", "nylon")]
    assert main(["texture", *call, "-o", str(output)]) == 0
    with OpenEXR.File(str(output)) as file:
        header, pixels = dict(file.header()), file.channels()["RGB"].pixels
    assert header["materials"] == "chrome nylon"
    assert header["rows"] == "rho_d=0:1 rho_s=1:2 D=2:92 G=92:182 F=182:272"
    np.testing.assert_array_equal(pixels, texture({"chrome": fit(0), "nylon": fit(1)}))


def test_other_fits_are_refused():
    coarse = replace(fit(1), grid=HalfDifference(30, 30, 30))
    with pytest.raises(NpfmError, match="fit of nylon does not go into a texture"):
        texture({"chrome": fit(1), "nylon": coarse})
