"""What every verb does to what is already there, and when it is told to stop."""

import os
import re
import shutil
import signal
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

from npfm.__main__ import VERBS, main
from npfm.evaluation import psnr_level, quality, stability, tables, uniqueness
from npfm.evaluation.accuracy_cost import FITS
from npfm.fitting import fits, registry
from npfm.fitting.fits import Fit
from npfm.fitting.objective import Objective
from npfm.reflectance.half_difference import MERL

#: A call of every verb; what follows is all that it writes.
CALLS = {
    "material": ("--synthetic chalk -o {out}/a.binary", "a.binary"),
    "material --merl chalk": ("--from {made}/brdfs -o {out}/a.binary", "a.binary"),
    "fit": ("{made}/chalk.binary --model bivariate -o {out}/a.npz", "a.npz", "a.json"),
    "edit": ("{made}/ggx.npz --roughness 2 -o {out}/a.npz", "a.npz", "a.json"),
    "stability gather": ("{made}/stability.csv -o {out}/a.csv", "a.csv"),
    "power-iterations delta-e": (
        "--measured {made}/renders/A --fits bivariate={made}/renders/A --materials chalk"
        " -o {out}/a.csv --images {out}/a.exr",
        "a.csv",
        "a.exr",
    ),
    "basis gather": ("{made}/fits/independent-g/chalk.npz -o {out}/a.npz", "a.npz"),
    "uniqueness table": ("{made}/uniqueness.csv -o {out}/a.csv", "a.csv"),
    "shared-lobes psnr": ("{made}/compared.csv -o {out}/a.csv", "a.csv"),
    "tabulate": ("{made}/chalk.npz -o {out}/a.binary", "a.binary"),
    "texture": ("{made}/fits/independent-g/chalk.npz -o {out}/a.exr", "a.exr"),
    "export --to merl": ("{made}/chalk.npz -o {out}/a.binary", "a.binary"),
    "export --to bsdf": ("{made}/chalk.npz --views 4 --size 4 -o {out}/a.bsdf", "a.bsdf"),
    "export --to bsdf-spectral": (
        "{made}/chalk.npz --views 4 --size 4 -o {out}/a.bsdf",
        "a.bsdf",
    ),
    "export --to mitsuba": ("{made}/chalk.npz -o {out}/a", "a"),
    "export --to csv": ("{made}/fits/independent-g/chalk.npz -o {out}/a.csv", "a.csv"),
    "export --to gltf": ("{made}/lobe.npz -o {out}/a.gltf", "a.gltf"),
    "export --to materialx": ("{made}/lobe.npz -o {out}/a.mtlx", "a.mtlx"),
    "export --to texture": ("{made}/fits/independent-g/chalk.npz -o {out}/a.exr", "a.exr"),
    "export --to glsl": ("{made}/fits/independent-g/chalk.npz -o {out}/a.glsl", "a.glsl"),
    "light": ("{made}/grove.exr --layout lat-long --height 4 -o {out}/a.exr", "a.exr"),
    "scene": (
        "--light {made}/grove.exr --objects sphere --resolution 4 --samples 16"
        " --record {out}/a.json -o {out}/a",
        "a",
        "a.json",
    ),
    "render": ("{made}/A {made}/chalk.binary -o {out}/a.exr", "a.exr", "a.png"),
    "render --measured": (
        "{made}/chalk.binary {made}/A {made}/A {made}/chalk.npz -o {out}/a.exr {out}/b.exr",
        *("a.exr", "a.png", "b.exr", "b.png"),
    ),
    "interreflect": (
        "{made}/chalk.binary --light {made}/grove.exr --objects figure --resolution 4 --paths 1"
        " --record {out}/a.json -o {out}/a.exr",
        "a.exr",
        "a.json",
    ),
    "bounces render": (
        "--sampling cosine --tables"
        + 5 * " {made}/chalk.binary"
        + " --resolution 4 --paths 16 --record {out}/a.json -o {out}/a.exr",
        "a.exr",
        "a.json",
    ),
    "vary": (
        "{made}/A {made}/chalk.binary {made}/chalk.npz --objects sphere -o {out}/a.exr",
        "a.exr",
        "a.png",
    ),
    "vary --blend log-factors": (
        "{made}/A {made}/fits/independent-g/chalk.npz --objects sphere -o {out}/a.exr",
        "a.exr",
        "a.png",
    ),
    "blends": (
        "{made}/A --objects sphere --measured"
        + 4 * " {made}/chalk.binary"
        + " --fits"
        + 4 * " {made}/fits/independent-g/chalk.npz"
        + " --pictures {out}/a.exr --half-way {out}/b.csv -o {out}/a.csv",
        *("a.exr", "b.csv", "a.csv"),
    ),
    "compare": ("{made}/measured.exr {made}/fitted.exr -o {out}/a.exr", "a.exr"),
    "tables psnr": (
        "--run {made} --scenes A --materials chalk --variants bivariate -o {out}/a.csv",
        "a.csv",
    ),
    "tables where": (
        "--run {made} --spheres A --materials chalk --variants bivariate -o {out}/a.csv",
        "a.csv",
    ),
    "quality material": (
        "{made}/chalk.binary --run {made} --scenes A --variants bivariate -o {out}/a.csv",
        "a.csv",
    ),
    "quality gather": ("{made}/quality.csv -o {out}/a.csv", "a.csv"),
    "perception pairs": (
        "--quality {made}/quality.csv --opinions {made} -o {out}/a.csv",
        "a.csv",
    ),
    "gallery material": (
        "chalk --run {made} --scenes A=1,2 --variants bivariate --quality {made}/chalk.csv"
        " -o {out}/a.html",
        "a.html",
        "a.jpg",
    ),
    "gallery overview": (
        "mine --quality {made}/chalk.csv --fits {made}/fits.csv --summary {made}/summary.csv"
        " -o {out}/a.html",
        "a.html",
    ),
    "gallery demo": (
        "mine --run {made} --scenes A=1,2 --lights {made}/grove.exr --fits {made}/fits.csv"
        " -o {out}/a.html",
        "a.html",
    ),
    "gallery figure": ("-o {out}/a.js", "a.js"),
    "gallery table": ("{made}/chalk.binary -o {out}/a.js", "a.js"),
    "video light": ("chalk --frames {made}/frames.exr -o {out}/a.gif", "a.gif"),
    "figure figure04": ("-o {out}/a.pdf {out}/a.png", "a.pdf", "a.png"),
    "reproduction": (
        "--run {made} --dataset synthetic --psnr {made}/psnr.csv --summary {made}/summary.csv"
        " -o {out}/a.md",
        "a.md",
    ),
    "effects-cost compare": (
        "{made}/A --tables {made}/chalk.binary --fits {made}/chalk.npz"
        " -o {out}/a.csv --pictures {out}/a.exr",
        "a.csv",
        "a.exr",
    ),
    "importance measure": (
        "{made}/chalk.binary --light {made}/grove.exr --ways cosine light+half-vector"
        " --resolution 4 --points 1 --samples 4 --repetitions 2"
        " -o {out}/a.csv --images {out}/a.exr",
        "a.csv",
        "a.exr",
    ),
    "psnr-level angles": ("--objects sphere --resolution 4 -o {out}/a.exr", "a.exr"),
    "psnr-level measure": (
        "{made}/chalk.binary --fits bivariate={made}/chalk.npz --scenes configured/A={made}/A"
        " -o {out}/a.csv",
        "a.csv",
    ),
    "psnr-level table": ("{made}/level.csv -o {out}/a.csv", "a.csv"),
    "factor": ("hapke-lommel --resolution 4x1x8x8 -o {out}/a.npz", "a.npz", "a.json"),
    "factorisation terms": (
        "ward-isotropic --most 1x1 --resolution 4x1x8x8 -o {out}/a.csv",
        "a.csv",
    ),
    "accuracy-cost traces": ("--fits one={made} --materials chalk -o {out}/a.csv", "a.csv"),
}


