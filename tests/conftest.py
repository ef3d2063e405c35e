"""Fixtures that every test module may use."""

import os
from pathlib import Path

import pytest

import npfm.__main__  # noqa: F401  Before numpy: one thread, as every job has.

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real inputs (docs/data.md); tests that need it skip where it is absent."""
    folder = Path(os.environ.get("NPFM_DATA", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"the real inputs are not at {folder}; set NPFM_DATA to their folder")
    return folder
