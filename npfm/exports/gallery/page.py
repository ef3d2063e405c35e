"""A page that a browser opens from disk: everything is inside it, and it asks nobody for anything.

What comes from a user stands in a page as JSON that no browser takes for markup, and scripts put
it into the page as text; a policy in the page itself forbids every request but for pictures that
lie beside it.
"""

import base64
import html
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from string import Template
from typing import Any

from npfm.exports.gallery.kinds import GENERATOR, PAGE
from npfm.storage.files import replacing

#: Beside the modules: what pages share, and the markup and script of each.
FOLDER = Path(__file__).parent / "templates"
SHARED = ("page.html", "page.css", "page.js")
#: Nothing but the page's own style and scripts, and what lies beside it, on a disk or a server.
BESIDE = "file: 'self'"
POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'{scripts}; style-src 'unsafe-inline'; "
    f"img-src {BESIDE} data:; base-uri 'none'; form-action 'none'"
)
#: Characters that would end a script early, or a line of one in old browsers.
UNSAFE = {ord(c): f"\\u{ord(c):04x}" for c in "<>&\u2028\u2029"}


def templates(page: str) -> list[Path]:
    """Files that a page is made from: a change of one is a change of the page."""
    own = [f"{page}.html", f"{page}.css", *_scripts(page)]
    return [*(FOLDER / name for name in (*SHARED, *own)), *sorted(FOLDER.glob(f"{page}_*.glsl"))]


def _scripts(page: str) -> list[str]:
    """Names of the scripts of a page, in their order: the one of its own name runs last."""
    return [*sorted(path.name for path in FOLDER.glob(f"{page}_*.js")), f"{page}.js"]


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
    binaries: Iterable[bytes] = (),
    *,
    scripts_beside: bool = False,
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
    binaries : iterable of bytes
        What it reads as ``binary(0)``, ``binary(1)`` and so on.
    scripts_beside : bool
        Whether it may load scripts that lie beside it.
    """
    whole = Template(text("page.html")).substitute(
        generator=GENERATOR,
        policy=POLICY.format(scripts=f" {BESIDE}" if scripts_beside else ""),
        title=html.escape(title),
        style=text("page.css") + text(f"{page}.css"),
        body=text(f"{page}.html"),
        data=as_json(data),
        binaries="\n".join(_binaries(binaries)),
        script="".join(map(text, ("page.js", *_scripts(page)))),
    )
    with replacing(path, PAGE) as temporary:
        temporary.write_text(whole, encoding="utf-8", newline="\n")


def _binaries(binaries: Iterable[bytes]) -> Iterable[str]:
    for k, content in enumerate(binaries):
        yield f'<script type="text/plain" id="binary-{k}">{base64_of(content)}</script>'


def base64_of(content: bytes) -> str:
    """Bytes as ASCII, for ``atob``."""
    return base64.b64encode(content).decode()


def text(name: str) -> str:
    """Return what a file of the templates says."""
    return (FOLDER / name).read_text(encoding="utf-8")
