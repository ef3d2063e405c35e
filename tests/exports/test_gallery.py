import json
import re
import zlib
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from browser import opened
from PIL import Image

from npfm.__main__ import main
from npfm.evaluation import quality, tables
from npfm.exports.gallery import looks, page, pixels
from npfm.exports.gallery.curves import curves
from npfm.figures import style
from npfm.fitting import fits
from npfm.fitting.fits import ChannelRecord, Fit
from npfm.reflectance.half_difference import MERL
from npfm.storage import pictures

HOSTILE = "Grün & </script><img src=x onerror=alert(1)> 'öl\""
#: No file may be called so, but a file system allows all but the slash.
MATERIALS = ("chrome", HOSTILE.replace("/", "\u2215"))
VARIANTS = ("independent-g", "naive", "abc-ours", "a&b")
SCENES = ("A", "B")
SIDE = 12
TONE = {"A": (0.02, 2.2), "B": (1.0, 2.8)}


def radiance(rng, objects):
    """Noise where the objects are, of a range as real lights have."""
    noise = np.exp(rng.normal(0, 3, (SIDE, SIDE, 3)))
    return np.where(objects[..., None], noise, 0.25).astype(np.float32)


def parameters(variant, rng):
    coefficients = {"rho_d": rng.random(3), "rho_s": rng.random(3)}
    factors = {"independent-g": "DGF", "naive": "DF"}.get(variant, "")
    arrays = {name: rng.random((3, 90)) for name in factors} | coefficients
    return {name: array.astype(np.float32) for name, array in arrays.items()}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The folder of a run with hostile names, messages and numbers, and its pages."""
    folder, rng = tmp_path_factory.mktemp("gallery") / "run & <i>", np.random.default_rng(5)
    rows = []
    for material in MATERIALS:
        for scene in SCENES:
            objects = rng.random((SIDE, SIDE)) < 0.6
            for name in ("measured", *VARIANTS):
                path = folder / "renders" / scene / material / f"{name}.exr"
                pixel = radiance(rng, objects)
                pictures.write_exr(path, np.dstack([pixel, objects]))
                shown = pictures.tone_map(pixel, *TONE[scene])
                pictures.write_png(path.with_suffix(".png"), shown)
        for variant in VARIANTS:
            status = f"degenerate: {HOSTILE}" if variant == "a&b" else "converged"
            records = tuple(
                ChannelRecord(c, rng.random(), HOSTILE, rng.random(), 0.0, status, ())
                for c in ("red", "green", "blue")
            )
            fit = Fit("independent-g", parameters(variant, rng), MERL, records)
            fits.save(folder / "fits" / variant / f"{material}.npz", fit)
            for name, metric in quality.METRICS.items():
                for scene in SCENES if name in quality.PICTURES else (quality.ALL,):
                    about = (scene, material, variant, name, rng.random())
                    rows.append((*about, metric.unit, metric.better))
    table = pd.DataFrame(rows, columns=quality.COLUMNS)
    table.loc[table.index[0], "value"] = np.inf
    table.loc[table.index[9], "value"] = np.nan
    tables.write(folder / "quality.csv", table)
    tables.write(folder / "fits.csv", tables.fits(folder, MATERIALS, VARIANTS))
    summary = pd.DataFrame({"variant": VARIANTS, "bytes": [10, 20, 30, 40]})
    tables.write(folder / "summary.csv", summary)
    diffuse = pd.DataFrame({"material": MATERIALS, "diffuseness": [0.5, 0.25]})
    tables.write(folder / "materials.csv", diffuse)
    tones = [f"{scene}={TONE[scene][0]},{TONE[scene][1]}" for scene in SCENES]
    for material in MATERIALS:
        call = ["gallery", "material", material, "--run", str(folder), "--scenes", *tones]
        call += ["--variants", *VARIANTS, "--quality", str(folder / "quality.csv")]
        call += ["-o", str(folder / "gallery/materials" / f"{material}.html")]
        assert main(call) == 0
    call = ["gallery", "overview", HOSTILE, "-o", str(folder / "gallery/index.html")]
    for name in ("quality", "fits", "summary", "materials"):
        call += [f"--{name}", str(folder / f"{name}.csv")]
    assert main(call) == 0
    return folder


class Elements(HTMLParser):
    """Elements of a page, with the text of its scripts."""

    def __init__(self, path):
        super().__init__(convert_charrefs=True)
        self.found, self.text, self.title = [], [], ""
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs)))
        self.text.append("")

    def handle_data(self, data):
        if self.text:
            self.text[-1] += data

    def of(self, tag):
        pairs = zip(self.found, self.text, strict=True)
        return [(attrs, text) for (name, attrs), text in pairs if name == tag]


def all_pages(run):
    return sorted((run / "gallery").rglob("*.html"))


def test_names_and_messages_are_text(run):
    assert len(all_pages(run)) == 1 + len(MATERIALS)
    for path in all_pages(run):
        elements = Elements(path)
        # The script, the data and the pictures, and none that a name has smuggled in.
        binaries = len(SCENES) if path.parent.name == "materials" else 0
        assert len(elements.of("script")) == 2 + binaries
        assert elements.of("img") == []
        [data] = [json.loads(text) for attrs, text in elements.of("script")
                  if attrs.get("id") == "data"]  # fmt: skip
        [(_, title)] = elements.of("title")
        assert title.strip() in (data.get("material"), f"Gallery of the run {HOSTILE}")


def test_a_page_asks_nobody_for_anything(run):
    for path in all_pages(run):
        elements = Elements(path)
        asked = [attrs[key] for _, attrs in elements.found for key in ("src", "href")
                 if key in attrs]  # fmt: skip
        assert asked in (["demo.html"], ["../index.html"])
        assert not re.search(r"https?://(?!www\.w3\.org/)", path.read_text(encoding="utf-8"))
        [policy] = [attrs["content"] for attrs, _ in elements.of("meta") if "http-equiv" in attrs]
        assert policy.startswith("default-src 'none'")


def unpacked(content, count, height, width):
    """Words of the pictures, by the words of `pixels.Packed`."""
    parts = np.frombuffer(zlib.decompress(content), dtype=np.uint8).astype(np.uint16)
    size = height * width
    differs, first, others = np.split(parts, [size, 7 * size])
    high, low = first.reshape(2, 3, size)
    words = np.repeat((high * 256 + low)[None], count, axis=0)
    high, low = others.reshape(2, count - 1, 3, -1)
    words[1:, :, differs == 1] += high * 256 + low
    return words.transpose(0, 2, 1).reshape(count, height, width, 3).copy()


@pytest.mark.parametrize("largest", [1.0, 1e4, 1e9])
def test_pictures_are_packed_without_a_loss_beyond_half_precision(largest):
    rng = np.random.default_rng(2)
    made = rng.random((4, 5, 7, 3)).astype(np.float32) * np.float32(largest)
    made[1:, :3] = made[0, :3]
    made[2, 4, 4] = np.inf, np.nan, -1
    packed = pixels.pack(made)
    words = unpacked(packed.content, 4, packed.height, packed.width)
    back = words.view(np.float16).astype(np.float32) * packed.scale
    np.testing.assert_allclose(back, made, rtol=2**-11)
    assert np.log2(packed.scale) % 1 == 0


def test_small_pictures_are_in_their_places(run):
    for material in MATERIALS:
        with Image.open(run / "gallery/materials" / f"{material}.jpg") as sheet:
            side, columns = pixels.THUMBNAIL, 1 + len(VARIANTS)
            assert sheet.size == (side * columns, side * len(SCENES))
            small = np.asarray(sheet, dtype=float).reshape(len(SCENES), side, columns, side, 3)
        for y, scene in enumerate(SCENES):
            for x, name in enumerate(("measured", *VARIANTS)):
                whole = pictures.read_png(run / "renders" / scene / material / f"{name}.png")
                np.testing.assert_allclose(small[y, :, x].mean(), whole.mean(), atol=3)


def test_curves_of_published_factors_are_in_our_scale():
    rng = np.random.default_rng(1)
    ours = {name: rng.uniform(0.5, 1, (3, 90)).astype(np.float32) for name in "DGF"}
    theirs = {name: array.astype(float) * 7 for name, array in ours.items()}
    found = {c["name"]: c for c in curves(Fit("independent-g", ours, MERL), theirs)}
    assert list(found) == ["D", "G", "F", "F G²"]
    for name in "DF":  # the nodes of G are not the same
        np.testing.assert_allclose(found[name]["values"], found[name]["published"], rtol=1e-4)
    product = ours["F"] * ours["G"].astype(float) ** 2
    shape = np.array(found["F G²"]["values"]) / product
    np.testing.assert_allclose(shape, shape[:, :1] * np.ones(90), rtol=1e-4)


def test_lobes_that_the_channels_share_are_curves_of_their_own():
    rng = np.random.default_rng(2)
    lobes = {name: rng.uniform(0.5, 1, (1, 2, 90)).astype(np.float32) for name in "DG"}
    F = rng.uniform(0.5, 1, (3, 90)).astype(np.float32)
    theirs = {name: rng.uniform(0.5, 1, (3, 90)) for name in "DGF"}
    found = {c["name"]: c for c in curves(Fit("shared-lobes", lobes | {"F": F}, MERL), theirs)}
    assert list(found) == ["D", "G", "F"]
    assert [c.get("lobes", False) for c in found.values()] == [True, True, False]
    ratio = np.array(found["D"]["values"]) / lobes["D"][0]
    np.testing.assert_allclose(ratio, ratio[:, :1] * np.ones(90), rtol=1e-4)
    # What was published are factors of another model.
    assert not any("published" in curve for curve in found.values())


def test_g_of_smith_is_a_curve_as_well():
    D = np.exp(-np.linspace(0, 5, 90))[None].repeat(3, axis=0).astype(np.float32)
    found = {c["name"]: c for c in curves(Fit("g-from-d", {"D": D, "F": D}, MERL), {})}
    assert list(found) == ["D", "G", "F", "F G²"]
    assert np.all(np.diff(found["G"]["values"]) <= 0)
    assert "published" not in found["D"]


def test_every_mark_of_the_figures_is_a_path_in_a_unit_square():
    for marker in {look.marker for look in style.LOOKS.values()} | set(style.OTHER_MARKERS):
        path = looks.mark(marker)
        assert re.fullmatch(r"(?:[MLQC](?:-?[\d.e-]+,-?[\d.e-]+ ?)+|Z)+", path), path
        places = [float(x) for x in re.findall(r"-?[\d.]+(?:e-?\d+)?", path)]
        assert 0.3 < max(map(abs, places)) < 0.8


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("A", "'A' is not written NAME=EXPOSURE,GAMMA"),
        ("A=1", "is not written"),
        ("A=one,2", "is not written"),
        ("A=0,2", "numbers above 0"),
        ("A=1,inf", "numbers above 0"),
        ("A=nan,1", "numbers above 0"),
    ],
)
def test_a_tone_map_that_is_none(run, capsys, tmp_path, given, message):
    call = ["gallery", "material", "chrome", "--run", str(run), "--scenes", given]
    call += ["--variants", "naive", "--quality", str(run / "quality.csv")]
    assert main([*call, "-o", str(tmp_path / "chrome.html")]) == 1
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1


def test_tables_of_two_runs(run, capsys, tmp_path):
    other = tables.read(run / "fits.csv", ["material", "variant"], ["seconds", "objective"])
    tables.write(tmp_path / "fits.csv", other[other.variant != "naive"])
    call = ["gallery", "overview", "x", "--quality", str(run / "quality.csv")]
    call += ["--summary", str(run / "summary.csv"), "--fits", str(tmp_path / "fits.csv")]
    assert main([*call, "-o", str(tmp_path / "index.html")]) == 1
    assert "no fit of chrome by naive" in capsys.readouterr().err


#: Every picture as it is flipped to, by the keys, whole and in parts, and what stands beside it.
FLIPS = """
await ready;
const press = async (key) => {
  document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  await new Promise((done) => setTimeout(done, 50));
};
const all = (from) => {
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [from.width, from.height];
  const context = copy.getContext("2d", { willReadFrequently: true });
  context.drawImage(from, 0, 0);
  const image = context.getImageData(0, 0, from.width, from.height);
  return Array.from(image.data).filter((_, k) => k % 4 < 3);
};
const found = { flips: [], scenes: [], table: [] };
for (const scene of DATA.scenes) {
  for (let k = 0; k < NAMES.length; k++) {
    await press(String(k + 1));
    found.flips.push({ scene: scene.name, said: byId("shown").textContent, pixels: all(sheet) });
  }
  const rows = [...document.querySelectorAll("#table tbody tr")];
  found.table.push(rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
  await press("s");
}
await press("3");
const box = canvas.getBoundingClientRect();
const side = canvas.width / DATA.scenes[0].width;
const at = (x, y) => ({ clientX: box.left + (x + 0.5) * box.width / DATA.scenes[0].width,
  clientY: box.top + (y + 0.5) * box.height / DATA.scenes[0].height, bubbles: true });
canvas.dispatchEvent(new PointerEvent("pointermove", at(3, 7)));
await new Promise((done) => setTimeout(done, 50));
found.pointer = byId("pointer").textContent;
found.whole = { side, pixels: all(canvas) };
zoomed(4, [0.5, 0.25]);
found.part = { x: state.x, y: state.y, zoom: state.zoom, pixels: all(canvas) };
zoomed(0);
await press("e");
found.error = all(sheet);
await press("1");
found.none = all(sheet);
await press("e");
await press("ArrowUp");
found.brighter = all(sheet);
found.curves = DATA.variants.map((look, k) => {
  choose(k + 1);
  return byId("curves").children.length;
});
found.wide = document.documentElement.scrollWidth;
return found;
"""


@pytest.fixture(scope="module")
def flipped(run):
    """What a browser shows of a hostile material."""
    found = opened(run / "gallery/materials" / f"{MATERIALS[1]}.html", FLIPS)
    return SimpleNamespace(**found)


def square(values, side=SIDE):
    return np.array(values).reshape(side, side, 3)


def test_flips_are_the_pictures_of_the_run_pixel_by_pixel(run, flipped):
    names = [(scene, name) for scene in SCENES for name in ("measured", *VARIANTS)]
    assert len(flipped.flips) == len(names)
    for (scene, name), flip in zip(names, flipped.flips, strict=True):
        path = run / "renders" / scene / MATERIALS[1] / f"{name}.png"
        assert flip["scene"] == scene and name in flip["said"]
        np.testing.assert_allclose(square(flip["pixels"]), pictures.read_png(path), atol=1)


def test_the_screen_shows_every_pixel_whole_and_zoomed_where_it_was(run, flipped):
    sheet = square(flipped.flips[2]["pixels"])
    side = flipped.whole["side"]
    assert side == int(side) > 10
    shown = square(flipped.whole["pixels"], SIDE * int(side))
    np.testing.assert_array_equal(shown, sheet.repeat(side, 0).repeat(side, 1))
    part = flipped.part
    assert part["zoom"] == 4 and (part["x"], part["y"]) == (SIDE * 0.375, SIDE * 0.1875)
    shown = square(part["pixels"], SIDE * int(side))
    middle = (np.arange(SIDE * int(side)) + 0.5) / side / part["zoom"]
    rows, columns = (part["y"] + middle).astype(int), (part["x"] + middle).astype(int)
    np.testing.assert_array_equal(shown, sheet[np.ix_(rows, columns)])


def test_the_value_under_the_pointer_is_that_of_the_picture(run, flipped):
    place, measured, fitted = flipped.pointer.splitlines()
    assert place == "(3, 7)"
    for line, name in ((measured, "measured"), (fitted, VARIANTS[1])):
        assert line.startswith(name)
        pixel = pictures.read_exr(run / "renders" / "A" / MATERIALS[1] / f"{name}.exr")[7, 3, :3]
        np.testing.assert_allclose([float(x) for x in line.split()[-3:]], pixel, rtol=1e-3)


def test_the_map_of_errors_and_the_exposure(run, flipped):
    folder = run / "renders" / "A" / MATERIALS[1]
    measured, fitted = (pictures.read_png(folder / f"{n}.png") for n in ("measured", VARIANTS[1]))
    differences = np.abs(measured.astype(float) - fitted).mean(axis=2)
    brightness = square(flipped.error).sum(axis=2)
    order = np.argsort(differences, axis=None)
    assert np.corrcoef(np.minimum(differences, 51).flat, brightness.flat)[0, 1] > 0.95
    assert brightness.flat[order[0]] <= brightness.flat[order[-1]]
    assert len(np.unique(square(flipped.none).reshape(-1, 3), axis=0)) == 1
    exposure, gamma = TONE["A"]
    linear = pictures.read_exr(folder / "measured.exr")[..., :3]
    brighter = pictures.tone_map(linear, exposure * 2**0.5, gamma)
    np.testing.assert_allclose(square(flipped.brighter), brighter, atol=1)


def test_the_numbers_of_a_material_are_those_of_the_tables(run, flipped):
    table = quality.read(run / "quality.csv")
    table = table[table.material == MATERIALS[1]]
    fitted = tables.read(run / "fits.csv", ["material", "variant", "status"], ["seconds"])
    for scene, rows in zip(SCENES, flipped.table, strict=True):
        for k, (variant, row) in enumerate(zip(VARIANTS, rows, strict=True)):
            assert row[:2] == [str(k + 2), variant]
            here = table[(table.variant == variant) & table.scene.isin([scene, quality.ALL])]
            numbers = here.set_index("metric").value
            assert [float(x) for x in row[2:11]] == [numbers[name] for name in quality.METRICS]
            of_fit = fitted[(fitted.variant == variant) & (fitted.material == MATERIALS[1])]
            assert float(row[12]) == pytest.approx(of_fit.seconds.sum(), rel=2e-6)
            assert row[-1] == of_fit.status.iloc[0]
    assert flipped.curves == [4, 2, 0, 0]


def test_a_phone_shows_a_material_without_scrolling_sideways(run):
    script = "await ready; return [document.documentElement.scrollWidth, innerWidth];"
    width, window = opened(run / "gallery/materials/chrome.html", script, size=(500, 900))
    assert width <= window


OVERVIEW = """
const found = { shown: {}, orders: {}, begins: [byId("quantity").value, byId("order").value] };
const change = (id, value) => {
  byId(id).value = value;
  byId(id).dispatchEvent(new Event("change"));
};
for (const q of DATA.quantities) {
  change("quantity", q.name);
  for (const option of [...byId("scene").options].map((o) => o.value)) {
    change("scene", option);
    found.shown[`${q.name} ${option}`] = points.map((p) => [p.material.name, p.look.name, p.value]);
  }
}
for (const [order] of ORDERS) {
  change("order", order);
  found.orders[order] = ordered().map((m) => m.name);
}
change("order", "diffuseness");
const press = (key) => byId("chart").dispatchEvent(new KeyboardEvent("keydown", { key }));
press("ArrowRight");
found.first = [...state.at];
press("ArrowRight");
press("ArrowDown");
found.next = [...state.at];
found.card = byId("card").textContent;
found.marks = document.querySelectorAll("#chart path[transform]").length;
document.querySelector("#legend input").click();
found.fewer = document.querySelectorAll("#chart path[transform]").length;
byId("search").value = "GRÜN";
byId("search").dispatchEvent(new Event("input"));
found.links = [...document.querySelectorAll("#materials a")].map((a) => a.href);
const pictures = [...document.querySelectorAll("#materials img")];
pictures.forEach((picture) => { picture.loading = "eager"; });
await Promise.all(pictures.map((picture) => picture.decode()));
found.pictures = pictures.map((picture) => picture.naturalWidth);
found.wide = [document.documentElement.scrollWidth, innerWidth];
return found;
"""


@pytest.mark.parametrize("size", [(1280, 900), (500, 900)])
def test_the_overview_shows_the_numbers_of_the_tables(run, size):
    found = SimpleNamespace(**opened(run / "gallery/index.html", OVERVIEW, size=size))
    table = quality.read(run / "quality.csv")
    table = table[np.isfinite(table.value)]
    for (metric, scene), rows in table.groupby(["metric", "scene"]):
        expected = set(zip(rows.material, rows.variant, rows.value, strict=True))
        assert {tuple(point) for point in found.shown[f"{metric} {scene}"]} == expected
    seconds = tables.read(run / "fits.csv", ["material", "variant"], ["seconds"])
    for material, variant, value in found.shown["seconds all"]:
        rows = seconds[(seconds.material == material) & (seconds.variant == variant)]
        assert value == pytest.approx(rows.seconds.sum(), rel=1e-5)
    by_psnr = table[table.metric == "ssim"].groupby(["material", "variant"]).value.mean()
    for material, variant, value in found.shown["ssim mean"]:
        assert value == pytest.approx(by_psnr[material, variant], rel=1e-5)
    assert found.begins == ["ssim", "worst ssim"]
    assert found.orders["diffuseness"] == [MATERIALS[1], MATERIALS[0]]
    logs = table[(table.metric == "logarithm") & (table.variant == "independent-g")]
    worst_first = logs.sort_values("value", ascending=False).material.tolist()
    assert found.orders["worst logarithm"] == worst_first
    assert found.first[0] == MATERIALS[1] and found.next[0] == MATERIALS[0]
    assert found.next[0] in found.card and found.next[1] in found.card
    assert found.marks == 8 and found.fewer == 6
    [link] = found.links
    [width] = found.pictures
    assert Path(page_at(link)).samefile(run / "gallery/materials" / f"{MATERIALS[1]}.html")
    assert width == pixels.THUMBNAIL * (1 + len(VARIANTS))
    assert found.wide[0] <= found.wide[1]


def page_at(address):
    from urllib.parse import unquote, urlsplit

    return unquote(urlsplit(address).path)


def test_numbers_that_json_does_not_have():
    assert [page.number(x) for x in (1.5, np.inf, -np.inf, np.nan)] == [1.5, "inf", "-inf", None]
    with pytest.raises(ValueError, match="JSON"):
        page.as_json(np.nan)
    assert "<" not in page.as_json("</script>\u2028&") and json.loads(page.as_json("</&")) == "</&"
