import json

import numpy as np
import pytest

from npfm.__main__ import main
from npfm.errors import NpfmError
from npfm.evaluation import bounces
from npfm.figures import bounces as figure
from npfm.storage.pictures import write_exr_parts


def write(folder, name, mean, variance, **record):
    parts = {"samples": mean, "variance": variance, "seconds": mean + 0.2}
    write_exr_parts(folder / f"{name}.exr", parts)
    known = {"paths": 10, "seconds": 2.0, "seconds_paths": 40}
    (folder / f"{name}.json").write_text(json.dumps(known | record))
    return str(folder / f"{name}.exr")


@pytest.fixture
def pictures(tmp_path):
    even = np.full((4, 4, 3), 2.0, dtype="f4")
    reference = write(tmp_path, "reference", even, even / 4, paths=100)
    slow = write(tmp_path, "slow", even + 0.1, 4 * even, seconds=8.0)
    quick = write(tmp_path, "quick", even, 8 * even)
    return reference, [slow, quick]


def test_variances_are_compared_by_paths_and_by_seconds(pictures):
    table = bounces.table(*pictures).set_index("sampler")
    assert tuple(table.columns) == bounces.COLUMNS[1:]
    np.testing.assert_allclose(table["n_var"], [2, 4])
    np.testing.assert_allclose(table["times"], [1, 2])
    np.testing.assert_allclose(table["times_by_seconds"], [2, 1])
    np.testing.assert_allclose(table["rms"], [0.05, 0], atol=1e-6)
    np.testing.assert_allclose(table["seconds_rms"], [0.15, 0.1], rtol=1e-5)
    np.testing.assert_allclose(table["reference_rms"], np.sqrt(0.5 / 100) / 2)


def test_a_picture_without_its_record_is_told_in_one_line(pictures, tmp_path):
    (tmp_path / "slow.json").write_text("{}")
    with pytest.raises(NpfmError, match=r"slow\.json: cannot be read") as caught:
        bounces.table(*pictures)
    assert "\n" not in str(caught.value)


def test_the_verbs_write_table_and_figure(pictures, tmp_path):
    reference, samplers = pictures
    call = ["bounces", "table", reference, *samplers, "-o", str(tmp_path / "b.csv")]
    assert main(call) == 0
    call = ["figure", "bounces", "--table", str(tmp_path / "b.csv"), "--reference", reference]
    assert main([*call, "--pictures", *samplers, "-o", str(tmp_path / "b.png")]) == 0


def test_every_sampler_has_a_column():
    rng = np.random.default_rng(2)
    parts = {name: rng.random((6, 6, 3)) for name in ("samples", "variance", "seconds")}
    drawn = figure.draw(parts["samples"], {"one": parts, "two": parts}, {"one": 1.0, "two": 2.0})
    titles = [ax.get_title() for ax in drawn.axes if ax.get_title()]
    assert titles == ["reference", "one\nN Var 1", "two\nN Var 2"]
    assert sum(len(ax.get_images()) for ax in drawn.axes if not ax.get_label()) == 7
