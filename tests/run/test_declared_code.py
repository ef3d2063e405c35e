"""What each verb declares to run, against what it really imports."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bsdf import fields, tensor_file

from npfm.__main__ import main
from npfm.fitting import fits, registry
from npfm.fitting.basis import library
from npfm.fitting.objective import Objective
from npfm.fitting.solvers.choice import module_of
from npfm.run.provenance import closure, command_code, covered

ROOT = Path(__file__).parents[2]
FIT = (
    "chalk = Aggregate(Lambertian(albedo = [0, 0, 0]), "
    "NganCookTorrance(albedo = [1, 1, 1], eta = 0.5, roughness = 0.1))\n"
)
#: Runs verbs, a line each, and says which modules of npfm each has imported when it is done. Every
#: verb starts without npfm, in a fork; what it takes from elsewhere is there before.
CODE = """
import os, sys
import matplotlib.figure, numpy, pandas, scipy.ndimage, scipy.optimize
for line in sys.stdin:
    if not os.fork():
        from npfm.__main__ import main
        assert main(line.split()) == 0
        print(*(name for name in sys.modules if name.split(".")[0] == "npfm"), end="", flush=True)
        os._exit(0)
    os.wait()
    print(flush=True)
"""


#: Strategies that shared-lobes sampling compares, by the names of their files.
LOBES_STRATEGIES = ("cosine", "half_vector", "light", "normal_distribution")


def models(*names):
    return [registry.declared(name).module for name in names]


#: Strategies that shared points are from, whatever the ways that are measured.
SHARED = [f"npfm.rendering.sampling.{name}" for name in ("light", "half_vector")]
#: By what a rule names: the modules that are chosen, and a call, in the folder of a run.
CALLS = [
    ("material synthetic", [], "material --synthetic chalk -o x.binary"),
    ("material formula", [], "material --formula hapke-lommel -o x.binary"),
    ("material neural", [], "material --neural nylon --from {archive} -o x.binary"),
    ("material merl", [], "material --merl chalk --from materials -o x.binary"),
    (
        "material synthetic-anisotropic",
        [],
        "material --synthetic-anisotropic satin -o x.bin",
    ),
    ("material utia", [], "material --utia satin --from . -o links/x.bin"),
    ("material rgl", [], "material --rgl paint --from . -o x.binary"),
    ("fit", models("bivariate"), "fit chalk.binary --model bivariate -o x.npz"),
    (
        "fit",
        [*models("naive"), module_of("awls")],
        "fit chalk.binary --model naive --solver awls --max-iterations 1 -o x.npz",
    ),
    (
        "fit",
        [*models("g-from-d"), module_of("gauss-newton")],
        "fit chalk.binary --model g-from-d --max-iterations 1 -o x.npz",
    ),
    (
        "fit",
        [*models("g-from-d"), module_of("gauss-newton"), "npfm.fitting.iterations"],
        "fit chalk.binary --model g-from-d --max-iterations 1 --iterations y.npz -o x.npz",
    ),
    (
        "fit",
        models("cook-torrance-published"),
        "fit chalk.binary --model cook-torrance-published --published x.fit -o x.npz",
    ),
    (
        "fit",
        models("independent-g-published"),
        "fit chalk.binary --model independent-g-published --published factors.npz -o x.npz",
    ),
    ("light generate", [], "light --generate house --height 8 -o x.exr"),
    ("light file", [], "light lights/grove.exr --layout lat-long --height 8 -o x.exr"),
    (
        "scene",
        ["npfm.rendering.sampling.cosine"],
        "scene --light lights/grove.exr --objects sphere --resolution 4 --samples 4"
        " --sampling cosine -o x",
    ),
    ("render", [], "render scenes/A chalk.binary -o x.exr"),
    (
        "interreflect",
        models("naive"),
        "interreflect fits/naive/chalk.npz --measured chalk.binary --light lights/grove.exr"
        " --objects figure --resolution 4 --paths 1 -o x.exr",
    ),
    (
        "bounces render",
        ["npfm.rendering.sampling.cosine"],
        "bounces render --sampling cosine --tables"
        + 5 * " chalk.binary"
        + " --resolution 4 --paths 16 --record x.json -o x.exr",
    ),
    ("render", models("naive"), "render scenes/A fits/naive/chalk.npz -o x.exr"),
    (
        "tables psnr",
        [],
        "tables psnr --run . --scenes A --materials chalk --variants naive -o x.csv",
    ),
    ("tables fits", [], "tables fits --run . --materials chalk --variants naive -o x.csv"),
    ("tables materials", [], "tables materials --run . --materials chalk -o x.csv"),
    ("tables summary", [], "tables summary --run . --psnr psnr.csv -o x.csv"),
    ("tables table1", [], "tables table1 --fits fits.csv -o x.csv"),
    (
        "tables fidelity",
        models("naive"),
        "tables fidelity --run . --psnr psnr.csv --measured chalk.binary -o x.csv",
    ),
    (
        "tables where",
        models("naive"),
        "tables where --run . --materials chalk --variants naive --spheres A -o x.csv",
    ),
    (
        "quality material",
        models("naive"),
        "quality material chalk.binary --run . --scenes A --variants naive -o x.csv",
    ),
    ("quality gather", [], "quality gather quality.csv -o x.csv"),
    ("quality summary", [], "quality summary quality.csv -o x.csv"),
    (
        "gallery material",
        [],
        "gallery material chalk --run . --scenes A=1,2 --variants naive --quality quality.csv"
        " -o x.html",
    ),
    (
        "gallery overview",
        [],
        "gallery overview run --quality quality.csv --fits rated.csv --summary summary.csv"
        " -o x.html",
    ),
    (
        "gallery demo",
        [],
        "gallery demo run --run . --scenes A=1,2 --lights lights/grove.exr --fits fits.csv"
        " -o x.html",
    ),
    ("gallery table", [], "gallery table chalk.binary -o x.js"),
    ("gallery figure", [], "gallery figure -o x.js"),
    (
        "video frames",
        models("naive"),
        "video frames materials/chalk.binary --scenes scenes/0 --fits naive=fits/naive/chalk.npz"
        " -o x.exr",
    ),
    (
        "video page",
        [],
        "video page chalk --frames frames.exr --iterations iterations.npz -o x.html",
    ),
    ("video light", [], "video light chalk --frames frames.exr -o x.gif"),
    ("video starts", [], "video starts chalk --iterations iterations.npz -o x.gif"),
    (
        "perception",
        [],
        "perception correlations --quality quality.csv --opinions . -o x.csv",
    ),
    ("figure", ["npfm.figures.figure04"], "figure figure04 -o x.pdf"),
    (
        "figure",
        ["npfm.figures.figure08"],
        "figure figure08 --psnr psnr.csv --materials materials.csv --order diffuseness -o x.pdf",
    ),
    (
        "figure",
        ["npfm.figures.figure05", *models("naive")],
        "figure figure05 --run . --materials chalk --variants naive -o x.pdf",
    ),
    (
        "accuracy-cost traces",
        [],
        "accuracy-cost traces --fits gauss-newton=fits/naive --materials chalk -o x.csv",
    ),
    (
        "accuracy-cost fits",
        models("naive"),
        "accuracy-cost fits materials/chalk.binary --scenes scenes/A"
        " --fits model:naive=fits/naive -o x.csv",
    ),
    (
        "effects-cost compare",
        models("naive"),
        "effects-cost compare scenes/A --tables chalk.binary --fits fits/naive/chalk.npz"
        " -o x.csv --pictures y.exr",
    ),
    (
        "vary",
        models("independent-g"),
        "vary scenes/A lobe.npz lobe.npz --objects sphere --blend same-albedo -o x.exr",
    ),
    (
        "blends",
        models("independent-g"),
        "blends scenes/A --objects sphere --measured"
        + 4 * " chalk.binary"
        + " --fits"
        + 4 * " lobe.npz"
        + " --steps 1 --pictures x.exr --half-way y.csv -o x.csv",
    ),
    ("psnr-level angles", [], "psnr-level angles --objects sphere --resolution 4 -o x.exr"),
    (
        "psnr-level measure",
        models("naive"),
        "psnr-level measure chalk.binary --fits naive=fits/naive/chalk.npz"
        " --scenes configured/A=scenes/A -o x.csv",
    ),
    ("psnr-level table", [], "psnr-level table level.csv -o x.csv"),
    ("factor", [], "factor hapke-lommel --resolution 4x1x8x8 -o x.npz"),
    (
        "factorisation",
        [],
        "factorisation terms ward-isotropic --most 1x1 --resolution 4x1x8x8 -o x.csv",
    ),
    (
        "importance measure",
        ["npfm.rendering.sampling.cosine", *SHARED],
        "importance measure chalk.binary --light lights/grove.exr --ways cosine --resolution 4"
        " --points 1 --samples 4 --repetitions 2 -o x.csv --images x.exr",
    ),
    (
        "shared-lobes",
        [
            *models("shared-lobes"),
            *(f"npfm.rendering.sampling.{name}" for name in LOBES_STRATEGIES),
        ],
        "shared-lobes sampling lobes.npz --light lights/grove.exr --resolution 4 --samples 2"
        " --reference-samples 4 --repetitions 1 -o x.csv",
    ),
    (
        "basis",
        models("independent-g"),
        "basis fit chalk.binary --factors library.npz --curves 1 --max-iterations 1 -o x.npz",
    ),
    (
        "basis",
        models("independent-g"),
        "basis measure chalk.binary --factors library.npz --fit own.npz --scenes scenes/A"
        " --curves 1 --max-iterations 1 -o x.csv",
    ),
    ("uniqueness", [], "uniqueness summary uniqueness.csv -o x.csv"),
    ("power-iterations timing", [], "power-iterations timing --repeats 1 -o x.csv"),
    (
        "export",
        ["npfm.exports.merl", *models("naive")],
        "export fits/naive/chalk.npz --to merl -o x.binary",
    ),
    ("edit", models("power-iteration"), "edit power.npz --roughness 2 -o x.npz"),
    ("stability gather", [], "stability gather stability.csv -o x.csv"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory, light_file):
    """A small run, made by its verbs."""
    folder = tmp_path_factory.mktemp("run")
    made = f"{folder}/renders/A/chalk"
    calls = [
        f"material --synthetic chalk -o {folder}/materials/chalk.binary",
        f"material --synthetic-anisotropic satin -o {folder}/satin.bin",
        f"fit {folder}/materials/chalk.binary --model naive --max-iterations 1"
        f" -o {folder}/fits/naive/chalk.npz",
        f"fit {folder}/materials/chalk.binary --model power-iteration -o {folder}/power.npz",
        f"fit {folder}/materials/chalk.binary --model independent-g --starts 1 --max-iterations 1"
        f" -o {folder}/lobe.npz",
        f"fit {folder}/materials/chalk.binary --model shared-lobes --lobes 1 --starts 1"
        f" --max-iterations 1 -o {folder}/lobes.npz",
        f"fit {folder}/materials/chalk.binary --model independent-g --starts 1"
        f" --max-iterations 1 -o {folder}/own.npz",
        f"light {light_file} --layout lat-long --height 8 -o {folder}/lights/grove.exr",
        f"scene --light {folder}/lights/grove.exr --objects sphere --resolution 8 --samples 8"
        f" --record {folder}/scenes/A.json -o {folder}/scenes/A",
        f"scene --light {folder}/lights/grove.exr --objects sphere --resolution 8 --samples 8"
        f" -o {folder}/scenes/0",
        f"render {folder}/scenes/A {folder}/materials/chalk.binary -o {made}/measured.exr",
        f"render {folder}/scenes/A {folder}/fits/naive/chalk.npz -o {made}/naive.exr",
        f"tables fits --run {folder} --materials chalk --variants naive -o {folder}/fits.csv",
        f"tables psnr --run {folder} --scenes A --materials chalk --variants naive"
        f" -o {folder}/psnr.csv",
        f"tables materials --run {folder} --materials chalk -o {folder}/materials.csv",
        f"fit {folder}/materials/chalk.binary --model g-from-d --max-iterations 1"
        f" --iterations {folder}/iterations.npz -o {folder}/g.npz",
        f"video frames {folder}/materials/chalk.binary --scenes {folder}/scenes/0"
        f" --fits naive={folder}/fits/naive/chalk.npz -o {folder}/frames.exr",
    ]
    for call in calls:
        assert main(call.split()) == 0
    shutil.copy(folder / "materials/chalk.binary", folder)
    own = dict.fromkeys(("chalk", "slate", "gypsum", "shale"), fits.load(folder / "own.npz"))
    library.save(folder / "library.npz", library.gather(own, Objective()))
    columns = "material,channel,starts,near,worst,D,G,F,F_G2,product"
    columns += ",sigma_ratio,sigma_ratio_specular,roughness"
    row = "chalk,red,8,2,0,0,0,0,0,0,0.1,0.1,0.1"
    (folder / "uniqueness.csv").write_text(f"{columns}\n{row}\n")
    (folder / "x.fit").write_text(FIT)
    (folder / "paint.bsdf").write_bytes(tensor_file(fields(np.random.default_rng(1))))
    factors = dict.fromkeys("DGF", np.ones((1, 90, 3)))
    factors |= dict.fromkeys(("rho_d", "rho_s"), np.ones((1, 3)))
    np.savez(folder / "factors.npz", names=["chalk"], **factors)
    columns = "scene,material,variant,metric,value,unit,better"
    rows = (f"all,{name},ggx,logarithm,1,1,lower" for name in ("chalk", "slate"))
    (folder / "quality.csv").write_text("\n".join([columns, *rows, ""]))
    columns = "material,variant,seconds,objective"
    (folder / "rated.csv").write_text(f"{columns}\nchalk,ggx,1,1\nslate,ggx,1,1\n")
    (folder / "summary.csv").write_text("variant,bytes\nggx,1\n")
    said = "METHOD;BRDF;DISTANCE\nGGX;chalk;0.5\nGGX;slate;0.25\n"
    (folder / "PerceptualDistances.csv").write_text(said)
    (folder / "MaterialType.csv").write_text("BRDF;Type\nchalk;Stone\n")
    columns = "setting,scene,material,variant,psnr_db,peak,grazing_share"
    (folder / "level.csv").write_text(f"{columns}\ntouched,A,chalk,naive,40,1,\n")
    columns = "case,variant,solver,status,finite,objective,objective_floor,condition,seconds"
    (folder / "stability.csv").write_text(f"{columns}\nblack,naive,awls,,True,0,0,1,1\n")
    return folder


@pytest.fixture(scope="module")
def imported(folder):
    """A function that runs a call in the folder and returns the modules of npfm that it took."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen([sys.executable, "-c", CODE], cwd=folder, env=environment, **pipes) as p:

        def run(call):
            print(call, file=p.stdin, flush=True)
            return set(p.stdout.readline().split())

        yield run


@pytest.mark.parametrize(("verb", "chosen", "call"), CALLS)
def test_a_verb_imports_what_it_declares_and_no_more(folder, imported, verb, chosen, call, request):
    if "{archive}" in call:
        archive = request.getfixturevalue("data") / "merl_nbrdf.zip"
        call = call.format(archive=archive)
    for path in folder.glob("[xy].*"):
        if path.suffix != ".fit":
            path.unlink()
    modules = imported(call)
    assert modules, "it failed"
    entries, alone = covered(verb)
    assert modules <= closure([*entries, *chosen]) | {*alone, "npfm.__main__"}
    assert command_code(verb, *chosen) != command_code(verb, *chosen, "npfm.run.words")


def test_how_pages_and_animations_look_renders_no_frames_again():
    rendered = closure(covered("video frames")[0])
    assert not {name for name in rendered if name.startswith("npfm.figures.")} - {
        "npfm.figures",
        "npfm.figures.own_colors",
    }
    assert {"npfm.exports.gallery.video", "npfm.exports.gallery.page"}.isdisjoint(rendered)
    assert "npfm.figures.animations" in closure(covered("video starts")[0])
