"""A real browser without a window, for tests of pages."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome")
#: Milliseconds of the page's own clock, which runs as fast as the page allows.
BUDGET = 20_000
#: What a browser says when a test reads what was drawn, which takes time and is no mistake.
READING = "GL Driver Message (OpenGL, Performance"
REPORT = "report-of-the-test"


def opened(
    page: Path,
    script: str,
    at: str = "",
    size: tuple[int, int] = (1280, 1000),
    seconds: float = 120,
) -> Any:
    """Open a page from disk, run a script in it, and return what that finds.

    Parameters
    ----------
    page : Path
        The page; what lies beside it is there for it.
    script : str
        Body of an asynchronous function, after the page's own scripts, whose value is returned.
    at : str
        What follows ``#`` in the address.
    size : tuple of int
        Width and height of the window in pixels.
    seconds : float
        How long it may take.

    Returns
    -------
    Any
        What JSON has of the value. Tests fail if the page writes to the console, or asks for
        anything but files beside it.
    """
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser to open pages in: none of {', '.join(NAMES)} is installed")
    copy = page.with_name(f"test-{page.name}")
    probe = f"""<script>(async () => {{
      let found;
      try {{ found = {{ value: await (async () => {{ {script} }})() }}; }}
      catch (error) {{ found = {{ error: String(error.stack) }}; }}
      found.asked = performance.getEntriesByType("resource").map((entry) => entry.name);
      const report = document.createElement("pre");
      report.id = "{REPORT}";
      report.textContent = JSON.stringify(found);
      document.body.append(report);
    }})();</script>"""
    copy.write_text(page.read_text(encoding="utf-8") + probe, encoding="utf-8")
    try:
        found = _run(program, f"{copy.absolute().as_uri()}{'#' * bool(at)}{at}", size, seconds)
    finally:
        copy.unlink()
    assert "error" not in found, found["error"]
    assert all(address.startswith("file://") for address in found["asked"]), found["asked"]
    return found["value"]


def _run(program: str, address: str, size: tuple[int, int], seconds: float) -> Any:
    call = [
        *(program, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"),
        "--enable-unsafe-swiftshader",
        *(f"--window-size={size[0]},{size[1]}", f"--virtual-time-budget={BUDGET}"),
        *("--enable-logging=stderr", "--log-level=0", "--dump-dom", address),
    ]
    done = subprocess.run(call, capture_output=True, text=True, timeout=seconds)
    lines = [line for line in done.stderr.splitlines() if "CONSOLE" in line]
    said = [line for line in lines if READING not in line]
    assert not said, said
    report = re.search(rf'<pre id="{REPORT}">(.*?)</pre>', done.stdout, re.DOTALL)
    assert report, done.stdout[-2000:] + done.stderr[-2000:]
    return json.loads(html.unescape(report[1]))
