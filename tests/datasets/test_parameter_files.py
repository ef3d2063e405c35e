import numpy as np
import pytest

from npfm.datasets.parameter_files import DIFFUSE
from npfm.errors import NpfmError
from npfm.fitting import registry

FILE = registry.declared("cook-torrance-published").published
LINE = (
    "{name} = Aggregate(Lambertian(albedo = [0.1, 0.2, 0.3]), "
    "NganCookTorrance(albedo = [1, 2, 3], eta = 0.5, roughness = 1e-2))\n"
)


def written(folder, text):
    path = folder / FILE.name
    path.write_text(text)
    return path


def test_a_line_a_material(tmp_path):
    text = (
        "# a comment\n\n" + LINE.format(name="red-felt") + "  # another\n" + LINE.format(name="b")
    )
    found = FILE.read(written(tmp_path, text))
    assert list(found) == ["red-felt", "b"]
    assert {name: value.tolist() for name, value in found["b"].items()} == {
        DIFFUSE: [0.1, 0.2, 0.3],
        "albedo": [1, 2, 3],
        "eta": 0.5,
        "roughness": 0.01,
    }


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("NganCookTorrance", "NganCookTorance", "unknown model 'NganCookTorance'; did you mean"),
        ("NganCookTorrance", "He", "unknown model 'He'"),
        ("Aggregate", "Sum", "not of the form"),
        ("Lambertian", "OrenNayar", "not of the form"),
        (" = Aggregate", " Aggregate", "not of the form"),
        ("))", ")", "not of the form"),
        ("0.5", "half", "not of the form"),
        ("0.5", "__import__('os')", "not of the form"),
        ("eta = 0.5", "0.5", "not of the form"),
        ("b = Agg", " = Agg", "not of the form"),
        ("eta", "etta", "has no 'etta'; did you mean eta"),
        ("eta = 0.5, ", "", "lacks 'eta'"),
        ("0.5", "[0.5, 0.6]", "1 finite numbers are expected"),
        ("[1, 2, 3]", "[1, 2]", "3 finite numbers are expected"),
        ("[1, 2, 3]", "[1, [2], 3]", "3 finite numbers are expected"),
        ("0.5", "1e999", "1 finite numbers are expected"),
        ("0.5", "1" + 400 * "0", "1 finite numbers are expected"),
        ("0.5", "{1: 2}", "1 finite numbers are expected"),
        ("eta = 0.5", "**{'eta': 0.5}", "not of the form"),
        ("))", "), weight = [1])", "not of the form"),
        ("0.5", "'0,5'", "1 finite numbers are expected"),
        ("b = Agg", "a = Agg", "'a' is in line 2 already"),
    ],
)
def test_a_bad_line_is_told_with_file_and_line(tmp_path, old, new, said):
    bad = LINE.format(name="b")
    assert old in bad
    path = written(tmp_path, "# first\n" + LINE.format(name="a") + bad.replace(old, new, 1))
    with pytest.raises(NpfmError) as caught:
        FILE.read(path)
    message = str(caught.value)
    assert message.startswith(f"{path}, line 3: ")
    assert said in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("content", "said"),
    [(None, "no such file"), (b"# none\n", "no material"), (b"a\0", "no text")],
)
def test_a_file_without_a_material_says_where_to_get_one(tmp_path, content, said):
    path = tmp_path / FILE.name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(NpfmError, match=f"{FILE.name}: {said}.*github.com/bsdfbenchmark/bbm"):
        FILE.read(path)


@pytest.mark.parametrize(
    ("variant", "count"),
    [("abc-published", 100), ("shifted-gamma-published", 100), ("cook-torrance-published", 86)],
)
def test_the_published_files_are_read_whole(data, variant, count):
    file = registry.declared(variant).published
    found = file.read(data / "published_fits" / file.name)
    assert len(found) == count
    assert all((values[DIFFUSE] >= 0).all() for values in found.values())
    assert not any(np.isnan(value).any() for p in found.values() for value in p.values())


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le-bom", "utf-16-be-bom"]
)
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_the_first_material_is_there_whatever_the_file_begins_with(tmp_path, encoding, ending):
    text = (LINE.format(name="a") + LINE.format(name="b")).replace("\n", ending)
    path = tmp_path / FILE.name
    if encoding.endswith("-bom"):
        text, encoding = "\ufeff" + text, encoding.removesuffix("-bom")
    path.write_bytes(text.encode(encoding))
    assert list(FILE.read(path)) == ["a", "b"]


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (
            "# Löw\n".encode("latin-1") + LINE.encode(),
            r"line 1: no text in UTF-8.*save it as UTF-8",
        ),
        ((LINE + "# Löw\n").encode("latin-1"), "line 2: no text in UTF-8"),
        (LINE.encode("utf-16-le"), "no text, it holds zero bytes"),
        (("\ufeff" + LINE).encode("utf-16-le") + b"x", "no text in UTF-8|truncated"),
        (b"<html><body>Not found", "looks like an HTML page, not a .fit file"),
        (b"version https://git-lfs.example/spec/v1\n", "a git-lfs pointer"),
        (b"", "is an empty file"),
    ],
)
def test_what_is_no_text_of_lines_is_told(tmp_path, content, said):
    path = tmp_path / FILE.name
    path.write_bytes(content)
    with pytest.raises(NpfmError, match=said) as caught:
        FILE.read(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_folder_and_a_huge_file_are_told(tmp_path):
    with pytest.raises(NpfmError, match=r"is a folder, not a \.fit file"):
        FILE.read(tmp_path)
    with open(tmp_path / "huge.fit", "wb") as file:
        file.write(b"# ")
        file.truncate(2**24 + 1)
    with pytest.raises(NpfmError, match=r"huge\.fit: more than 16777216 bytes"):
        FILE.read(tmp_path / "huge.fit")
