import pytest

from npfm.datasets.names import MERL_NAMES
from npfm.datasets.spelling import check_spelling
from npfm.errors import NpfmError
from npfm.fitting import registry


@pytest.mark.parametrize(
    "name",
    [
        "Blue-Acrylic",
        "blue_acrylic",
        "blue acrylic",
        "blue\N{EN DASH}acrylic",
        "\ufeffblue-acrylic",
        "blue-acryllic",
        "blu-acrylic",
        "blue-acrylic.binary",
    ],
)
def test_a_material_does_not_vanish_for_its_spelling(name):
    with pytest.raises(NpfmError, match=r"x\.fit: has no 'blue-acrylic' but '.*correct the name"):
        check_spelling("x.fit", [name, "pvc"], ["blue-acrylic", "pvc"])


def test_files_may_lack_materials_and_have_others():
    check_spelling("x.fit", ["blue-acrylic", "pvc", "my-own"], ["pvc"])
    # Names that are nearly alike, but each that of a material.
    check_spelling("x.fit", ["pink-fabric"], ["pink-fabric", "pink-fabric2"])
    check_spelling("x.fit", ["my-felt-1"], ["my-felt-1", "my-felt-2"])


def test_the_published_files_miss_no_material_for_its_spelling(data):
    for variant in ("abc-published", "shifted-gamma-published", "cook-torrance-published"):
        file = registry.declared(variant).published
        check_spelling(file.name, file.read(data / "published_fits" / file.name), MERL_NAMES)
