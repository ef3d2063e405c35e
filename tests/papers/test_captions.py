import pytest

from npfm.datasets import synthetic
from npfm.datasets.names import MERL_NAMES
from npfm.papers.captions import BY_DIFFUSENESS, CAPTIONS, chosen


def test_every_material_has_its_rank():
    merl, own = map(sorted, BY_DIFFUSENESS)
    assert merl == sorted(MERL_NAMES)
    assert own == synthetic.materials()


@pytest.mark.parametrize("figure", CAPTIONS)
def test_captions_are_followed_where_the_materials_are_there(figure):
    assert chosen(CAPTIONS[figure], MERL_NAMES) == list(CAPTIONS[figure])


def test_a_missing_material_is_replaced_by_the_nearest_in_diffuseness():
    assert chosen(["polyurethane-foam"], ["chrome", "nylon", "white-fabric2"]) == ["white-fabric2"]
    assert chosen(["steel"], ["chrome", "nylon", "white-fabric2"]) == ["chrome"]
    assert chosen(["steel"], ["mirror-metal", "pink-felt"]) == ["mirror-metal"]
    assert chosen(["teflon"], ["mirror-metal", "pink-felt"]) == ["pink-felt"]


def test_none_is_shown_twice_and_order_is_that_of_the_caption():
    assert chosen(["steel", "tungsten-carbide", "chrome"], ["nylon", "chrome"]) == [
        "nylon",
        "chrome",
    ]
    assert chosen(["steel", "chrome"], []) == []


def test_names_of_a_user_stand_in_their_own_order():
    assert chosen(["steel", "pink-felt"], ["c", "b", "a"]) == ["a", "c"]
