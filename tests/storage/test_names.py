"""Names that inputs are told apart by."""

import pytest

from npfm.errors import NpfmError
from npfm.storage.names import named


def test_a_path_may_have_what_parts_it_from_its_name():
    assert named(["ggx=a=b.npz", "naive=c.npz"], "x=y") == {"ggx": "a=b.npz", "naive": "c.npz"}


@pytest.mark.parametrize("wrong", ["ggx", "ggx=", "=a.npz", ""])
def test_what_has_no_name_or_no_path_is_refused(wrong):
    with pytest.raises(NpfmError, match=f"'{wrong}' is not written NAME=PATH, as in x=y"):
        named(["naive=c.npz", wrong], "x=y")


@pytest.mark.parametrize("given", [["a=1", "a=2"], ["scene=1"]])
def test_a_name_stands_for_one_path(given):
    with pytest.raises(NpfmError, match="two inputs have the name"):
        named(given, "x=y", taken=["scene"])
