import copy
import math
import re
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from bsdf import fields, tensor_file

from npfm.datasets import synthetic_anisotropic
from npfm.declarations import NAMES_ARE
from npfm.errors import NpfmError
from npfm.fitting import registry
from npfm.reflectance.directional import UTIA, Directional
from npfm.reflectance.half_difference import MERL
from npfm.reflectance.table import Table
from npfm.reflectance.utia import write_bin
from npfm.rendering.lights.generated import LIGHTS
from npfm.run.config import ONLY_HALF_DIFFERENCE, check

ROOT = Path(__file__).parents[2]
PAPER = ("bivariate", "independent-g", "g-from-d", "naive")
DEFAULT = yaml.safe_load((ROOT / "config.yaml").read_text())


def merged(base, extra):
    if not isinstance(extra, dict):
        return extra
    base = base if isinstance(base, dict) else {}
    return base | {key: merged(base.get(key), value) for key, value in extra.items()}


def configured(**changes):
    return merged(copy.deepcopy(DEFAULT), changes)


def test_the_default_configuration_is_valid_and_needs_no_file():
    run = check(DEFAULT)
    assert run.folder == "results/default"
    assert len(run.materials) >= 12
    assert set(PAPER) <= set(run.variants) <= set(registry.models())
    assert run.scenes == ("A", "B", "C", "D")
    assert not any(run.material_inputs(name) for name in run.materials)
    assert not any(run.light_inputs(light["light"]) for light in DEFAULT["scenes"].values())


@pytest.mark.parametrize("preset", sorted((ROOT / "workflow" / "presets").glob("*.yaml")))
def test_presets_are_valid_and_named_after_their_file(preset, data, tmp_path):
    changes = yaml.safe_load(preset.read_text()) | {"data": str(data)}
    if preset.stem == "merl":
        (tmp_path / "merl").mkdir()
        (tmp_path / "merl" / "chrome.binary").touch()
        changes |= {"data": str(tmp_path), "published_fits": str(data / "published_fits")}
    run = check(configured(**changes))
    assert run.folder == f"results/{preset.stem}"
    counts = {"smoke": 2, "neural-10": 10, "neural": 100, "perception": 100, "merl": 1}
    counts |= {"anisotropic": 12, "rgl": 4, "paper": 12}
    assert len(run.materials) == counts[preset.stem]


def test_a_variant_may_have_settings_of_its_own():
    plain = {"name": "plain", "model": "naive", "objective": {"compressive": False}}
    seen = {"name": "seen", "model": "naive", "objective": {"cells": "solid-angle"}}
    run = check(configured(variants=["naive", plain, seen]))
    assert "--no-compressive" in run.variants["plain"].options
    assert "--cells solid-angle" in " ".join(run.variants["seen"].options)
    assert "--cells" not in run.variants["naive"].options
    assert "--no-compressive" not in run.variants["naive"].options
    assert run.variants["plain"].options[:2] == ("--model", "naive")


def test_only_models_that_have_a_rank_or_starts_are_told_them():
    wide = {"name": "wide", "model": "low-rank-b", "rank": 8}
    fewer = {"name": "fewer", "model": "independent-g", "starts": 3}
    run = check(configured(variants=["naive", "low-rank-b", "independent-g", wide, fewer]))
    options = {name: " ".join(variant.options) for name, variant in run.variants.items()}
    assert "--rank 8" in options["wide"]
    assert "--starts 3" in options["fewer"]
    assert "--starts 8" in options["independent-g"]
    told = options["naive"] + options["low-rank-b"]
    assert "--rank" not in told and "--starts" not in told


def test_settings_may_be_words():
    paper = {"name": "paper", "model": "power-iteration", "kernel": "paper", "fresnel": "mean"}
    run = check(configured(variants=["power-iteration", paper]))
    assert "--kernel paper --fresnel mean" in " ".join(run.variants["paper"].options)
    assert "--kernel" not in run.variants["power-iteration"].options
    with pytest.raises(NpfmError, match="kernel: unknown kernel 'papers'; "):
        check(configured(variants=[paper | {"kernel": "papers"}]))
    with pytest.raises(NpfmError, match="variants/wide/rank: give a whole number"):
        check(configured(variants=[{"name": "wide", "model": "low-rank-b", "rank": "paper"}]))


