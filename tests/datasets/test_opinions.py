import pytest

from npfm.datasets import opinions
from npfm.errors import NpfmError

HEAD = '"METHOD";"BRDF";"DISTANCE"\n'


def written(path, text):
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_distances_and_classes(tmp_path):
    path = written(tmp_path / "a.csv", f'{HEAD}"ABC";"felt";0.25\r\n"GPLVM.1";"steel";1\n')
    table = opinions.read(path)
    assert table.to_dict("list") == {
        "method": ["ABC", "GPLVM.1"], "material": ["felt", "steel"], "distance": [0.25, 1.0]
    }  # fmt: skip
    # The published file has some lines twice, and a name that is none.
    path = written(tmp_path / "b.csv", "BRDF;Type\nfelt;Cloth\nsteel_n=64;Metal\nfelt;Cloth\n")
    assert opinions.classes(path) == {"felt": "Cloth", "steel_n=64": "Metal"}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "an empty file"),
        (HEAD, "no distance in it"),
        ("METHOD,BRDF,DISTANCE\nABC,felt,0.5\n", "its first line is not 'METHOD;BRDF;DISTANCE'"),
        (HEAD + "ABC;felt\n", "line 2: 2 columns, 3 are expected"),
        (HEAD + "ABC;felt;0.5;1\n", "line 2: 4 columns"),
        (HEAD + "\n", "line 2: 0 columns"),
        (HEAD + "ABC;felt;nan\n", "line 2: the distance 'nan' is not from 0 to 1"),
        (HEAD + "ABC;felt;1e999\n", "line 2: the distance"),
        (HEAD + "ABC;felt;-0.1\n", "line 2: the distance"),
        (HEAD + "ABC;felt;0,5\n", "line 2: the distance '0,5'"),
        (HEAD + "ABC;../felt;0.5\n", "line 2: '../felt' is no name of a material"),
        (HEAD + "<b>;felt;0.5\n", "line 2: '<b>' is no name of a method"),
        (HEAD + "ABC;felt;0.5\nABC;felt;0.5\n", "line 3: 'ABC' of 'felt' is there already"),
        (HEAD + 'ABC;"felt;0.5\n', "unexpected end of data"),
        (HEAD + "ABC;felt;" + "0" * 200_000 + "\n", "field larger than field limit"),
        (b"\xff\xfe\0\0", "cannot be read as text"),
        (b"PK\x03\x04....", "a zip archive"),
        ("<!DOCTYPE html><html></html>", "an HTML page"),
        (b"a" * (opinions.MOST_BYTES + 1), "too many for it"),
    ],
)
def test_what_is_no_such_file_is_said_in_a_line(tmp_path, text, message):
    path = written(tmp_path / "a.csv", text)
    with pytest.raises(NpfmError) as error:
        opinions.read(path)
    said = str(error.value)
    assert message in said and said.startswith(str(path)) and "\n" not in said


def test_a_file_that_is_not_there_and_two_classes_of_a_material(tmp_path):
    with pytest.raises(NpfmError, match=r"a\.csv: no such file; get it from"):
        opinions.read(tmp_path / "a.csv")
    with pytest.raises(NpfmError, match=r"b\.csv: no such file; get it from"):
        opinions.classes(tmp_path / "b.csv")
    path = written(tmp_path / "b.csv", "BRDF;Type\nfelt;Cloth\nfelt;Metal\n")
    with pytest.raises(NpfmError, match="line 3: 'felt' is of two classes"):
        opinions.classes(path)


def test_the_published_files(data):
    folder = data / "perceptual"
    table = opinions.read(folder / opinions.DISTANCES)
    assert len(table) == 1926
    assert table.method.nunique() == 21 and table.material.nunique() == 100
    classes = opinions.classes(folder / opinions.CLASSES)
    assert set(classes) >= set(table.material)
    assert {classes[name] for name in table.material} == {"Metal", "Dielectric"}
