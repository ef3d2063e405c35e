"""Files are whole or absent."""

import os

import pytest

from npfm.errors import NpfmError
from npfm.storage.files import Kind, check_replaceable, marked, replacing

#: Files that say who wrote them, and folders of nothing but such files.
FILE = Kind("a poem", ".txt", marked(b"by npfm"))
FOLDER = Kind(
    "an anthology", "", lambda path: path.is_dir() and all(map(FILE.ours, path.iterdir()))
)
OURS = "by npfm: roses are red"


def test_the_file_appears_when_the_block_succeeds(tmp_path):
    path = tmp_path / "new" / "folder" / "a.txt"
    with replacing(path, FILE) as temporary:
        assert temporary.parent == path.parent
        assert temporary.suffix == path.suffix
        temporary.write_text("whole")
        assert not path.exists()
    assert path.read_text() == "whole"
    assert list(path.parent.iterdir()) == [path]


def test_a_failure_leaves_nothing_behind(tmp_path):
    path = tmp_path / "a.txt"
    with pytest.raises(RuntimeError, match="midway"), replacing(path, FILE) as temporary:
        temporary.write_text("half")
        raise RuntimeError("midway")
    assert list(tmp_path.iterdir()) == []


def test_a_failure_leaves_the_old_file_as_it_was(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text(OURS)
    with pytest.raises(KeyboardInterrupt), replacing(path, FILE) as temporary:
        temporary.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == OURS
    assert list(tmp_path.iterdir()) == [path]


def test_a_success_replaces_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text(OURS)
    with replacing(path, FILE) as temporary:
        temporary.write_text("new")
    assert path.read_text() == "new"


def test_two_writers_do_not_share_a_temporary_name(tmp_path):
    with replacing(tmp_path / "a.txt", FILE) as one, replacing(tmp_path / "a.txt", FILE) as other:
        assert one != other
        one.write_text("1")
        other.write_text("2")
    assert (tmp_path / "a.txt").read_text() == "1"


def test_a_block_that_writes_nothing_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError), replacing(tmp_path / "a.txt", FILE):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_folder_takes_the_place_of_its_own_kind(tmp_path):
    for text in ("one", "two"):
        with replacing(tmp_path / "a.b", FOLDER) as temporary:
            temporary.mkdir()
            (temporary / f"{text}.txt").write_text(OURS)
    assert [path.name for path in (tmp_path / "a.b").iterdir()] == ["two.txt"]
    assert list(tmp_path.iterdir()) == [tmp_path / "a.b"]


def test_the_old_folder_comes_back_when_the_new_one_cannot_take_its_place(tmp_path, monkeypatch):
    path = tmp_path / "a"
    path.mkdir()
    (path / "one.txt").write_text(OURS)
    rename = os.rename
    calls = []

    def second_fails(source, target):
        calls.append(source)
        if len(calls) == 2:
            raise OSError("no")
        rename(source, target)

    monkeypatch.setattr(os, "rename", second_fails)
    with pytest.raises(OSError, match="no"), replacing(path, FOLDER) as temporary:
        temporary.mkdir()
    assert list(tmp_path.rglob("*")) == [path, path / "one.txt"]


def tree(folder):
    """Everything in a folder: contents of files, targets of links."""
    return {
        path: path.readlink() if path.is_symlink() else path.is_dir() or path.read_bytes()
        for path in folder.rglob("*")
    }


@pytest.fixture
def users(tmp_path):
    """Things that nobody may touch."""
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "ours.txt").write_text(OURS)
    (tmp_path / "folder.txt").mkdir()
    (tmp_path / "folder.txt" / "diary").write_text("mine")
    (tmp_path / "link.txt").symlink_to("ours.txt")
    (tmp_path / "to-folder.txt").symlink_to("folder.txt")
    (tmp_path / "lost.txt").symlink_to("nowhere.txt")
    return tmp_path