def with_published(tmp_path, lines):
    """A configuration of two materials of which some are in the file of Cook-Torrance."""
    text = (
        "{} = Aggregate(Lambertian(albedo = [0, 0, 0]), "
        "NganCookTorrance(albedo = [1, 1, 1], eta = 0.5, roughness = 0.1))\n"
    )
    path = tmp_path / "fits" / "ngan_cooktorrance.fit"
    path.parent.mkdir()
    path.write_text("".join(map(text.format, lines)))
    return configured(
        data=str(tmp_path),
        published_fits="fits",
        dataset={"materials": ["chalk", "pink-felt"]},
        variants=["naive", "cook-torrance-published"],
    )


def test_fits_that_a_published_file_lacks_are_not_made(tmp_path):
    run = check(with_published(tmp_path, ["chalk", "unknown"]))
    path = str(tmp_path / "fits" / "ngan_cooktorrance.fit")
    assert run.published_inputs("cook-torrance-published") == [path]
    assert run.published_inputs("naive") == []
    options = run.variants["cook-torrance-published"].options
    assert options[options.index("--published") + 1] == path
    assert run.fits == [
        ("chalk", "naive"),
        ("chalk", "cook-torrance-published"),
        ("pink-felt", "naive"),
    ]
    assert run.missing_option == ["--missing", "cook-torrance-published/pink-felt"]
    assert check(DEFAULT).missing_option == []


def with_factors(tmp_path, names, **changes):
    """A configuration of two materials, with factors that were published for some."""
    count = len(names)
    arrays = {name: np.ones((count, 90, 3)) for name in "DGF"}
    arrays |= {name: np.ones((count, 3)) for name in ("rho_d", "rho_s")}
    np.savez(tmp_path / "factors.npz", names=names, **arrays)
    return configured(
        data=str(tmp_path),
        dataset={"materials": ["chalk", "pink-felt"]},
        variants=["independent-g", "independent-g-published"],
        **{"published_factors": "factors.npz"} | changes,
    )


def test_published_factors_are_a_variant_of_the_materials_that_have_some(tmp_path):
    run = check(with_factors(tmp_path, ["chalk", "chrome"]))
    path = str(tmp_path / "factors.npz")
    assert run.published_inputs("independent-g-published") == [path]
    options = run.variants["independent-g-published"].options
    assert options[options.index("--published") + 1] == path
    assert run.missing_option == ["--missing", "independent-g-published/pink-felt"]
    assert run.variants_of("pink-felt") == ["independent-g"]


@pytest.mark.parametrize(
    ("names", "changes", "said"),
    [
        (["chrome"], {}, "variants/independent-g-published: .* has none of the run's materials"),
        (["chalk", "pink_felt"], {}, "has no 'pink-felt' but 'pink_felt'"),
        (["chalk"], {"published_factors": None}, "needs the key published_factors, the path of"),
        (["chalk"], {"published_factors": "none.npz"}, "none.npz: no such file"),
        (["chalk"], {"published_factors": ""}, "folder"),
    ],
)
def test_published_factors_that_do_not_serve_are_told(tmp_path, names, changes, said):
    with pytest.raises(NpfmError, match=said) as caught:
        check(with_factors(tmp_path, names, **changes))
    assert "\n" not in str(caught.value)


def test_a_published_file_without_any_of_the_materials_is_told(tmp_path):
    with pytest.raises(NpfmError, match=r"ngan_cooktorrance\.fit has none of the run's materials"):
        check(with_published(tmp_path, ["unknown"]))


