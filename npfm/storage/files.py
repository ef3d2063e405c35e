"""Files that are either whole or absent, and that take the place of nothing but their own kind."""

import errno
import os
import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from npfm.errors import NpfmError

#: What the system says when a disk, a quota or a limit of size allows no more.
FULL = tuple(os.strerror(code) for code in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG))
#: What programs write about themselves stands so near to the ends of a file.
ENDS = 2**16


@dataclass(frozen=True)
class Kind:
    """A kind of output, and how one is told from what somebody else wrote.

    Parameters
    ----------
    name : str
        With its article, for messages.
    suffix : str
        How its names end, with the dot; a folder's end as they like.
    ours : callable
        Whether what is at a path, or the link there, is of this kind and written by npfm.
    """

    name: str
    suffix: str
    ours: Callable[[Path], bool]


def marked(*marks: bytes) -> Callable[[Path], bool]:
    """Tell a file, no link, by words that all stand in its first or last 64 KiB."""

    def ours(path: Path) -> bool:
        if path.is_symlink() or not path.is_file():
            return False
        with path.open("rb") as file:
            ends = file.read(ENDS)
            file.seek(max(file.tell(), path.stat().st_size - ENDS))
            ends += file.read(ENDS)
        return all(mark in ends for mark in marks)

    return ours


def check_replaceable(path: str | Path, *kinds: Kind) -> None:
    """Refuse to write where the name is wrong, or where something else is.

    Parameters
    ----------
    path : str or Path
        Where an output is to be written.
    *kinds : Kind
        What it may be, and what may be there already.

    Raises
    ------
    NpfmError
        If the name has not the suffix of any kind or cannot be written, or something is there
        that is of none of them.
    """
    path = Path(path)
    named = [kind for kind in kinds if kind.suffix in ("", path.suffix)]
    if not named:
        suffixes = dict.fromkeys(kind.suffix for kind in kinds)
        raise NpfmError(
            f"{path}: {kinds[0].name} is written as {' or '.join(suffixes)}; "
            "give a name that ends so"
        )
    if path.name in ("", ".."):
        raise NpfmError(f"{path}: no name for {named[0].name}; give that of a new folder")
    _check_way(path)
    above = next(folder for folder in path.absolute().parents if os.path.lexists(folder))
    if not above.is_dir():
        raise NpfmError(f"{path}: {above} is a file and no folder; give another name")
    if os.path.lexists(path) and not any(kind.ours(path) for kind in named):
        found = "a link" if path.is_symlink() else "a folder" if path.is_dir() else "a file"
        raise NpfmError(
            f"{path}: {found} is there that is not {named[0].name} written by npfm; "
            "remove it or give another name"
        )
    _check_writable(above, path)


def _check_way(path: Path) -> None:
    """Refuse a way that says nothing of what is at its end, and a name that is no text."""
    try:
        str(path).encode()
    except UnicodeEncodeError as error:
        raise NpfmError(f"{str(path)!a}: not a name in UTF-8; give another name") from error
    # What is at missing/../there is seen only once `missing` has been made.
    if ".." in path.parts and not path.parent.is_dir():
        raise NpfmError(f"{path}: '..' after a folder that is not there; leave both out")


def _check_writable(folder: Path, path: Path) -> None:
    """Find out by trying, which alone answers for limits, permissions and file systems."""
    trial = folder / _temporary(path).name
    try:
        trial.touch(exist_ok=False)
        trial.unlink()
    except OSError as error:
        raise NpfmError(
            f"{path}: cannot be written in {folder} ({error.strerror}); give another name"
        ) from error


def _temporary(path: Path) -> Path:
    """Return a name in the same folder, of the same suffix, that nobody else has."""
    return path.with_name(f".{path.stem}.{secrets.token_hex(4)}{path.suffix}")


@contextmanager
def replacing(path: str | Path, kind: Kind) -> Iterator[Path]:
    """Give a temporary name beside `path`, renamed to `path` when the block succeeds.

    Parameters
    ----------
    path : str or Path
        The final name; missing parent folders are made.
    kind : Kind
        What is written, the only thing that may be there already.

    Yields
    ------
    Path
        A name in the same folder with the same suffix, for a file or a folder. If the block
        raises, whatever was written there is removed and `path` is left as it was.

    Raises
    ------
    NpfmError
        If something else is at `path`, or there is no room for what the block writes.
    """
    path = Path(path)
    check_replaceable(path, kind)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = _temporary(path)
    try:
        yield temporary
        _put(temporary, path)
    except Exception as error:
        if _no_room(error):
            raise NpfmError(f"{path}: no room to write it; free some space, run again") from error
        raise
    finally:
        _remove(temporary)
        _remove(_aside(temporary))


def _aside(temporary: Path) -> Path:
    """Where the old folder waits until the new one is in its place."""
    return temporary.with_name(f"{temporary.name}.old")


def _put(temporary: Path, path: Path) -> None:
    """Give what was written its final name."""
    if not (temporary.is_dir() and path.is_dir()):
        os.replace(temporary, path)
        return
    # Folders cannot be exchanged in one step: the old one comes back if anything goes wrong.
    os.rename(path, _aside(temporary))
    try:
        os.rename(temporary, path)
    except BaseException:
        os.rename(_aside(temporary), path)
        raise


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _no_room(error: BaseException | None) -> bool:
    """Whether an error began with a full disk: libraries hide it behind errors of their own."""
    while error is not None:
        if any(reason in str(error) for reason in FULL):
            return True
        error = error.__cause__ or error.__context__
    return False