@pytest.mark.parametrize(
    ("name", "kind", "message"),
    [
        ("notes.txt", FILE, "a file is there that is not a poem written by npfm; remove it or"),
        ("folder.txt", FILE, "a folder is there"),
        ("link.txt", FILE, "a link is there"),
        ("to-folder.txt", FILE, "a link is there"),
        ("lost.txt", FILE, "a link is there"),
        ("new.md", FILE, "a poem is written as .txt; give a name that ends so"),
        (".txt", FILE, "a poem is written as .txt"),
        ("", FILE, "a poem is written as .txt"),
        ("ours.txt/new.txt", FILE, "ours.txt is a file and no folder"),
        ("ours.txt/a/b/new.txt", FILE, "ours.txt is a file and no folder"),
        ("folder.txt", FOLDER, "a folder is there that is not an anthology"),
        ("notes.txt", FOLDER, "a file is there"),
        ("to-folder.txt", FOLDER, "a link is there|a folder"),
    ],
)
def test_nothing_of_anybody_else_is_touched(users, monkeypatch, name, kind, message):
    monkeypatch.chdir(users)
    before = tree(users)
    for path in (name, users / name):
        with pytest.raises(NpfmError, match=message) as caught, replacing(path, kind):
            raise AssertionError("nothing may be written")
        assert "\n" not in str(caught.value)
        assert tree(users) == before


def test_a_way_through_a_folder_that_is_not_there_hides_nobodys_file(users, monkeypatch):
    monkeypatch.chdir(users)
    before = tree(users)
    with pytest.raises(NpfmError, match=r"'\.\.' after a folder that is not there"):
        check_replaceable("missing/../notes.txt", FILE)
    assert tree(users) == before
    check_replaceable("folder.txt/../new.txt", FILE)


@pytest.mark.parametrize("name", ["x" * 251 + ".txt", "new/" + "x" * 251 + ".txt"])
def test_a_name_that_is_too_long_is_refused_before_any_work(tmp_path, name):
    with pytest.raises(NpfmError, match="File name too long"):
        check_replaceable(tmp_path / name, FILE)
    assert list(tmp_path.iterdir()) == []


def test_a_place_where_nothing_can_be_written_is_refused_before_any_work():
    with pytest.raises(NpfmError, match=r"x\.txt: cannot be written in /proc"):
        check_replaceable("/proc/x.txt", FILE)


def test_a_name_that_is_no_text_is_refused(tmp_path):
    with pytest.raises(NpfmError, match="not a name in UTF-8") as caught:
        check_replaceable(tmp_path / os.fsdecode(b"\xff.txt"), FILE)
    str(caught.value).encode()


@pytest.mark.parametrize("name", [".", "/", "./", "..", "a/.."])
def test_a_folder_without_a_name_of_its_own_is_refused(tmp_path, monkeypatch, name):
    (tmp_path / "a").mkdir()
    monkeypatch.chdir(tmp_path / "a")
    with pytest.raises(NpfmError, match="no name for an anthology"):
        check_replaceable(name, FOLDER)


def test_one_of_several_kinds_is_chosen_by_its_suffix(tmp_path):
    page = Kind("a page", ".md", marked(b"# by npfm"))
    check_replaceable(tmp_path / "new.md", FILE, page)
    with pytest.raises(NpfmError, match=r"a poem is written as \.txt or \.md"):
        check_replaceable(tmp_path / "new.pdf", FILE, page)
    (tmp_path / "old.md").write_text(OURS)
    with pytest.raises(NpfmError, match="not a page written by npfm"):
        check_replaceable(tmp_path / "old.md", FILE, page)


def test_marks_are_found_at_both_ends_of_a_long_file(tmp_path):
    path = tmp_path / "a.txt"
    for before, after, found in [(0, 10**6, True), (10**6, 0, True), (10**6, 10**6, False)]:
        path.write_bytes(b"x" * before + b"by npfm" + b"x" * after)
        assert marked(b"by npfm")(path) is found