def test_an_absent_or_bad_published_file_is_told(tmp_path):
    config = with_published(tmp_path, ["chalk", "chalk"])
    with pytest.raises(NpfmError, match=r"ngan_cooktorrance\.fit, line 2: 'chalk' is in line 1"):
        check(config)
    (tmp_path / "fits" / "ngan_cooktorrance.fit").unlink()
    with pytest.raises(NpfmError, match=r"ngan_cooktorrance\.fit: no such file; get it from"):
        check(config)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lihgts": {}}, r"unknown key 'lihgts'; did you mean lights"),
        ({"seed": 1}, r"config: seed: the seed of random starts is solver: \{seed: N\}; "),
        ({"solver": {"starts": 2}}, r"solver/starts: .*: models: \{independent-g: \{starts: N\}\}"),
        (
            {"variants": [{"name": "n", "model": "independent-g", "solver": {"starts": 2}}]},
            r"variants/solver/starts: .* stands beside it",
        ),
        ({"models": {"niave": {}}}, r"models: unknown model 'niave'; did you mean naive"),
        ({"models": {"naive": {"rank": 2}}}, r"models/naive: unknown key 'rank'"),
        ({"models": {"low-rank-b": {"rank": True}}}, r"models/low-rank-b/rank: give a whole"),
        (
            {"variants": [{"name": "n", "model": "low-rank-b", "rank": True}]},
            r"n/rank: give a whole",
        ),
        ({"resolution": True}, r"resolution: True is not of type 'integer'"),
        ({"scenes": {"A": {"gamma": True}}}, r"scenes/A/gamma: True is not of type 'number'"),
        ({"scenes": None}, r"'scenes' is a required property"),
        ({"scenes": dict.fromkeys("ABCD")}, r"scenes: \{\} should be non-empty"),
        ({"solver": {"metod": "awls"}}, r"solver: unknown key 'metod'; did you mean method"),
        ({"solver": {"method": "newton"}}, r"unknown solver 'newton'; did you mean gauss-newton"),
        ({"variants": ["niave"]}, r"unknown model 'niave'; did you mean naive"),
        ({"variants": [{"name": "n", "model": "naive", "rank": 2}]}, r"n: unknown key 'rank'"),
        (
            {"variants": [{"name": "n", "model": "low-rank-b", "rank": "2"}]},
            r"n/rank: give a whole",
        ),
        ({"variants": [{"name": "n", "model": "naive", "slover": {}}]}, r"did you mean solver"),
        ({"variants": ["naive", "naive"]}, r"the name 'naive' is taken"),
        ({"colors": {"niave": "#009E73"}}, r"colors: unknown variant 'niave'; did you mean naive"),
        ({"colors": {"naive": "green"}}, r"colors/naive: 'green' does not match"),
        ({"scenes": {"A": {"effects": ["shadow"]}}}, r"scenes/A: unknown effect 'shadow'"),
        ({"scenes": {"A": {"objects": ["cube"]}}}, r"scenes/A: unknown object 'cube'"),
        ({"scenes": {"A": {"light": "groove"}}}, r"unknown light 'groove'; did you mean grove"),
        ({"scenes": {"E": {"light": "grove"}}}, r"scenes/E: 'objects' is a required property"),
        ({"lights": {"x": {"file": "x.hdr"}}}, r"lights/x needs either"),
        ({"lights": {"x": {"generate": "grove; false"}}}, r"x/generate: 'grove; false' is not one"),
        ({"lights": {"x y": {"generate": "grove"}}}, r"light 'x y': a name is .*; rename it$"),
        ({"scenes": {"A;B": DEFAULT["scenes"]["A"]}}, r"scene 'A;B': a name is .*; rename it$"),
        ({"scenes": {"all": DEFAULT["scenes"]["A"]}}, r"scenes/all: .*; rename it$"),
        ({"scenes": {1: DEFAULT["scenes"]["A"]}}, r"scene 1: a name is .*; write '1' in quotes$"),
        (
            {"exports": {"bsdf": {"variants": ["naive"], "size": "4"}}},
            r"bsdf/size: '4' is not of type 'integer'",
        ),
        ({"lights": {"x": {1: 2}}}, r"lights/x: unknown key '1'"),
        ({"models": {1: {}}}, r"models: unknown model '1'"),
        ({"solver": {"tolerance": math.nan}}, r"solver/tolerance: nan is not a finite number"),
        ({"objective": {"max_angle": math.nan}}, r"objective/max_angle: nan is not a finite"),
        ({"scenes": {"A": {"exposure": math.inf}}}, r"scenes/A/exposure: inf is not a finite"),
        (
            {"variants": [{"name": "n", "model": "naive", "solver": {"tolerance": math.nan}}]},
            r"variants/0/solver/tolerance: nan is not a finite number",
        ),
        ({"name": "../x"}, r"run '../x': a name is .*; rename it$"),
        ({"name": "n" * 101}, r"run 'n*': a name is of A-Z"),
        ({"variants": [{"name": "$(x)", "model": "naive"}]}, r"variant '\$\(x\)': a name is"),
        ({"variants": [{"name": "a\nb", "model": "naive"}]}, r"variant 'a\\nb': a name is"),
        ({"dataset": {"materials": ["chalkk"]}}, r"'chalkk'; did you mean chalk"),
        ({"dataset": {"kind": "neural"}}, r"kind 'neural' needs a 'path'"),
        ({"dataset": {"kind": "neural", "path": "no.zip"}}, r"no\.zip: no such file"),
        ({"scenes": {"A": {"samples": 0}}}, r"scenes/A/samples: 0 is less than"),
    ],
)
def test_mistakes_are_told_in_one_line(changes, message):
    with pytest.raises(NpfmError, match=message) as caught:
        check(configured(**changes))
    assert "\n" not in str(caught.value)


