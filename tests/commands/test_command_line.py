"""The verbs as a person would use them alone, and what they say to mistakes."""

import subprocess
import sys

import numpy as np
import pytest

from npfm.__main__ import VERBS, main
from npfm.reflectance.merl import FILE_BYTES, read_binary
from npfm.storage.pictures import read_exr


@pytest.fixture(scope="module")
def folder(tmp_path_factory, light_file):
    """A material, a fit of it, a light and a scene, each made by its verb."""
    folder = tmp_path_factory.mktemp("verbs")
    calls = [
        f"material --synthetic chalk -o {folder}/chalk.binary",
        f"fit {folder}/chalk.binary --model bivariate -o {folder}/chalk.npz",
        f"light {light_file} --layout lat-long --height 16 -o {folder}/grove.exr",
        f"scene --light {folder}/grove.exr --objects sphere --resolution 8 --samples 64"
        f" -o {folder}/scene",
        f"render {folder}/scene {folder}/chalk.binary -o {folder}/measured.exr",
        f"render {folder}/scene {folder}/chalk.npz --measured {folder}/chalk.binary"
        f" -o {folder}/fitted.exr",
    ]
    for call in calls:
        assert main(call.split()) == 0
    return folder


@pytest.mark.parametrize("verb", VERBS)
def test_help_of_every_verb_has_an_example(verb, capsys):
    with pytest.raises(SystemExit) as stopped:
        main([verb, "--help"])
    assert stopped.value.code == 0
    assert f"python -m npfm {verb}" in capsys.readouterr().out


def test_a_tabulated_fit_is_a_merl_file(folder):
    assert main(["tabulate", f"{folder}/chalk.npz", "-o", f"{folder}/tabulated.binary"]) == 0
    assert (folder / "tabulated.binary").stat().st_size == FILE_BYTES
    fitted, measured = (
        read_binary(folder / "tabulated.binary"),
        read_binary(folder / "chalk.binary"),
    )
    both = fitted.valid & measured.valid
    assert np.median(np.abs(fitted.values / measured.values - 1)[both]) < 0.1


def test_pictures_are_alike_and_have_a_png_beside_them(folder):
    measured, fitted = read_exr(folder / "measured.exr"), read_exr(folder / "fitted.exr")
    assert measured.shape == fitted.shape == (8, 8, 4)
    inside = measured[..., 3] == 1
    assert inside.any() and not inside.all()
    assert np.abs(fitted[inside] / measured[inside] - 1).max() < 0.2
    assert (fitted[~inside] == measured[~inside]).all()
    assert (folder / "fitted.png").exists()


def test_compare_prints_decibels_and_joins_the_pictures(folder, capsys):
    pictures = [f"{folder}/{name}.exr" for name in ("measured", "fitted")]
    assert main(["compare", *pictures, "-o", f"{folder}/all.exr"]) == 0
    assert "fitted" in capsys.readouterr().out
    assert (folder / "all.exr").stat().st_size > 0


