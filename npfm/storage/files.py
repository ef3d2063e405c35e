"""Files that are either whole or absent."""

import errno
import os
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from npfm.errors import NpfmError

#: What the system says when a disk, a quota or a limit of size allows no more.
FULL = tuple(os.strerror(code) for code in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG))


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a temporary name beside `path`, renamed to `path` when the block succeeds.

    Parameters
    ----------
    path : str or Path
        The final name; missing parent folders are made.

    Yields
    ------
    Path
        A name in the same folder with the same suffix, for a file or a folder. If the block
        raises, whatever was written there is removed and `path` is left as it was.

    Raises
    ------
    NpfmError
        If there is no room for what the block writes.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.stem}.{secrets.token_hex(4)}{path.suffix}")
    try:
        yield temporary
        if temporary.is_dir() and path.is_dir():
            shutil.rmtree(path)
        os.replace(temporary, path)
    except Exception as error:
        if _no_room(error):
            raise NpfmError(f"{path}: no room to write it; free some space, run again") from error
        raise
    finally:
        if temporary.is_dir():
            shutil.rmtree(temporary)
        else:
            temporary.unlink(missing_ok=True)


def _no_room(error: BaseException | None) -> bool:
    """Whether an error began with a full disk: libraries hide it behind errors of their own."""
    while error is not None:
        if any(reason in str(error) for reason in FULL):
            return True
        error = error.__cause__ or error.__context__
    return False
