"""Materials in motion: what a browser and a GIF show is what was rendered and fitted."""

import json
import re
import zlib
from itertools import pairwise

import numpy as np
import pytest
from browser import opened
from PIL import Image

from npfm.__main__ import main
from npfm.evaluation import turned_light
from npfm.evaluation.turned_light import Turned
from npfm.exports.gallery import starts, video
from npfm.fitting import iterations
from npfm.fitting.iterations import Iterations
from npfm.storage import pictures

HOSTILE = "Grün & </script><img src=x onerror=alert(1)> 'öl\""
NAMES = ("measured", "independent-g", "a&b <i>")
DEGREES = (0.0, 90.0, 180.0, 270.0)
SIDE, TONE = 6, (0.02, 2.2)
STARTS = ("random-1", "ones", HOSTILE)
#: States of each start in its run, by channel; the second goes on.
LENGTHS = ((3, 4, 2), (2, 5, 3), (4, 3, 3))


def turned():
    rng = np.random.default_rng(3)
    radiance = np.exp(rng.normal(2, 2, (len(DEGREES), len(NAMES), SIDE, SIDE, 3)))
    coverage = (rng.random((SIDE, SIDE)) < 0.6).astype(np.float32)
    radiance[:, 1:][..., coverage == 0, :] = radiance[:, :1][..., coverage == 0, :]
    return Turned(DEGREES, NAMES, radiance.astype(np.float32), coverage)