def words(verb, folder, out):
    return f"{verb} {CALLS[verb][0].format(made=folder / 'made', out=out)}".split()


@pytest.fixture(scope="module")
def folder(tmp_path_factory, table, light_file):
    """What verbs read, in ``made``; what each has written from it, in folders of their own."""
    folder = tmp_path_factory.mktemp("outputs")
    made = folder / "made"
    for call in [
        f"material --synthetic chalk -o {made}/chalk.binary",
        f"fit {made}/chalk.binary --model bivariate -o {made}/chalk.npz",
        f"light {light_file} --layout lat-long --height 8 -o {made}/grove.exr",
        f"scene --light {made}/grove.exr --objects sphere --resolution 4 --samples 16"
        f" --record {made}/A.json -o {made}/A",
        f"render {made}/A {made}/chalk.binary -o {made}/measured.exr",
        f"render {made}/A {made}/chalk.npz -o {made}/fitted.exr",
    ]:
        assert main(call.split()) == 0
    scenes, fitted = f"--scenes {made}/0", f"--fits bivariate={made}/chalk.npz"
    shutil.copytree(made / "A", made / "0")
    call = f"video frames {made}/chalk.binary {scenes} {fitted} -o {made}/frames.exr"
    assert main(call.split()) == 0
    (made / "brdfs").mkdir()
    os.link(made / "chalk.binary", made / "brdfs" / "chalk.binary")
    shapes = {"D": (3, 90), "F": (3, 90), "G": (3, 90), "rho_d": (3,), "rho_s": (3,)}
    parameters = {name: np.ones(shape, dtype=np.float32) for name, shape in shapes.items()}
    fits.save(made / "fits/independent-g/chalk.npz", Fit("independent-g", parameters, MERL))
    (made / "fits/bivariate").mkdir()
    for suffix in (".npz", ".json"):
        os.link(made / f"chalk{suffix}", made / f"fits/bivariate/chalk{suffix}")
    tables.write(made / "fits.csv", tables.fits(made, ["chalk"], ["bivariate"]))
    row = "all,chalk,ggx,logarithm,1,1,lower"
    (made / "PerceptualDistances.csv").write_text("METHOD;BRDF;DISTANCE\nGGX;chalk;0.5\n")
    (made / "MaterialType.csv").write_text("BRDF;Type\nchalk;Stone\n")
    (made / "quality.csv").write_text(f"{','.join(quality.COLUMNS)}\n{row}\n")
    row = row.replace("ggx", "bivariate")
    (made / "chalk.csv").write_text(f"{','.join(quality.COLUMNS)}\n{row}\n")
    (made / "materials").mkdir()
    shutil.copy(made / "chalk.binary", made / "materials")
    pictures = made / "renders/A/chalk"
    pictures.mkdir(parents=True)
    for suffix in (".exr", ".png"):
        shutil.copy(made / f"measured{suffix}", pictures)
        for variant in ("bivariate", "independent-g"):
            shutil.copy(made / f"fitted{suffix}", pictures / f"{variant}{suffix}")
    psnr = tables.psnr(made, ["A"], ["chalk"], ["bivariate", "independent-g"])
    tables.write(made / "psnr.csv", psnr)
    variants = ["bivariate", "independent-g"]
    summary = pd.DataFrame({"variant": variants, "scene": "all", "bytes": 1000})
    tables.write(made / "summary.csv", summary)
    rows = [("touched", "A", "chalk", "bivariate", 40.0, 1.0, 0.5)]
    tables.write(made / "level.csv", pd.DataFrame(rows, columns=psnr_level.MEASURED))
    rows = [("chalk", "compared", "bivariate", "A", 1.0, 100, 40.0)]
    tables.write(made / "compared.csv", pd.DataFrame(rows, columns=FITS))
    rows = [("chalk", "red", 8, 2, *[0.01] * (len(uniqueness.CHANNEL) - 4))]
    tables.write(made / "uniqueness.csv", pd.DataFrame(rows, columns=uniqueness.CHANNEL))
    rows = pd.DataFrame(columns=stability.COLUMNS)
    tables.write(made / "stability.csv", rows)
    shapes = {"rho_d": 3, "rho_s": 3, "alpha": 1, "f0": 1}
    lobe = {name: np.full(count, 0.1, dtype=np.float32) for name, count in shapes.items()}
    fits.save(made / "lobe.npz", Fit("ggx-fitted", lobe, MERL))
    fits.save(made / "ggx.npz", registry.model("ggx").fit(table, Objective(), None, 1))
    for verb in CALLS:
        assert main(words(verb, folder, folder / verb.replace(" ", "-"))) == 0, verb
    return folder


