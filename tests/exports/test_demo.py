"""The demo of the gallery, in a browser, beside the offline renderer."""

from functools import partial

import demos
import numpy as np
import pandas as pd
import pytest
from browser import opened

from npfm.__main__ import main
from npfm.evaluation import tables
from npfm.exports.gallery.demo import write_table
from npfm.exports.gallery.kinds import TABLE_START
from npfm.exports.gallery.lights import coarse
from npfm.exports.shaders.shader import shader
from npfm.fitting import fits, registry
from npfm.fitting.fits import Fit
from npfm.reflectance.half_difference import MERL
from npfm.rendering.assembly import build
from npfm.rendering.lights import environment
from npfm.rendering.lights.environment import Environment
from npfm.rendering.scenes import Scene
from npfm.rendering.transport import render

HOSTILE = "Grün & \u2215script> 'öl\""
MATERIALS = ("copper", HOSTILE)
SIDE, PAIRS = 24, 256


def light():
    """A sky with three lamps, of three colours."""
    rows, columns = 32, 64
    radiance = np.full((rows, columns, 3), 0.1)
    radiance[: rows // 2] = [0.5, 0.7, 1.0]
    for (row, column), colour in {
        (9, 20): (40, 30, 20), (12, 44): (10, 30, 60), (18, 34): (30, 5, 5)
    }.items():  # fmt: skip
        radiance[row - 1 : row + 1, column - 1 : column + 1] = colour
    return Environment(radiance)


def made(model, rng):
    """A fit with smooth curves, as materials have them, between satin and gloss."""
    theta_h, theta_d = np.tan(MERL.theta_h), MERL.theta_d
    colour = rng.uniform(0.3, 0.9, (3, 1))
    F = colour + (1 - colour) * (1 - np.cos(theta_d)) ** 5
    G = np.cos(np.linspace(0, np.pi / 2, 90)) ** 0.8
    wide = [np.exp(-((theta_h / width) ** 2)) + 1e-3 for width in (0.1, 0.3, 0.05)]
    rho = {"rho_d": rng.uniform(0.01, 0.1, 3), "rho_s": np.full(3, 2.0)}
    arrays = {
        "independent-g": rho | {"D": np.stack(wide), "F": F, "G": np.stack([G] * 3)},
        "shared-lobes": rho
        | {"D": np.stack(wide)[None], "F": F, "G": np.stack([G] * 3)[None]}
        | {"rho_s": rng.uniform(0.2, 2, (3, 3))},
        "power-iteration": {"D": wide[0][None], "F": F, "rho_s": np.ones(3)},
        "ggx": {"alpha": np.array([0.1]), "F": F, "rho_s": np.ones(3)},
        "ggx-fitted": rho | {"alpha": np.array([0.2]), "f0": np.array([0.5])},
        "naive": {},
    }[model]
    return Fit(model, {name: a.astype(np.float32) for name, a in arrays.items()}, MERL)


SHOWN = ("independent-g", "shared-lobes", "power-iteration", "ggx", "ggx-fitted")
VARIANTS = ("naive", *SHOWN)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The folder of a run, with the demo, and the fits of the first material by variant."""
    folder, rng = tmp_path_factory.mktemp("demo") / "run & <i>", np.random.default_rng(7)
    first, turned = folder / "lights/first.exr", folder / "lights/turned.exr"
    environment.write(first, light())
    environment.write(turned, Environment(np.roll(light().radiance, 16, axis=1)))
    found = {}
    for variant in VARIANTS:
        for material in MATERIALS:
            fit = made(variant, rng)
            found.setdefault(variant, fit)
            fits.save(folder / "fits" / variant / f"{material}.npz", fit)
    listed = pd.DataFrame([(m, v) for m in MATERIALS for v in VARIANTS])
    tables.write(folder / "fits.csv", listed.set_axis(["material", "variant"], axis=1))
    call = ["gallery", "demo", HOSTILE, "--run", str(folder), "--scenes", "A=1,2.2", "B=0.5,2"]
    call += ["--lights", str(first), str(turned), "--fits", str(folder / "fits.csv")]
    call += ["--measured", MATERIALS[0], "--figure", "-o", str(folder / "gallery/demo.html")]
    assert main(call) == 0
    assert main(["gallery", "figure", "-o", str(folder / "gallery/figure.js")]) == 0
    table = tabulated(found["independent-g"])
    write_table(folder / "gallery/tables" / f"{MATERIALS[0]}.js", table)
    return folder, found


def tabulated(fit):
    return registry.declared(fit.model).load().tabulate(fit)


@pytest.fixture(scope="module")
def scene():
    """Transport of the sphere in the light, by many more directions than the demo has."""
    return build(Scene(("sphere",)), light(), MERL, SIDE, 8192, 1)


@pytest.fixture(scope="module")
def pictures(run):
    """Two independent pictures of every variant and of the table, and one in a turned light."""
    wanted = {(name, seed): (name, 0, seed) for name in ("measured", *SHOWN) for seed in (1, 2)}
    wanted |= {("turned", seed): ("independent-g", 1, seed) for seed in (3, 4)}
    jobs = [
        ({"material": MATERIALS[0], "left": left, "scene": scene}, seed)
        for left, scene, seed in wanted.values()
    ]
    dragged = {"material": MATERIALS[0], "left": "independent-g", "scene": 0}
    jobs.append((dragged | {"light": [np.pi / 2, 0]}, 5))
    jobs += [(dragged | {"object": "figure"}, seed) for seed in (6, 7)]
    made = demos.pictures(run[0] / "gallery/demo.html", jobs, SIDE, PAIRS)
    names = [*wanted, ("dragged", 5), ("figure", 6), ("figure", 7)]
    return dict(zip(names, made, strict=True))


@pytest.mark.parametrize("variant", SHOWN)
def test_a_fit_looks_as_npfm_renders_it(run, pictures, scene, variant):
    reference = render(scene, tabulated(run[1][variant]))[..., :3]
    two, seen = [pictures[variant, seed] for seed in (1, 2)], scene.foreground
    assert demos.limit(two, reference, seen) > 50
    # Errors of two pictures differ by the noise of both; what is left of one is what 50 dB allow.
    noise = np.mean((two[0] - two[1])[seen] ** 2) / 2
    assert (
        np.mean((two[0] - reference)[seen] ** 2) < 1.5 * noise + 1e-5 * reference[seen].max() ** 2
    )


def test_a_table_looks_as_npfm_renders_it(run, pictures, scene):
    reference = render(scene, tabulated(run[1]["independent-g"]))[..., :3]
    two = [pictures["measured", seed] for seed in (1, 2)]
    assert demos.limit(two, reference, scene.foreground) > 50


def test_the_figure_looks_as_npfm_renders_it(run, pictures):
    scene = build(Scene(("figure",)), light(), MERL, SIDE, 4096, 1)
    reference = render(scene, tabulated(run[1]["independent-g"]))[..., :3]
    assert scene.foreground.sum() > 100
    seen = scene.foreground
    off = (pictures["figure", 6] + pictures["figure", 7])[seen] / 2 - reference[seen]
    # Single precision may put an edge to the other side of the centre of a pixel.
    most = np.sort((off**2).mean(axis=1))[: int(0.98 * len(off))]
    assert most.mean() < 1e-4 * reference[seen].max() ** 2


def test_light_is_dragged_to_the_right(pictures, scene):
    names = (("dragged", 5), ("turned", 3), ("turned", 4), ("independent-g", 1))
    dragged, turned, again, straight = (pictures[name][scene.foreground] for name in names)
    noise = np.mean((turned - again) ** 2)
    assert np.mean((dragged - turned) ** 2) < 2 * noise
    assert np.mean((dragged - straight) ** 2) > 100 * noise


def test_what_lies_behind_is_the_light(pictures, scene):
    picture, behind = pictures["ggx", 1], scene.coverage == 0
    off = np.abs(picture - scene.backdrop).max(axis=-1)[behind]
    # It is smoothed: between texels and at lamps it is another.
    assert np.quantile(off, 0.6) < 1e-3


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_roughness_is_edited_as_by_npfm_edit(run, factor):
    folder, found = run
    editable = ("power-iteration", "ggx", "ggx-fitted")
    script = f"""
    state.running = false;
    await ready;
    const rowsOfAll = {list(editable)}.map((v) => rows(v, "{MATERIALS[0]}", {factor}));
    return (await Promise.all(rowsOfAll)).map((own) => Array.from(own));
    """
    for variant, said in zip(editable, opened(folder / "gallery/demo.html", script), strict=True):
        edited = registry.declared(variant).load().rougher(found[variant], (factor, factor))
        np.testing.assert_allclose(np.reshape(said, (-1, 3)), shader(edited).rows, rtol=2e-6)


#: How the page is used: by lists, keys, dragging, and at the width of a phone.
USED = """
state.size = 16;
await ready;
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const press = (key) => canvas.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
const set = async (id, value) => {
  byId(id).value = value;
  byId(id).dispatchEvent(new Event(byId(id).type === "range" ? "input" : "change"));
  await wait(300);
};
const listed = (id) => Array.from(byId(id).options, (option) => option.textContent);
const found = { title: document.title, about: byId("about").textContent };
for (const id of ["material", "left", "right", "scene"]) found[id] = listed(id);
await set("material", found.material[1]);
found.others = listed("left");
found.page = byId("page").href;
await set("left", "power-iteration");
await set("right", "independent-g");
found.tags = [byId("left-said").textContent, byId("right-said").textContent];
found.sides = sides.length;
await set("roughness", "1");
found.roughness = byId("roughness-said").textContent;
await set("left", "independent-g");
found.fixed = [byId("roughness").disabled, byId("roughness-said").textContent];
found.light = [...state.light];
press("ArrowRight");
found.turned = [...state.light];
for (let k = 1; k < 5; k++) frame(1000 * k);
found.progress = byId("progress").textContent;
found.pairs = pairs;
press(" ");
const before = pairs;
frame(9000);
found.paused = [state.running, pairs === before, byId("pause").getAttribute("aria-pressed")];
found.turns = [byId("turns").hidden];
await set("object", "figure");
press("o");
press("ArrowLeft");
found.turns.push(byId("turns").hidden, state.turns, state.figure[0], state.light[0]);
found.hash = location.hash;
found.wide = [document.documentElement.scrollWidth, document.documentElement.clientWidth];
found.trouble = byId("trouble").hidden;
return found;
"""


def test_the_page_in_a_browser(run):
    folder, _ = run
    page = folder / "gallery/demo.html"
    at = "material=copper&left=ggx&scene=B&right=no-such"
    found = opened(page, USED, at=at, size=(500, 900))
    assert found["title"] == f"Demo of the run {HOSTILE}" and HOSTILE in found["about"]
    assert found["material"] == list(MATERIALS)
    assert found["left"] == ["measured", *SHOWN] and found["others"] == list(SHOWN)
    assert found["right"] == ["the same", "measured", *SHOWN]
    assert found["tags"] == ["power-iteration", "independent-g"] and found["sides"] == 2
    assert found["roughness"] == "slopes \u00d7 2, of power-iteration"
    assert found["fixed"] == [True, "only of power-iteration, ggx, ggx-fitted"]
    assert found["light"] == [0, 0] and found["turned"] == [0.1, 0]
    assert found["pairs"] > 0 and "light directions a pixel" in found["progress"]
    assert found["paused"] == [False, True, "true"]
    assert found["turns"] == [True, False, "figure", -0.1, 0.1]
    assert "scene=B" in found["hash"] and found["trouble"]
    assert found["wide"][0] <= found["wide"][1]
    assert page.stat().st_size < 4e6


def test_a_table_is_a_script_without_names(run):
    text = (run[0] / "gallery/tables" / f"{MATERIALS[0]}.js").read_text()
    assert text.startswith(TABLE_START) and text.count("\n") == 1
    assert set(text) <= set(f'{TABLE_START}[], ".)=;/+\n') | set(map(chr, range(48, 123)))


@pytest.mark.parametrize("rows", [8, 12, 20])
def test_a_coarse_light_has_the_light_of_the_fine_one(rows):
    rng = np.random.default_rng(0)
    fine = Environment(rng.random((24, 48, 3)))
    made = Environment(coarse(fine, rows))
    assert made.radiance.shape == (rows, 2 * rows, 3)
    whole = partial(np.einsum, "r,rck->k")
    np.testing.assert_allclose(
        whole(made.solid_angle, made.radiance), whole(fine.solid_angle, fine.radiance)
    )
    if rows == 12:
        weight = fine.solid_angle[:2, None, None] * fine.radiance[:2, :2]
        expected = weight.sum((0, 1)) / (2 * fine.solid_angle[:2].sum())
        np.testing.assert_allclose(made.radiance[0, 0], expected)
    assert coarse(fine, 24) is not None and coarse(fine, 100).shape == (24, 48, 3)


def test_scenes_and_lights_in_pairs(run, capsys, tmp_path):
    folder, _ = run
    call = ["gallery", "demo", "x", "--run", str(folder), "--scenes", "A=1,2", "B=1,2"]
    call += ["--lights", str(folder / "lights/first.exr"), "--fits", str(folder / "fits.csv")]
    assert main([*call, "-o", str(tmp_path / "demo.html")]) == 1
    assert "2 scenes and 1 lights; give one to each" in capsys.readouterr().err
