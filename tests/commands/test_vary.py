import numpy as np
from PIL import Image

from npfm.__main__ import main
from npfm.storage.pictures import read_exr


def test_the_verb_takes_a_picture_for_texture_and_says_what_is_wrong(tmp_path, light_file, capsys):
    calls = [
        f"material --synthetic chalk -o {tmp_path}/chalk.binary",
        f"material --synthetic mirror-metal -o {tmp_path}/metal.binary",
        f"scene --light {light_file} --objects sphere --resolution 12 --samples 64"
        f" -o {tmp_path}/scene",
        f"render {tmp_path}/scene {tmp_path}/metal.binary -o {tmp_path}/metal.exr",
    ]
    for call in calls:
        assert main(call.split()) == 0
    Image.fromarray(np.full((2, 2), 255, np.uint8)).save(tmp_path / "texture.png")
    (tmp_path / "none.png").write_text("no picture")
    vary = f"vary {tmp_path}/scene {tmp_path}/chalk.binary {tmp_path}/metal.binary"
    white = f"{vary} --objects sphere --texture {tmp_path}/texture.png -o {tmp_path}/white.exr"
    assert main(white.split()) == 0
    np.testing.assert_allclose(
        read_exr(tmp_path / "white.exr"), read_exr(tmp_path / "metal.exr"), rtol=1e-5, atol=1e-6
    )
    wrong = {
        f"--objects sphere --texture {tmp_path}/none.png": "cannot be read as a picture",
        "--objects figure": "made of other objects",
    }
    for options, said in wrong.items():
        assert main(f"{vary} {options} -o {tmp_path}/never.exr".split()) == 1
        assert said in capsys.readouterr().err.splitlines()[-1]
    assert not (tmp_path / "never.exr").exists()