def tree(folder):
    """Everything in a folder: contents of files, targets of links."""
    return {
        str(path): path.readlink() if path.is_symlink() else path.is_dir() or path.read_bytes()
        for path in folder.rglob("*")
    }


def refused(capsys, call, message):
    assert main(call) == 1
    said = capsys.readouterr().err
    assert said.startswith(f"npfm {call[0]}: ") and said.count("\n") == 1
    assert message in said


def test_no_verb_is_forgotten():
    assert {verb.split()[0] for verb in CALLS} == set(VERBS)


@pytest.mark.parametrize("verb", CALLS)
def test_a_verb_writes_what_is_expected_and_again(folder, verb):
    out = folder / verb.replace(" ", "-")
    assert {path.name for path in out.iterdir()} == set(CALLS[verb][1:])
    assert main(words(verb, folder, out)) == 0
    assert {path.name for path in out.iterdir()} == set(CALLS[verb][1:])


OUTPUTS = [(verb, name) for verb, (_, *names) in CALLS.items() for name in names]


@pytest.mark.parametrize(("verb", "name"), OUTPUTS)
def test_nothing_that_a_verb_did_not_write_is_touched(tmp_path, folder, capsys, verb, name):
    made = tmp_path / "made"
    made.mkdir()
    (made / "notes").write_text("mine")
    for link in (made / "notes", made, tmp_path / "nowhere"):
        (tmp_path / name).symlink_to(link)
        before = tree(tmp_path)
        refused(capsys, words(verb, folder, tmp_path), f"{tmp_path / name}: a link is there")
        assert tree(tmp_path) == before
        (tmp_path / name).unlink()
    (tmp_path / name).write_text("mine")
    before = tree(tmp_path)
    refused(capsys, words(verb, folder, tmp_path), f"{tmp_path / name}: a file is there")
    assert tree(tmp_path) == before
    (tmp_path / name).unlink()
    shutil.copytree(made, tmp_path / name)
    before = tree(tmp_path)
    refused(capsys, words(verb, folder, tmp_path), f"{tmp_path / name}: a folder is there")
    assert tree(tmp_path) == before