def test_the_lights_that_can_be_generated_are_those_of_the_schema():
    schema = yaml.safe_load((ROOT / "workflow/schemas/config.schema.yaml").read_text())
    light = schema["properties"]["lights"]["additionalProperties"]["properties"]
    assert light["generate"]["enum"] == sorted(LIGHTS)


@pytest.mark.parametrize("kind", ["neural", "merl"])
def test_a_material_that_no_command_can_name_is_to_be_renamed_where_it_is(tmp_path, kind):
    name = "a$(touch X)"
    (tmp_path / f"{name}.binary").touch()
    with zipfile.ZipFile(tmp_path / "x.zip", "w") as archive:
        archive.writestr(f"{name}.h5", "")
    path, suffix = {"neural": ("x.zip", "h5"), "merl": (".", "binary")}[kind]
    dataset = {"kind": kind, "path": path, "materials": ["*"]}
    with pytest.raises(NpfmError) as caught:
        check(configured(data=str(tmp_path), dataset=dataset))
    said = f"config: the material '{name}': {NAMES_ARE}; rename '{name}.{suffix}' in "
    assert str(caught.value) == f"{said}{tmp_path / path}"


def test_null_takes_an_entry_out_of_what_a_preset_is_laid_over():
    changes = {"scenes": {"A": None, "B": None, "D": None}, "models": {"independent-g": None}}
    run = check(configured(**changes, published_factors=None))
    assert run.scenes == ("C",)
    assert "--starts" not in run.variants["independent-g"].options
    assert run.published_factors == []


def test_a_file_takes_the_place_of_a_light_that_was_generated():
    probe = {"file": "probe.hdr", "layout": "angular-map"}
    run = check(configured(lights={"cathedral": probe}))
    assert run.light_inputs("cathedral") == ["data/probe.hdr"]
    assert "--generate" not in run.light_options("cathedral")
    back = merged(
        configured(lights={"cathedral": probe}), {"lights": {"cathedral": dict.fromkeys(probe)}}
    )
    with pytest.raises(NpfmError, match="lights/cathedral needs either"):
        check(merged(back, {"lights": {"cathedral": {"generate": None}}}))
    assert check(back).light_options("cathedral") == check(DEFAULT).light_options("cathedral")


def test_each_seed_stands_with_what_is_random():
    run = check(configured(dataset={"seed": 2}, scenes={"A": {"seed": 3}}, solver={"seed": 4}))
    assert run.material_options("chalk")[-2:] == ["--seed", "2"]
    assert run.scene_options("A")[-2:] == ["--seed", "3"]
    assert run.variants["low-rank-b"].options[-2:] == ("--seed", "4")
    assert "--seed" not in run.variants["naive"].options
    assert "--seed" not in run.scene_options("B")


def test_a_scene_of_its_own_needs_nothing_but_config():
    scene = DEFAULT["scenes"]["A"] | {"light": "grove", "effects": ["antialiasing"]}
    run = check(configured(scenes={"E": scene}))
    assert run.scenes == ("A", "B", "C", "D", "E")
    assert "--effects antialiasing" in " ".join(run.scene_options("E"))


def test_a_pointless_effect_is_warned_of_and_changes_no_job():
    plain = DEFAULT["scenes"]["A"]
    scenes = {"E": plain | {"effects": ["visibility"]}, "F": plain | {"effects": []}}
    run = check(configured(scenes=scenes))
    [warning] = run.warnings
    assert warning.startswith("config: scenes/E: effect 'visibility' changes nothing on a lone")
    assert "\n" not in warning
    assert run.scene_options("E") == run.scene_options("F")
    assert check(DEFAULT).warnings == []


def test_the_conda_environment_lists_the_same_dependencies_as_the_package():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    environment = yaml.safe_load((ROOT / "workflow" / "envs" / "npfm.yaml").read_text())
    assert environment["dependencies"][-1]["pip"] == project["dependencies"]


