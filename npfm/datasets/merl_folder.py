"""A folder of MERL ``.binary`` files, missing ones downloaded on demand (dataset ``merl``)."""

import hashlib
import time
from collections.abc import Mapping
from pathlib import Path
from urllib.parse import quote

from npfm.datasets import table_folders
from npfm.errors import NpfmError
from npfm.reflectance.merl import BINARY, FILE_BYTES, check_header
from npfm.storage.files import Kind, marked, replacing

#: Waits before the second, third and fourth attempt at a download, in seconds.
RETRY_WAITS = (1.0, 4.0, 10.0)
#: Give up an attempt when the server is silent for this many seconds.
TIMEOUT = 30.0
#: Statuses 400 to 499 say that asking again is useless, except for timeout and "too many".
TRANSIENT_STATUSES = (408, 429)


#: Bytes that are taken at a time.
CHUNK_BYTES = 2**20
#: A table hardly shrinks, and what a server has packed may unpack to anything.
AS_IT_IS = {"Accept-Encoding": "identity"}


class _FailedAttempt(Exception):
    """What went wrong in a transfer that may go well the next time."""


class _Refused(Exception):
    """Why what a server sends is no MERL file, now or later."""


def materials(folder: str | Path) -> list[str]:
    """Names of the ``.binary`` files in a folder, sorted.

    Raises
    ------
    NpfmError
        If there is no such folder, or a file in it would be missed for its ``.BINARY``.
    """
    return table_folders.materials(folder, ".binary", "MERL")


def path(folder: str | Path, name: str) -> Path:
    """Path of a material's file, its size and header checked.

    Raises
    ------
    NpfmError
        If folder or file are absent, or size or header are not MERL's.
    """
    file = table_folders.path(folder, name, ".binary", "MERL")
    check_header(file)
    return file


def download(url_template: str, name: str, folder: str | Path) -> Path:
    """Fetch a material that a folder lacks; the file is whole or absent.

    The sha256 of what arrived is written to ``<name>.binary.sha256`` beside it, in the form that
    ``sha256sum --check`` reads. Each material has its own, so that parallel downloads do not
    meet in one file.

    Parameters
    ----------
    url_template : str
        Address with ``{name}`` where the name of the material belongs.
    name : str
        Name of the material.
    folder : str or Path
        Made if absent.

    Returns
    -------
    Path
        ``<folder>/<name>.binary``; not fetched again, nor checked, if it is there.

    Raises
    ------
    NpfmError
        If the template is no web address or lacks ``{name}``, the server has no such file or
        cannot be reached, sends more than a MERL file has, or the transfer is cut off or not a
        MERL file at every attempt.
    """
    if not url_template.startswith(("http://", "https://")) or "{name}" not in url_template:
        raise NpfmError(
            f"{url_template}: a download address begins with http:// or https:// and has {{name}} "
            "where the name of the material belongs"
        )
    file = Path(folder) / f"{name}.binary"
    if file.is_file():
        return file
    with replacing(file, BINARY) as temporary:
        _fetch(url_template.replace("{name}", quote(name)), temporary)
        with temporary.open("rb") as content:
            digest = hashlib.file_digest(content, "sha256").hexdigest()
        # Before the file takes its name, so that a downloaded file never lacks its record.
        kind = Kind("a checksum", ".sha256", marked(f"  {file.name}\n".encode()))
        with replacing(file.with_name(f"{file.name}.sha256"), kind) as record:
            record.write_text(f"{digest}  {file.name}\n")
    return file


def _fetch(url: str, target: Path) -> None:
    """Download `url` to `target` and check it, several times if need be."""
    for wait in (*RETRY_WAITS, None):
        try:
            return _attempt(url, target)
        except _FailedAttempt as error:
            if wait is None:
                raise NpfmError(
                    f"{url}: download failed {len(RETRY_WAITS) + 1} times, at last with: {error}; "
                    "check the connection and the address, then run again"
                ) from None
            time.sleep(wait)


def _check_announced(headers: Mapping[str, str]) -> None:
    """Refuse what cannot be a MERL file before any of it is taken."""
    length = headers.get("Content-Length", "")
    if length.isdecimal() and int(length) > FILE_BYTES:
        raise _Refused(f"the server announces {length} bytes, a MERL file has {FILE_BYTES}")
    if (encoding := headers.get("Content-Encoding", "identity")) != "identity":
        raise _Refused(f"the server sends it packed ({encoding}) though it was asked not to")


def _attempt(url: str, target: Path) -> None:
    """Download and check once."""
    import requests  # 0.1 s, and most runs download nothing
    from tqdm import tqdm

    try:
        with (
            requests.get(url, stream=True, timeout=TIMEOUT, headers=AS_IT_IS) as response,
            target.open("wb") as file,
            tqdm(
                desc=url, total=FILE_BYTES, unit="B", unit_scale=True, delay=2, disable=None
            ) as progress,
        ):
            response.raise_for_status()
            _check_announced(response.headers)
            # Raises when less arrives than the Content-Length promises.
            for chunk in response.iter_content(CHUNK_BYTES):
                progress.update(file.write(chunk))
                if file.tell() > FILE_BYTES:
                    raise _Refused(f"more than the {FILE_BYTES} bytes of a MERL file arrive")
        check_header(target)
    except requests.HTTPError as error:
        # An answer is what this error is about.
        assert error.response is not None
        status, reason = error.response.status_code, error.response.reason
        if 400 <= status < 500 and status not in TRANSIENT_STATUSES:
            raise NpfmError(
                f"{url}: the server answers {status} {reason}; "
                "check the name of the material and the download address"
            ) from None
        raise _FailedAttempt(f"{status} {reason}") from None
    except requests.RequestException as error:
        raise _FailedAttempt(str(error)) from None
    except _Refused as error:
        raise NpfmError(f"{url}: {error}; check the download address") from None
    except NpfmError as error:
        # Without a Content-Length, a short file is all that a cut-off transfer shows.
        raise _FailedAttempt(str(error).removeprefix(f"{target}: ")) from None
