"""A page that a browser opens from disk: everything is inside it, and it asks nobody for anything.

What comes from a user stands in a page as JSON that no browser takes for markup, and scripts put
it into the page as text; a policy in the page itself forbids every request but for pictures that
lie beside it.
"""

import base64
import html
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from string import Template
from typing import Any

from npfm.storage.files import Kind, marked, replacing

#: How a page of the gallery begins, so that nothing else is ever overwritten.
GENERATOR = '<meta name="generator" content="npfm gallery">'
PAGE = Kind("a page of the gallery", ".html", marked(GENERATOR.encode()))
#: Beside the modules: what pages share, and the markup and script of each.
FOLDER = Path(__file__).parent / "templates"
SHARED = ("page.html", "page.css", "page.js")
#: Nothing but the page's own style and scripts, and pictures from where the page is.
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src file: data:; base-uri 'none'; form-action 'none'"
)
#: Characters that would end a script early, or a line of one in old browsers.
UNSAFE = {ord(c): f"\\u{ord(c):04x}" for c in "<>&\u2028\u2029"}


def templates(page: str) -> list[Path]:
    """Files that a page is made from: a change of one is a change of the page."""
    return [FOLDER / name for name in (*SHARED, f"{page}.html", f"{page}.css", f"{page}.js")]


def as_json(data: Any) -> str:
    """Return data as JSON for a script element: no ``</script>`` in a name ends it.

    Raises
    ------
    ValueError
        If there is a number in it that JSON does not have, such as NaN.
    """
    text = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.translate(UNSAFE)


def number(value: float) -> float | str | None:
    """Return a number as JSON has it: a missing one as null, an infinite one as text."""
    if value != value:
        return None
    return value if abs(value) != float("inf") else ("inf" if value > 0 else "-inf")


def write(
    path: str | Path,
    page: str,
    title: str,
    data: Mapping[str, Any],
    binaries: Sequence[bytes] = (),
) -> None:
    """Write a page.

    Parameters
    ----------
    path : str or Path
        The file to write.
    page : str
        Which of the templates.
    title : str
        In the bar of the browser, as the user wrote it.
    data : mapping
        What the script reads as ``DATA``.
    binaries : sequence of bytes
        What it reads as ``binary(0)``, ``binary(1)`` and so on.
    """
    text = _template("page.html").substitute(
        generator=GENERATOR,
        policy=POLICY,
        title=html.escape(title),
        style=_read("page.css") + _read(f"{page}.css"),
        body=_read(f"{page}.html"),
        data=as_json(data),
        binaries="\n".join(_binaries(binaries)),
        script=_read("page.js") + _read(f"{page}.js"),
    )
    with replacing(path, PAGE) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def _binaries(binaries: Iterable[bytes]) -> Iterable[str]:
    for k, content in enumerate(binaries):
        text = base64.b64encode(content).decode()
        yield f'<script type="text/plain" id="binary-{k}">{text}</script>'


def _template(name: str) -> Template:
    return Template(_read(name))


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")