@pytest.mark.parametrize(
    ("verb", "name"), [pair for pair in OUTPUTS if pair[1].endswith((".exr", ".png", ".csv"))]
)
def test_not_even_files_of_the_same_format(tmp_path, folder, capsys, verb, name):
    """Pictures of other programs, and other tables."""
    import OpenImageIO as oiio

    if name.endswith(".csv"):
        (tmp_path / name).write_text("when,what\n2026,mine\n")
    else:
        oiio.ImageBuf(oiio.ImageSpec(8, 4, 3, oiio.FLOAT)).write(str(tmp_path / name))
    before = tree(tmp_path)
    refused(capsys, words(verb, folder, tmp_path), f"{tmp_path / name}: a file is there")
    assert tree(tmp_path) == before


@pytest.mark.parametrize("verb", CALLS)
@pytest.mark.parametrize("name", [".", "/", "..", "made/..", "", "notes/a", "a.txt", "a.jpeg"])
def test_places_and_suffixes_that_no_output_has(tmp_path, folder, monkeypatch, capsys, verb, name):
    (tmp_path / "made").mkdir()
    (tmp_path / "notes").write_text("mine")
    monkeypatch.chdir(tmp_path)
    call = words(verb, folder, tmp_path)
    call[call.index("-o") + 1] = name
    before = tree(tmp_path)
    if verb in ("scene", "export --to mitsuba") and name.startswith("a."):
        return  # a folder may be called so
    assert main(call) == 1
    assert capsys.readouterr().err.count("\n") == 1
    assert tree(tmp_path) == before


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("light {made}/grove.exr --layout lat-long --height 4 -o {made}/grove.exr", "an input"),
        ("light {made}/grove.exr --layout lat-long --height 4 -o {made}/hard.exr", "an input"),
        ("compare {made}/measured.exr {made}/fitted.exr -o {made}/fitted.exr", "an input"),
        ("tables table1 --fits {made}/psnr.csv -o {made}/psnr.csv", "an input"),
        ("accuracy-cost table --fits {made}/psnr.csv --sampling b -o {made}/psnr.csv", "an input"),
        ("figure effects_cost --table x.csv --changed x.exr --shown {made}/figure.png"
         " -o {made}/figure.png", "an input"),
        ("render {made}/A {made}/chalk.npz -o {made}/new.png", "written as .exr"),
        ("render {made}/A {made}/chalk.npz -o {made}/new.hdr", "written as .exr"),
        ("render {made}/A {made}/chalk.npz -o {made}/new.EXR", "written as .exr"),
        ("texture {made}/chalk.npz -o {made}/new.png", "written as .exr"),
        ("fit {made}/chalk.binary --model naive -o {made}/new.json", "written as .npz"),
        ("figure figure04 -o {made}/new.svg", "written as .pdf or .png"),
        ("figure figure04 -o {made}/new.pdf {made}/new.pdf", "two outputs"),
        ("effects-cost table x.csv -o {made}/psnr.csv/new.csv", "is a file and no folder"),
        ("scene --light {made}/grove.exr --objects sphere -o {made}/n --record {made}/n/r.json",
         "two outputs"),
        ("material --merl chalk --from {made}/brdfs -o {made}/brdfs/new.binary", "measurements"),
        ("material --merl chalk --from {made}/brdfs -o {made}/brdfs/chalk.binary", "measurements"),
        ("texture {made}/fits/independent-g/chalk.npz {made}/other/chalk.npz -o {made}/new.exr",
         "two inputs have the name 'chalk'"),
        ("compare {made}/fitted.exr {made}/fitted.exr -o {made}/new.exr", "two inputs"),
        ("accuracy-cost traces --fits a={made} a=b --materials chalk -o {made}/new.csv",
         "two inputs have the name 'a'"),
        ("accuracy-cost sampling --reference x --builds x --tables {made}/chalk.binary"
         " {made}/brdfs/chalk.binary --fits a.npz b.npz -o {made}/new.csv", "two inputs"),
        ("accuracy-cost sampling --reference x --builds x --tables {made}/chalk.binary"
         " --fits a.npz b.npz -o {made}/new.csv", "differ in number"),
        ("accuracy-cost fits {made}/chalk.binary --scenes {made}/A {made}/other/A --fits m:a={made}"
         " -o {made}/new.csv", "two inputs have the name 'A'"),
        ("effects-cost compare {made}/A --switched x={made}/A x={made}/A --tables"
         " {made}/chalk.binary --fits {made}/chalk.npz -o {made}/n.csv --pictures {made}/n.exr",
         "two inputs have the name 'x'"),
    ],
)  # fmt: skip
def test_inputs_stay_what_they_are(folder, capsys, call, message):
    made = folder / "made"
    if not (made / "hard.exr").exists():
        os.link(made / "grove.exr", made / "hard.exr")
        main(["figure", "figure04", "-o", str(made / "figure.png")])
        capsys.readouterr()
    before = tree(made)
    assert main(call.format(made=made).split()) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert any(part in said for part in message.split("|"))
    assert tree(made) == before


