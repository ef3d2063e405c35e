"""What stands in a command for what cannot."""

import pytest

from npfm.declarations import is_name
from npfm.run.names import any_of
from npfm.run.words import FOLDER, as_input, option, path_word, words

#: Bytes that Linux allows an argument, which a job's whole command is one of.
MOST = 2**17


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_few_words_stand_for_themselves_and_make_nothing():
    assert words(["a", "b"]) == ["a", "b"]
    assert option("--names", ["a", "b"]) == ["--names", "a", "b"]
    assert option("--names", []) == []
    assert option("-o", "one.exr") == ["-o", "one.exr"] and words("one.exr") == ["one.exr"]
    assert not FOLDER.exists()


def test_ten_thousand_names_are_one_word_that_names_a_file_of_them(here, tmp_path):
    names = [f"{'x' * 90}-{number:05}" for number in range(10_000)]
    [word] = words(names)
    assert len(word) < 100 and word.startswith("@")
    assert (tmp_path / word[1:]).read_text().split("\n") == [*names, ""]
    assert words(names) == [word] != words(names[1:])


def test_the_longest_list_that_stands_for_itself_leaves_room_for_others():
    names = ["x" * 100] * 161
    assert words(names) == names
    assert words([*names, *names]) != [*names, *names]
    assert 5 * len(" ".join(names)) < MOST


def test_paths_that_look_like_options_or_lists_are_told_from_them():
    assert [path_word(path) for path in ("-x", "@x", "x", "/-x")] == ["./-x", "./@x", "x", "/-x"]


def test_a_path_with_braces_has_a_link(tmp_path):
    file = tmp_path / "{x}" / "y"
    file.parent.mkdir()
    file.write_text("content")
    link = as_input("{x}/y")
    assert "{" not in link
    assert (tmp_path / link).read_text() == "content"
    assert as_input("{x}/y") == link != as_input("{x}/z")
    assert as_input("x/y") == "x/y"


@pytest.mark.parametrize("name", ["a", "Red.Paint_2-x", "0", "x" * 100])
def test_names_that_any_shell_leaves_alone(name):
    assert is_name(name)


@pytest.mark.parametrize("name", ["", "-a", ".a", "a b", "a/b", "a\n", "ä", "a'", "x" * 101, 1])
def test_names_that_are_none(name):
    assert not is_name(name)


def test_a_pattern_of_no_names_matches_nothing():
    assert any_of(["a.b", "c"]) == r"a\.b|c"
    assert any_of([]) == "(?!)"
