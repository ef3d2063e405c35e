import pytest

from npfm.datasets.names import MERL_NAMES, select
from npfm.errors import NpfmError


def test_there_are_a_hundred_merl_names_in_order():
    assert len(MERL_NAMES) == len(set(MERL_NAMES)) == 100
    assert list(MERL_NAMES) == sorted(MERL_NAMES)


def test_names_and_globs_give_a_sorted_list_without_repetition():
    assert select(["pvc", "chrome*", "chrome", "two-layer-?o*"], MERL_NAMES) == [
        "chrome",
        "chrome-steel",
        "pvc",
        "two-layer-gold",
    ]
    assert select(["*"], MERL_NAMES[::-1]) == list(MERL_NAMES)
    assert select([], MERL_NAMES) == []


def test_a_name_is_taken_literally_before_it_is_a_glob():
    assert select(["odd[1]"], ["odd1", "odd[1]"]) == ["odd1", "odd[1]"]


@pytest.mark.parametrize(
    ("pattern", "answer"),
    [
        ("aluminum", "did you mean aluminium"),
        ("Chrome", "did you mean chrome"),
        ("nylonn*", "did you mean nylon"),
        ("xyz", "the 100 names run from alum-bronze to yellow-plastic"),
    ],
)
def test_a_pattern_without_a_match_is_answered_with_the_nearest_names(pattern, answer):
    with pytest.raises(NpfmError) as caught:
        select(["chrome", pattern], MERL_NAMES)
    message = str(caught.value)
    assert f"'{pattern}'" in message
    assert answer in message
    assert "\n" not in message


def test_nothing_to_choose_from_is_said():
    with pytest.raises(NpfmError, match="none to choose from"):
        select(["chrome"], [])