def test_a_name_that_is_also_that_of_the_output_is_no_input(folder, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call = f"scene --light {folder}/made/grove.exr --objects sphere --resolution 4 --samples 16"
    for _ in range(2):
        assert main([*call.split(), "-o", "sphere"]) == 0


def test_texture_refuses_names_that_its_header_could_not_tell_apart(folder, tmp_path, capsys):
    shutil.copy(folder / "made/fits/independent-g/chalk.npz", tmp_path / "red paint.npz")
    call = ["texture", str(tmp_path / "red paint.npz"), "-o", str(tmp_path / "a.exr")]
    refused(capsys, call, "'red paint': blanks stand between names")


#: Runs a verb that stops when it has written everything, before that gets its name.
WAITING = """
import sys, time
from npfm.__main__ import main
from npfm.storage import files

def wait(temporary, path):
    assert temporary.exists() or temporary.is_symlink()
    print("written", flush=True)
    time.sleep(120)

files._put = wait
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.parametrize(
    ("verb", "number"),
    [*((verb, signal.SIGTERM) for verb in CALLS), ("scene", signal.SIGHUP), ("fit", signal.SIGHUP)],
)
def test_a_verb_that_is_told_to_stop_leaves_nothing_half_done(folder, verb, number):
    out = folder / verb.replace(" ", "-")
    before = tree(out)
    call = [sys.executable, "-c", WAITING, *words(verb, folder, out)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(call, **pipes) as process:
        assert process.stdout.readline() == "written\n", process.stderr.read()
        assert len(tree(out)) > len(before)
        process.send_signal(number)
        # Another one in the midst of cleaning changes nothing.
        process.send_signal(number)
        said = process.communicate()[1]
    assert process.returncode == -number
    assert "Traceback" not in said
    assert tree(out) == before


def test_a_signal_that_is_ignored_stays_ignored(folder, tmp_path):
    code = "import os, signal\n" + WAITING.replace(
        "time.sleep(120)", "os.kill(os.getpid(), signal.SIGHUP); os.replace(temporary, path)"
    )
    call = [sys.executable, "-c", code, *words("light", folder, tmp_path)]
    run = subprocess.run(
        call, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN), capture_output=True
    )
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "a.exr").exists()


def test_a_verb_that_worked_says_what_it_wrote(tmp_path, capsys):
    table, fit, light, scene, picture = (
        str(tmp_path / name) for name in ("felt.binary", "felt.npz", "l.exr", "scene", "felt.exr")
    )
    calls = {
        f"material --synthetic pink-felt -o {table}": rf"wrote {table}\n",
        f"fit {table} --model bivariate -o {fit}": (
            rf"wrote {fit}, {tmp_path}/felt.json: objective 0\.\d+ \(floor 0?.*\), "
            r"\d\.\d\d s, 97200 bytes, converged\n"
        ),
        f"light --generate grove --height 16 -o {light}": rf"wrote {light}\n",
        f"scene --light {light} --objects sphere --resolution 8 --samples 8 -o {scene}": (
            rf"wrote {scene}: 0 shadow rays, \d+ entries, \d+ MB, \d+\.\d s\n"
        ),
        f"render {scene} {fit} -o {picture}": rf"wrote {picture}, {tmp_path}/felt.png\n",
    }
    for call, said in calls.items():
        assert main(call.split()) == 0
        assert re.fullmatch(f"npfm {call.split()[0]}: {said}", capsys.readouterr().err)