def followed():
    rng = np.random.default_rng(4)
    rows = []
    for channel, lengths in enumerate(LENGTHS):
        for start, count in enumerate(lengths):
            rows += [(channel, start, 0)] * count
        rows += [(channel, 1, 1)] * 2
    channel, start, run = np.array(rows).T
    factors = [10 ** rng.uniform(-5, 0, (len(rows), 90)) for _ in range(3)]
    factors = [f / f.max(axis=1, keepdims=True) for f in factors]
    return Iterations(STARTS, channel, start, run, rng.uniform(0.01, 1, len(rows)), *factors)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Inputs, and a page of them under a hostile name."""
    folder = tmp_path_factory.mktemp("video")
    turned_light.write(folder / "frames.exr", turned())
    iterations.save(folder / "starts.npz", followed())
    call = ["video", "page", HOSTILE, "--frames", str(folder / "frames.exr")]
    call += ["--iterations", str(folder / "starts.npz"), "--materials", "chrome", HOSTILE]
    assert main([*call, "-o", str(folder / "page.html")]) == 0
    return folder


def test_pictures_come_back_from_their_file(made):
    back, wanted = turned_light.read(made / "frames.exr"), turned()
    assert back.degrees == DEGREES and back.names == NAMES
    np.testing.assert_array_equal(back.radiance, wanted.radiance)
    np.testing.assert_array_equal(back.coverage, wanted.coverage)


def unpacked(content, found):
    """Factors out of the words of `starts.packed`."""
    parts = np.frombuffer(zlib.decompress(content), dtype=np.uint8).astype(np.uint16)
    states = len(found.objective)
    high, low = parts.reshape(3, 2, states, 90).transpose(1, 0, 2, 3)
    words = np.cumsum(high * 256 + low, axis=1, dtype=np.uint16)
    return starts.LEAST * 10 ** (words / starts.STEPS)


def test_factors_are_packed_to_a_few_parts_in_ten_thousand():
    found = followed()
    back = unpacked(starts.packed(found), found)
    for values, wanted in zip(back, starts.relative(found).values(), strict=True):
        np.testing.assert_allclose(values, wanted, rtol=2e-4)


SHOWN = """
await ready;
const press = async (key) => {
  document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  await new Promise((done) => setTimeout(done, 5));
};
const pixels = (canvas) => {
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const context = copy.getContext("2d", { willReadFrequently: true });
  context.drawImage(canvas, 0, 0);
  const image = context.getImageData(0, 0, canvas.width, canvas.height);
  return Array.from(image.data).filter((_, k) => k % 4 < 3);
};
const texts = (which) => [...document.querySelectorAll(which)].map((said) => said.textContent);
const panes = () => [...document.querySelectorAll(".panes canvas")].map(pixels);
const found = { turns: [], psnr: [], starts: [], title: byId("title").textContent };
for (const turn of LIGHT.degrees) {
  found.turns.push(panes());
  found.psnr.push(texts(".psnr"));
  found.captions = texts("figcaption");
  await press("ArrowRight");
}
found.around = state.turn;
await press("e");
found.errors = panes();
await press("e");
for (let channel = 0; channel < 3; channel++) {
  const last = lastIteration();
  for (let k = 0; k <= last; k++) {
    iterateTo(k);
    found.starts.push({ channel, iteration: k, last, said: texts(".now"),
      D: STARTS.names.map((_, start) => factors.D(reached(start))) });
  }
  await press("c");
}
iterateTo(0);
await press("ArrowUp");
found.up = state.iteration;
await press(" ");
const on = [timers.light !== null, byId("play-light").textContent];
await new Promise((done) => setTimeout(done, 350));
await press(" ");
found.played = [...on, timers.light !== null, state.turn > 0];
iterateTo(0);
await press("i");
await new Promise((done) => setTimeout(done, 3000));
found.ended = [state.iteration, lastIteration(), timers.starts];
choose(2);
const paths = [...document.querySelectorAll("#curves path[fill=none]")];
found.chosen = paths.filter((path) => path.getAttribute("stroke-opacity") === "1").length;
found.links = [...document.querySelectorAll("#others a")].map((a) => a.getAttribute("href"));
found.plots = byId("curves").children.length;
found.images = document.images.length;
found.wide = [document.documentElement.scrollWidth, document.documentElement.clientWidth];
return found;
"""


@pytest.fixture(scope="module")
def shown(made):
    """What a browser as wide as a phone shows."""
    return opened(made / "page.html", SHOWN, size=(500, 900))


def square(values):
    return np.array(values).reshape(SIDE, SIDE, 3)


def test_every_turn_shows_its_pictures(shown):
    display = pictures.tone_map(turned().radiance, *TONE)
    for row, panes in zip(display, shown["turns"], strict=True):
        for picture, pane in zip(row, panes, strict=True):
            np.testing.assert_array_equal(square(pane), picture)
    assert shown["around"] == 0
    wanted = [[f"{value:.2f} dB" for value in row] for row in turned().psnr()]
    assert shown["psnr"] == wanted


def test_error_maps_are_black_where_nothing_differs(shown):
    measured, *maps = map(square, shown["errors"])
    np.testing.assert_array_equal(measured, square(shown["turns"][0][0]))
    display = pictures.tone_map(turned().radiance, *TONE)[0].astype(float)
    for error, picture in zip(maps, display[1:], strict=True):
        differs = np.abs(picture - display[0]).mean(axis=2)
        assert error[differs == 0].max(initial=0) < 5
        brightness = error.sum(axis=2)
        assert np.corrcoef(differs.ravel(), brightness.ravel())[0, 1] > 0.7


def test_every_iteration_shows_its_factors(shown):
    found = followed()
    relative = starts.relative(found)["D"]
    for seen in shown["starts"]:
        for start in range(len(STARTS)):
            states = np.flatnonzero((found.channel == seen["channel"]) & (found.start == start))
            at = states[min(seen["iteration"], len(states) - 1)]
            np.testing.assert_allclose(seen["D"][start], relative[at], rtol=2e-4)
            assert float(seen["said"][start].split()[0]) == pytest.approx(
                found.objective[at], rel=1e-3
            )
            assert ("on all samples" in seen["said"][start]) == bool(found.run[at])
    assert {seen["last"] for seen in shown["starts"]} == {5, 6, 4}


def test_keys_turn_iterate_and_play(shown):
    assert shown["up"] == 1
    assert shown["played"] == [True, "❚❚", False, True]
    iteration, last, timer = shown["ended"]
    assert iteration == last and timer is None
    # One line in each of the four plots.
    assert shown["chosen"] == 4 and shown["plots"] == 4


def test_names_are_text_and_nothing_is_wider_than_a_phone(made, shown):
    assert shown["title"] == f"{HOSTILE} in motion"
    assert [c.split(" dB")[0].rsplit(maxsplit=1)[0] for c in shown["captions"]][2].startswith("a&b")
    assert shown["links"] == ["chrome.html"]
    assert shown["images"] == 0
    assert shown["wide"][0] <= shown["wide"][1]
    text = (made / "page.html").read_text(encoding="utf-8")
    assert not re.search(r"https?://(?!www\.w3\.org/)", text)
    data = re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1]
    assert json.loads(data)["material"] == HOSTILE


@pytest.mark.parametrize(("kind", "frames"), [("light", len(DEGREES)), ("starts", 7)])
def test_an_animation_has_every_step_and_begins_again(made, kind, frames):
    source = ["--frames", "frames.exr"] if kind == "light" else ["--iterations", "starts.npz"]
    call = ["video", kind, "cost $5 & $6", source[0], str(made / source[1])]
    assert main([*call, "-o", str(made / f"{kind}.gif")]) == 0
    with Image.open(made / f"{kind}.gif") as animation:
        assert animation.n_frames == frames and animation.info["loop"] == 0
        assert animation.size == (960, 400)
        seen = []
        for k in range(frames):
            animation.seek(k)
            seen.append(np.asarray(animation.convert("RGB"), dtype=float))
        assert all(np.abs(a - b).max() > 50 for a, b in pairwise(seen))


def test_a_picture_of_an_animation_has_the_colours_of_the_rendering(made):
    main(["video", "light", "x", "--frames", str(made / "frames.exr"), "-o", str(made / "a.gif")])
    with Image.open(made / "a.gif") as animation:
        seen = np.asarray(animation.convert("RGB"), dtype=float)
    # The middle of each pane, where pixels are large: the mean of what is drawn there.
    display = video.shown(turned(), TONE)[0].astype(float)
    panes = np.array_split(seen[60:380], len(NAMES), axis=1)
    for pane, picture in zip(panes, display, strict=True):
        inside = pane[(pane < 250).any(axis=2)]
        np.testing.assert_allclose(inside.mean(axis=0), picture.mean(axis=(0, 1)), atol=12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("frames x.binary --scenes a/0 b/0 --fits a=b -o {out}.exr", "two inputs have the name"),
        ("frames x.binary --scenes a/0 --fits naive.npz -o {out}.exr", "not written NAME=PATH"),
        ("frames x.binary --scenes a/0 --fits measured=x.npz -o {out}.exr", "the name 'measured'"),
        ("page x --frames {made}/one.exr --iterations x.npz -o {out}.html", "x.npz"),
        ("light x --frames {made}/one.exr -o {out}.gif", "in degrees"),
        ("light x --frames {made}/few.exr -o {out}.gif", "every fit in every turn"),
        ("starts x --iterations {made}/frames.exr -o {out}.gif", "not a record of iterations"),
    ],
)
def test_what_cannot_be_shown_is_said_in_one_line(made, tmp_path, capsys, call, message):
    picture = np.zeros((4, 4, 4))
    pictures.write_exr_parts(made / "one.exr", {"a measured": picture})
    few = {"0 measured": picture, "0 naive": picture, "90 measured": picture}
    pictures.write_exr_parts(made / "few.exr", few)
    assert main(f"video {call}".format(made=made, out=tmp_path / "out").split()) == 1
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