def test_a_scene_may_say_how_it_is_sampled():
    plain = check(DEFAULT)
    usual = plain.scene_options("A")
    assert "--sampling" not in usual and "--power" not in usual
    sampling = {"strategies": ["light", "cosine"], "power": 2}
    run = check(configured(scenes={"A": {"sampling": sampling}}))
    assert run.scene_options("A") == [*usual, "--sampling", "light", "cosine", "--power", "2"]
    assert run.scene_options("D") == plain.scene_options("D")
    assert run.scene_code("A") != plain.scene_code("A")
    assert run.scene_code("D") == plain.scene_code("D")
    only = check(configured(scenes={"A": {"sampling": {"power": 2}}}))
    assert only.scene_options("A") == [*usual, "--power", "2"]
    assert only.scene_code("A") == plain.scene_code("A")


@pytest.mark.parametrize(
    ("sampling", "said"),
    [
        ({"strategies": ["cosin"]}, "scenes/A: unknown strategy 'cosin'; did you mean cosine"),
        ({"strategies": []}, "scenes/A/sampling/strategies"),
        ({"power": 0}, "scenes/A/sampling/power"),
        ({"exponent": 2}, "scenes/A/sampling: unknown key 'exponent'"),
    ],
)
def test_a_wrong_sampling_is_refused(sampling, said):
    with pytest.raises(NpfmError, match=said):
        check(configured(scenes={"A": {"sampling": sampling}}))


def directional(**changes):
    """A configuration of anisotropic materials, with a model that is declared to be for them."""
    dataset = {"kind": "synthetic-anisotropic", "materials": ["*"]} | changes.pop("dataset", {})
    return configured(**{"dataset": dataset, "variants": ["brushed"]} | changes)


@pytest.fixture
def brushed(monkeypatch):
    """One model more, for tables of both kinds."""
    both = registry.Model("npfm.models.naive", grids=("half-difference", "directional"))
    models = registry.models() | {"brushed": both}
    monkeypatch.setattr(registry, "models", lambda: models)


def test_the_dataset_decides_the_grid(brushed, tmp_path):
    run = check(directional())
    assert run.grid == UTIA
    assert run.materials == tuple(synthetic_anisotropic.materials())
    assert run.table("satin") == "results/default/materials/satin.bin"
    assert " ".join(run.grid_options) == "--grid directional 6x48x6x48"
    assert "--grid" in run.scene_options("A")
    assert run.material_options("satin") == ["--synthetic-anisotropic", "satin"]
    assert any("no Figure 3" in warning for warning in run.warnings)
    usual = check(configured(variants=["naive"]))
    assert usual.table("chalk") == "results/default/materials/chalk.binary"
    assert usual.grid_options == []
    assert not usual.warnings


def test_tables_of_synthetic_anisotropic_materials_may_be_finer(brushed):
    run = check(directional(dataset={"shape": "12x96x12x96", "seed": 4}))
    assert run.grid == Directional(12, 96, 12, 96)
    words = "--synthetic-anisotropic satin --seed 4 --shape 12x96x12x96"
    assert " ".join(run.material_options("satin")) == words


@pytest.mark.parametrize("shape", ["6x48", "sharp", "6x48x6x48 --help", "0x1x1x1"])
def test_a_shape_that_is_none_is_refused(brushed, shape):
    with pytest.raises(NpfmError, match="config: dataset/shape: ") as error:
        check(directional(dataset={"shape": shape}))
    assert "\n" not in str(error.value)


def test_only_made_anisotropic_materials_have_a_shape(brushed):
    with pytest.raises(NpfmError, match="dataset/shape: kind 'synthetic' has none; leave it out"):
        check(directional(dataset={"kind": "synthetic", "shape": "6x48x6x48"}))


def test_a_model_that_is_not_for_the_grid_is_refused_before_any_job(brushed):
    with pytest.raises(NpfmError) as error:
        check(directional(variants=["brushed", {"name": "mine", "model": "naive"}]))
    said = "config: variants/mine: 'naive' is not for tables on a directional grid; choose from "
    assert str(error.value).startswith(said)
    assert "brushed" in str(error.value)


def bins(folder, **shapes):
    (folder / "utia").mkdir()
    for name, shape in shapes.items():
        write_bin(folder / "utia" / f"{name}.bin", Table(np.ones((3, *shape)), Directional(*shape)))
    return {"kind": "utia", "path": "utia"}


def test_files_of_utia_are_found_in_their_folder(brushed, tmp_path):
    dataset = bins(tmp_path, wood=UTIA.shape, silk=UTIA.shape)
    run = check(directional(dataset=dataset, data=str(tmp_path)))
    assert (run.materials, run.grid) == (("silk", "wood"), UTIA)
    assert run.material_inputs("silk") == [str(tmp_path / "utia" / "silk.bin")]
    assert run.material_options("silk") == ["--utia", "silk", "--from", str(tmp_path / "utia")]


