import numpy as np
from PIL import Image

from npfm.__main__ import main
from npfm.storage.pictures import read_exr, read_png


def test_the_verb_takes_a_picture_for_texture_and_says_what_is_wrong(tmp_path, light_file, capsys):
    calls = [
        f"material --synthetic chalk -o {tmp_path}/chalk.binary",
        f"material --synthetic mirror-metal -o {tmp_path}/metal.binary",
        f"scene --light {light_file} --objects sphere --resolution 12 --samples 64"
        f" --effects antialiasing -o {tmp_path}/scene",
        f"render {tmp_path}/scene {tmp_path}/metal.binary --exposure 9 -o {tmp_path}/metal.exr",
    ]
    for call in calls:
        assert main(call.split()) == 0
    Image.fromarray(np.full((2, 2), 255, np.uint8)).save(tmp_path / "texture.png")
    (tmp_path / "none.png").write_text("no picture")
    Image.fromarray(np.full((2, 2), 256, np.uint16)).save(tmp_path / "deep.png")
    Image.new("RGB", (2, 2)).save(tmp_path / "program.eps")
    vary = f"vary {tmp_path}/scene {tmp_path}/chalk.binary {tmp_path}/metal.binary"
    white = f"{vary} --objects sphere --texture {tmp_path}/texture.png --exposure 9"
    assert main(f"{white} -o {tmp_path}/white.exr".split()) == 0
    shown = [read_png(tmp_path / f"{name}.png").astype(int) for name in ("white", "metal")]
    assert np.abs(shown[0] - shown[1]).max() <= 1
    np.testing.assert_allclose(
        read_exr(tmp_path / "white.exr"), read_exr(tmp_path / "metal.exr"), rtol=1e-5, atol=1e-6
    )
    wrong = {
        f"--objects sphere --texture {tmp_path}/none.png": "cannot be read as a picture",
        f"--objects sphere --texture {tmp_path}/program.eps": "cannot be read as a picture",
        f"--objects sphere --texture {tmp_path}/deep.png": "of mode I;16; give one of 8 bits",
        "--objects figure": "made of other objects",
    }
    for options, said in wrong.items():
        assert main(f"{vary} {options} -o {tmp_path}/never.exr".split()) == 1
        assert said in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "never.exr").exists()


def test_weights_choose_between_four_and_factors_are_blended(tmp_path, light_file, capsys):
    out, names = tmp_path, ("chalk", "mirror-metal")
    calls = [
        f"scene --light {light_file} --objects sphere --resolution 12 --samples 64 -o {out}/scene"
    ]
    for name in names:
        calls += [
            f"material --synthetic {name} -o {out}/{name}.binary",
            f"fit {out}/{name}.binary --model independent-g --starts 1 --max-iterations 1"
            f" -o {out}/{name}.npz",
        ]
    calls += [f"render {out}/scene {out}/mirror-metal.npz -o {out}/metal.exr"]
    for call in calls:
        assert main(call.split()) == 0
    pixels = np.zeros((2, 2, 4), np.uint8)
    pixels[..., 2] = 9
    Image.fromarray(pixels).save(out / "third.png")
    Image.fromarray(pixels[..., 0] + np.uint16(1)).save(out / "deep.png")
    Image.fromarray(np.zeros((1, 2**24 + 1), np.uint8)).save(out / "large.png")
    pixels[1, 0] = 0
    Image.fromarray(pixels).save(out / "empty.png")
    four = f"{out}/chalk.npz {out}/chalk.npz {out}/mirror-metal.npz {out}/chalk.npz"
    vary = f"vary {out}/scene --objects sphere"
    for blend in ("tables", "log-factors", "same-albedo"):
        call = f"{vary} --weights {out}/third.png --blend {blend} -o {out}/{blend}.exr {four}"
        assert main(call.split()) == 0
        found, expected = (read_exr(f"{out}/{name}.exr") for name in (blend, "metal"))
        np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6)
    capsys.readouterr()
    wrong = {
        f"{four} --weights {out}/no-such.png": "no such picture",
        f"{four} --weights {out}/chalk.npz": "cannot be read as a picture",
        f"{four} --weights {out}/deep.png": "a picture of mode I;16",
        f"{four} --weights {out}/large.png": "large.png: 16777217 x 1 pixels",
        f"{four} --weights {out}/empty.png": f"{out}/empty.png: no material at column 0, row 1",
        f"{out}/chalk.npz --weights {out}/third.png": "--weights are of 4 materials",
        f"{out}/chalk.binary {out}/chalk.npz --blend log-factors": "no fit, and a table has no",
        f"{four} --weights {out}/third.png --texture x.png": "not allowed with",
    }
    for options, said in wrong.items():
        assert main(f"{vary} -o {out}/never.exr {options}".split()) == 1
        error = capsys.readouterr().err
        assert said in error and error.count("\n") == 1, error
    assert not (out / "never.exr").exists()