def test_missing_samples_are_black_in_the_picture_of_a_fit(folder):
    """A fit cannot win or lose where there is nothing to compare it with."""
    table = read_binary(folder / "chalk.binary")
    holes = folder / "holes.binary"
    content = bytearray((folder / "chalk.binary").read_bytes())
    flat = np.frombuffer(content, dtype="<f8", offset=12).reshape(3, -1)
    flat[:, : flat.shape[1] // 2] = -1
    holes.write_bytes(content)
    call = f"render {folder}/scene {folder}/chalk.npz --measured {holes} -o {folder}/holes.exr"
    assert main(call.split()) == 0
    whole, partial = read_exr(folder / "fitted.exr"), read_exr(folder / "holes.exr")
    assert table.valid.any()
    inside = whole[..., 3] == 1
    assert (partial[inside] <= whole[inside] * (1 + 1e-6)).all()
    assert partial[inside][:, :3].sum() < whole[inside][:, :3].sum()


#: Of the outputs that are no pictures.
SUFFIXES = {"fit": ".npz", "material": ".binary", "tabulate": ".binary", "scene": ""}


@pytest.mark.parametrize(
    ("call", "named"),
    [
        ("fit {folder}/none.binary --model naive -o {out}", "none.binary"),
        ("material --merl ../none --from {folder} -o {out}.binary", "rename the file"),
        ("fit {folder}/short.binary --model naive -o {out}", "short.binary"),
        ("fit {folder}/shape.binary --model naive -o {out}", "90 x 90 x 180"),
        ("fit {folder}/nan.binary --model naive -o {out}", "NaN"),
        ("fit {folder}/empty.binary --model naive -o {out}", "green channel"),
        ("fit {folder}/chalk.binary --model niave -o {out}", "did you mean naive"),
        ("fit {folder}/chalk.binary --model naive --solver newton -o {out}", "unknown solver"),
        ("fit {folder}/chalk.binary --model naive --seed -1 -o {out}", "--seed: '-1'"),
        ("fit {folder}/chalk.binary --model naive --max-angle -5 -o {out}", "-5 degrees"),
        ("fit {folder}/chalk.binary --model naive --tolerance nan -o {out}", "--tolerance"),
        ("fit {folder}/chalk.binary --model naive --max-iterations 0 -o {out}", "1 or more"),
        ("fit {folder}/chalk.binary -o {out}", "required: --model"),
        ("material --synthetic chalk --seed x -o {out}", "--seed: 'x'"),
        ("light {folder}/grove.exr --layout lat-long --height 0 -o {out}", "--height: '0'"),
        ("light --generate grove --height 9999999 -o {out}", "19999998 x 9999999 pixels"),
        ("light {folder}/grove.exr -o {out}", "give --layout angular-map or lat-long"),
        ("scene --light {folder}/grove.exr --objects sphere --samples 0 -o {out}", "--samples"),
        ("scene --light {folder}/grove.exr --objects sphere --turn nan -o {out}", "--turn: 'nan'"),
        (
            "scene --light {folder}/grove.exr --objects sphere --resolution 999999999 -o {out}",
            "999999999 x 999999999 pixels",
        ),
        (
            "scene --light {folder}/grove.exr --objects sphere --resolution 4"
            " --samples 999999999999999 -o {out}",
            "too little memory; ask for less",
        ),
        ("render {folder}/scene {folder}/chalk.npz --gamma 0 -o {out}", "--gamma: '0'"),
        ("tabulate {folder}/chalk.binary -o {out}", "cannot be read as a fit"),
        ("material --synthetic chalkk -o {out}", "did you mean chalk"),
        ("material --neural chrome --from {folder}/none.zip -o {out}", "none.zip"),
        ("material --neural chrome --from {folder}/chalk.binary -o {out}", "chalk.binary"),
        ("material --merl chrome --from {folder} -o {out}", "chrome"),
        ("light {folder}/none.hdr --layout angular-map -o {out}", "none.hdr"),
        ("light {folder}/fitted.png --layout angular-map -o {out}", "fitted.png"),
        ("light {folder}/grove.exr --layout angular-map -o {out}", "grove.exr"),
        ("light {folder}/grove.exr --layout cross -o {out}", "unknown layout 'cross'"),
        ("light --generate groove -o {out}", "did you mean grove"),
        ("scene --light {folder}/fitted.exr --objects sphere -o {out}", "fitted.exr"),
        ("scene --light {folder}/grove.exr --objects cube -o {out}", "unknown object 'cube'"),
        ("scene --light {folder}/grove.exr --objects sphere --effects x -o {out}", "effect 'x'"),
        (
            "scene --light {folder}/grove.exr --objects figure --mesh {folder}/flat.ply -o {out}",
            "flat.ply",
        ),
        ("render {folder}/none {folder}/chalk.npz -o {out}", "none"),
        ("compare {folder}/measured.exr {folder}/none.exr", "none.exr"),
    ],
)
def test_mistakes_are_one_line_that_names_the_file_and_leave_nothing(folder, capsys, call, named):
    content = (folder / "chalk.binary").read_bytes()
    (folder / "short.binary").write_bytes(content[:1000])
    (folder / "shape.binary").write_bytes(b"\x5b\x00\x00\x00" + content[4:])
    nan = np.frombuffer(bytearray(content), dtype="<f8", offset=12).copy()
    nan[7] = np.nan
    (folder / "nan.binary").write_bytes(content[:12] + nan.tobytes())
    nan[7] = 1
    nan.reshape(3, -1)[1] = -1
    (folder / "empty.binary").write_bytes(content[:12] + nan.tobytes())
    (folder / "flat.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n1 0 0\n0 1 0\n"
    )
    before = sorted(path.name for path in folder.rglob("*"))
    out = folder / "out" / f"result{SUFFIXES.get(call.split()[0], '.exr')}"
    assert main(call.format(folder=folder, out=out).split()) == 1
    message = capsys.readouterr().err
    assert message.startswith(f"npfm {call.split()[0]}: ")
    assert message.count("\n") == 1
    assert named in message
    after = sorted(path.name for path in folder.rglob("*") if path.name != "out")
    assert after == before


BLOCKED = """
import sys
for name in ("numba", "pandas", "matplotlib", "scipy.linalg", "scipy.ndimage", "tqdm"):
    sys.modules[name] = None
from npfm.fitting import registry
from npfm.fitting.solvers.choice import SOLVERS, chosen
from npfm.commands import render
for name in ("bivariate", "independent-g", "g-from-d", "naive", "bivariate-g", "low-rank-b"):
    registry.model(name)
"""


def test_a_job_that_renders_does_not_wait_for_what_only_fits_and_tables_need():
    subprocess.run([sys.executable, "-W", "error", "-c", BLOCKED], check=True)
