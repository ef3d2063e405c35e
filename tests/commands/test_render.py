"""Pictures of one material in several scenes at once, and in each alone."""

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.reflectance.half_difference import MERL
from npfm.rendering import transport
from npfm.rendering.transport import Transport
from npfm.storage.pictures import read_exr, write_exr


def scene(seed, size):
    """A matrix with some entries in each row, for pictures of so many pixels along one side."""
    rng = np.random.default_rng(seed)
    pixels, each = size * size, 5
    cells = np.sort(rng.choice(MERL.column_count, size=(pixels, each), replace=False), axis=1)
    return Transport(
        np.arange(pixels + 1) * each,
        cells.ravel().astype(np.int32),
        rng.random((3, pixels * each), dtype=np.float32),
        np.ones((size, size), dtype=np.float32),
        rng.random((size, size, 3), dtype=np.float32),
        MERL,
    )


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Scenes of two sizes, a table and a fit of it, and light that bounces in the second."""
    folder = tmp_path_factory.mktemp("render")
    for seed, (name, size) in enumerate({"A": 6, "B": 4}.items()):
        transport.save(folder / name, scene(seed, size))
    for call in (
        f"material --synthetic chalk -o {folder}/chalk.binary",
        f"fit {folder}/chalk.binary --model bivariate -o {folder}/chalk.npz",
    ):
        assert main(call.split()) == 0
    write_exr(folder / "bounced.exr", np.full((4, 4, 3), 0.25))
    return folder


def render(words, folder, out):
    return main(f"render {words}".format(made=folder, out=out).split())


def test_several_scenes_give_the_bytes_that_each_gives_alone(folder, tmp_path):
    source = "{made}/chalk.npz --measured {made}/chalk.binary"
    several = source + " -o {out}/a.exr {out}/b.exr --exposure 0.02 1 --gamma 2.2 2.8"
    assert render("{made}/A {made}/B " + several, folder, tmp_path) == 0
    for name, tones in {"A": "", "B": " --exposure 1 --gamma 2.8"}.items():
        alone = f"{{made}}/{name} {source} -o {{out}}/alone.exr{tones}"
        assert render(alone, folder, tmp_path) == 0
        for suffix in (".exr", ".png"):
            expected = (tmp_path / f"alone{suffix}").read_bytes()
            assert (tmp_path / f"{name.lower()}{suffix}").read_bytes() == expected


def test_one_exposure_and_gamma_hold_for_all_scenes(folder, tmp_path):
    words = "{made}/A {made}/A {made}/chalk.npz --exposure 3 --gamma 2 -o {out}/a.exr {out}/b.exr"
    assert render(words, folder, tmp_path) == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize(
    ("scenes", "outputs", "bounced"),
    [
        ("{made}/A {made}/B", "{out}/a.exr {out}/b.exr", "{made}/B={made}/bounced.exr"),
        ("{made}/B", "{out}/b.exr", "{made}/bounced.exr"),
        ("{made}/B", "{out}/b.exr", "{made}/B={made}/bounced.exr"),
    ],
)
def test_light_that_bounces_is_added_in_the_scene_that_is_named(
    folder, tmp_path, scenes, outputs, bounced
):
    words = f"{scenes} {{made}}/chalk.npz -o {outputs}"
    (tmp_path / "without").mkdir()
    assert render(words, folder, tmp_path / "without") == 0
    assert render(f"{words} --bounced {bounced}", folder, tmp_path) == 0
    for path in (tmp_path / "without").glob("*.exr"):
        more = read_exr(tmp_path / path.name) - read_exr(path)
        expected = 0.25 if path.stem == "b" else 0.0
        np.testing.assert_allclose(more[..., :3], expected, atol=1e-6)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("-o {out}/a.exr", "--output: 1 for 2 scenes; give one for each scene"),
        ("-o {out}/a.exr {out}/a.exr", "two outputs in one place"),
        ("-o {out}/a.exr {out}/b.exr --exposure 1 2 3", "--exposure: 3 for 2 scenes"),
        ("-o {out}/a.exr {out}/b.exr --gamma 1 0", "--gamma: '0'"),
        ("-o {out}/a.exr {out}/b.exr --bounced {made}/bounced.exr", "give SCENE=EXR"),
        ("-o {out}/a.exr {out}/b.exr --bounced {made}/C={made}/bounced.exr", "give SCENE=EXR"),
        ("-o {out}/a.exr {out}/b.exr --bounced {made}/B=x {made}/B=y", "B=y: give SCENE=EXR"),
        ("-o {out}/bounced.exr {out}/b.exr --bounced {made}/B={out}/bounced.exr", "an input"),
    ],
)
def test_mistakes_are_one_line_and_nothing_is_rendered(folder, tmp_path, capsys, words, message):
    (tmp_path / "bounced.exr").write_bytes((folder / "bounced.exr").read_bytes())
    before = sorted(tmp_path.iterdir())
    assert render("{made}/A {made}/B {made}/chalk.npz " + words, folder, tmp_path) == 1
    said = capsys.readouterr().err
    assert said.startswith("npfm render: ") and said.count("\n") == 1
    assert message in said
    assert sorted(tmp_path.iterdir()) == before