def test_a_run_of_utia_files_has_one_grid(brushed, tmp_path):
    dataset = bins(tmp_path, wood=UTIA.shape, silk=(4, 8, 4, 8))
    said = "silk is on the grid directional 4x8x4x8 and wood on directional 6x48x6x48; choose"
    with pytest.raises(NpfmError, match=said):
        check(directional(dataset=dataset, data=str(tmp_path)))
    alone = check(directional(dataset=dataset | {"materials": ["silk"]}, data=str(tmp_path)))
    assert alone.grid == Directional(4, 8, 4, 8)


def test_a_damaged_file_of_utia_is_left_to_the_job_that_reads_it(brushed, tmp_path):
    dataset = bins(tmp_path, wood=(4, 8, 4, 8))
    (tmp_path / "utia" / "cut.bin").write_bytes(b"cut off")
    run = check(directional(dataset=dataset, data=str(tmp_path)))
    assert (run.materials, run.grid) == (("cut", "wood"), Directional(4, 8, 4, 8))


def bsdfs(folder, **azimuths):
    (folder / "rgl").mkdir()
    for name, phi_i in azimuths.items():
        content = tensor_file(fields(np.random.default_rng(1), phi_i=phi_i))
        (folder / "rgl" / f"{name}.bsdf").write_bytes(content)
    return {"kind": "rgl", "path": "rgl"}


ISOTROPIC, TURNED = [0.0], np.linspace(-np.pi, 0, 4)


def test_isotropic_files_of_rgl_are_on_the_merl_grid(tmp_path):
    dataset = bsdfs(tmp_path, paint=ISOTROPIC, vinyl=ISOTROPIC) | {"materials": ["*"]}
    (tmp_path / "rgl" / "cut.bsdf").write_bytes(b"cut off")
    run = check(configured(dataset=dataset, data=str(tmp_path), variants=["naive"]))
    assert (run.materials, run.grid) == (("cut", "paint", "vinyl"), MERL)
    assert run.table("paint") == "results/default/materials/paint.binary"
    assert run.material_inputs("paint") == [str(tmp_path / "rgl" / "paint.bsdf")]
    assert run.material_options("paint") == ["--rgl", "paint", "--from", str(tmp_path / "rgl")]
    assert run.dataset_option == ["--dataset", "rgl"]
    with pytest.raises(NpfmError, match="dataset/shape: the materials are isotropic; leave it out"):
        check(configured(dataset=dataset | {"shape": "3x8x3x8"}, data=str(tmp_path)))


def test_anisotropic_files_of_rgl_are_on_a_directional_one(brushed, tmp_path):
    dataset = bsdfs(tmp_path, satin=TURNED)
    run = check(directional(dataset=dataset | {"shape": "3x8x3x8"}, data=str(tmp_path)))
    assert run.grid == Directional(3, 8, 3, 8)
    assert run.material_options("satin")[-2:] == ["--shape", "3x8x3x8"]
    assert run.dataset_option == ["--dataset", "rgl-anisotropic"]
    assert check(directional(dataset=dataset, data=str(tmp_path))).grid == UTIA


def test_a_run_of_rgl_files_has_one_grid(brushed, tmp_path):
    dataset = bsdfs(tmp_path, satin=TURNED, paint=ISOTROPIC)
    said = "paint is on the grid half-difference 90x90x180 and satin on directional 6x48x6x48"
    with pytest.raises(NpfmError, match=said):
        check(directional(dataset=dataset, data=str(tmp_path)))


def test_targets_that_a_directional_grid_leaves_out_are_told():
    lines = (ROOT / "Snakefile").read_text().split("if not RUN.grid.anisotropic:\n")[1]
    files = re.findall(r'^    include: "(.*)"$', lines, re.MULTILINE)
    rules = "\n".join((ROOT / file).read_text() for file in files)
    targets = sorted(re.findall(r"^ *rule (\w+):", rules, re.MULTILINE))
    assert len(targets) == len(files) > 0
    *others, last = targets
    assert f"no target {', '.join(others)} or {last}: " in ONLY_HALF_DIFFERENCE
    page = (ROOT / "docs" / "anisotropic.md").read_text().split("Left out, ")[1].split("which")[0]
    assert re.findall(r"`(\w+)`", page) == targets
